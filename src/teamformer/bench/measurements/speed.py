"""How fast the simulator is: steps a second, cost against size, a large trial, a warm start."""

from __future__ import annotations

import resource
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from teamformer.bench.measurements.caching import measure_caching
from teamformer.files.drawn.generate import Spec, generate
from teamformer.files.drawn.named_settings import world_of
from teamformer.files.mission_files import write_mission
from teamformer.methods.learned.any_fleet import teamformer
from teamformer.methods.scripted.joining import JoinAll
from teamformer.mission.model import Mission
from teamformer.mission.parts.grid import Grid
from teamformer.trials.trial import run_trial, run_trials
from teamformer.world.env import Decision, TeamFormation

BATCH = 1024  # worlds
MEASURED_SECONDS = 2.0
SIZES = ((4, 4, 10), (20, 100, 20), (100, 100, 30), (1000, 1000, 100))  # robots, tasks, side


@dataclass(frozen=True)
class Measurement:
    """One figure: what was measured, how much, in which unit."""

    setting: str
    value: float
    unit: str


def measure_speed() -> Iterator[Measurement]:
    """Yield every figure as it is measured, on one core; numbers come from this machine only."""
    yield Measurement("4N4T stepping, with views and join-all", _join_all_rate(), "steps/s")
    yield Measurement("4N4T stepping, with views, all maintain", _stepping_rate(), "steps/s")
    for robots, tasks, side in SIZES:
        microseconds = _step_cost(robots, tasks, side)
        setting = f"{robots} teams and {tasks} tasks"
        yield Measurement(setting, microseconds, "us/step")
        yield Measurement(f"{setting}, for each", microseconds / (robots + tasks), "us/step")
    seconds, makespan = _large_trial()
    yield Measurement("1000 robots and 1000 tasks, join-all, recorded", seconds, "s")
    yield Measurement("1000 robots and 1000 tasks, makespan", makespan, "steps")
    for name in ("4N20T-C4", "100N20T-C100-R90"):
        yield Measurement(f"a trial of teamformer, {name}", _trial_of_default(name), "s")
    yield from _caching()
    yield Measurement("memory at most", _peak_megabytes(), "MB")
    yield Measurement("teamformer run, warm start", _warm_start(), "s")


def _trial_of_default(name: str) -> float:
    """Return the processor seconds of a whole trial, the median of nine after a first one."""
    method, taken = teamformer(), []
    for seed in range(10):
        mission = world_of(name, seed)
        begun = time.process_time()
        run_trial(mission, method)
        taken.append(time.process_time() - begun)
    return float(np.median(taken[1:]))


def _caching() -> Iterator[Measurement]:
    """Yield what the paper's network needs with and without keeping keys and values."""
    found = measure_caching()
    milliseconds = 1000 / found.views
    what = "spelling all capabilities of a team of 100N20T-C100-R50"
    yield Measurement(f"{what}, cached", milliseconds * found.cached, "ms")
    yield Measurement(f"{what}, uncached", milliseconds * found.uncached, "ms")
    yield Measurement("caching makes it faster by", found.speedup, "times")


def _worlds(count: int, robots: int, tasks: int, side: int, caps: int) -> list[Mission]:
    rng = np.random.default_rng(0)
    spec = Spec(robots, tasks, caps, world=Grid(side, side))
    return [generate(spec, rng) for _ in range(count)]


def _spread_out(mission: Mission) -> Mission:
    """Put the robots anywhere: a crowd at one point would cost by its density, not its size."""
    rng = np.random.default_rng(1)
    side = int(mission.world.width)
    places = rng.integers(side, size=(len(mission.robots), 2))
    robots = [
        replace(r, at=(int(x), int(y))) for r, (x, y) in zip(mission.robots, places, strict=True)
    ]
    return replace(mission, robots=tuple(robots))


def _join_all_rate() -> float:
    """Play whole trials of a batch again and again."""
    worlds, method = _worlds(BATCH, 4, 4, 10, 4), JoinAll()
    run_trials(worlds[:1], method)  # compile
    env = TeamFormation(worlds)
    steps, begun = 0, time.perf_counter()
    while time.perf_counter() - begun < MEASURED_SECONDS:
        env.reset()
        while (running := int(env.is_running.sum())) > 0:
            env.step(method.decide(env.view()))
            steps += running
    return steps / (time.perf_counter() - begun)


def _stepping_rate() -> float:
    env = TeamFormation(_worlds(BATCH, 4, 4, 10, 4))
    return _maintain(env) * BATCH


def _step_cost(robots: int, tasks: int, side: int) -> float:
    """Return the microseconds of a step in which every robot is a team."""
    env = TeamFormation([_spread_out(_worlds(1, robots, tasks, side, 8)[0])])
    return 1e6 / _maintain(env)


def _maintain(env: TeamFormation) -> float:
    """Return how often a batch is viewed and stepped a second while nobody forms."""
    steps, begun = 0, time.perf_counter()
    while time.perf_counter() - begun < MEASURED_SECONDS:
        env.reset()
        for _ in range(20):
            env.step(Decision(env.view().counts))
            steps += 1
    return steps / (time.perf_counter() - begun)


def _large_trial() -> tuple[float, float]:
    mission = _worlds(1, 1000, 1000, 100, 8)[0]
    trial = run_trial(mission, JoinAll())
    return trial.total_seconds, float(trial.record.end.makespan or np.nan)


def _peak_megabytes() -> float:
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / 1e6 if sys.platform == "darwin" else peak / 1e3


def _warm_start() -> float:
    """Time the whole command, the second time."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "small.yaml"
        write_mission(_worlds(1, 4, 4, 10, 4)[0], path)
        command = [sys.executable, "-m", "teamformer.cli", "run", str(path), "--json"]
        subprocess.run(command, check=True, capture_output=True)
        begun = time.perf_counter()
        subprocess.run(command, check=True, capture_output=True)
        return time.perf_counter() - begun
