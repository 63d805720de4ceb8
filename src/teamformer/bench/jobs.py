"""Jobs: the trials that one process runs in one go, and the rows that come of them."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import cache, lru_cache
from importlib.metadata import version
from pathlib import Path

import numpy as np

from teamformer.base.array_types import Array
from teamformer.bench.rows import Row
from teamformer.bench.suites import player_of
from teamformer.bench.trials_in_time import play_in_time
from teamformer.files.drawn.named_settings import new_tasks_of, world_of
from teamformer.files.imports.authors import read_world
from teamformer.methods.by_name import Method, load_method, with_settings
from teamformer.methods.central.plays import CentralPlan
from teamformer.methods.seam.protocol import Planner, Policy
from teamformer.mission.coordination import Coordinator, Known, Plan, heeded_by
from teamformer.mission.model import Mission
from teamformer.mission.truth import draw_truth
from teamformer.trials.list_schedule import list_schedule
from teamformer.trials.trial import bound_of, run_trials
from teamformer.world.env import Decision, Tally
from teamformer.world.view import View


@dataclass(frozen=True)
class Job:
    """Trials of one method in one setting.

    `worlds` is the file that the worlds are read from, None if they are generated. Trials that are
    `timed` run one by one, others side by side. `with_bars` asks for the lower bound and the list
    schedule of each world too. `rules` are fields of every mission, `settings` of the method.
    """

    suite: str
    setting: str
    method: str
    seeds: tuple[int, ...]
    time_limit: float
    code: str
    is_timed: bool = True
    with_bars: bool = False
    worlds: Path | None = None
    rules: Mapping[str, int] = field(default_factory=dict)
    settings: Mapping[str, str] = field(default_factory=dict)

    def mission(self, seed: int) -> Mission:
        """Return the world of a trial, under the rules of the suite."""
        if self.worlds is None:
            mission = world_of(self.setting, seed)
        else:
            mission = read_world(self.worlds, seed).mission
        forming_steps = self.rules.get("forming_steps", mission.forming_steps)
        return replace(mission, forming_steps=forming_steps)


class Stopwatch:
    """Times a method: stands between the worlds and its policy, or its coordinator."""

    def __init__(self, method: Method, worlds: int) -> None:
        self._method = method
        self.seconds = np.zeros(worlds)
        self.cpu_seconds = np.zeros(worlds)
        self.decisions = np.zeros(worlds, dtype=np.int64)

    @property
    def policy(self) -> Policy | None:
        """Return the policy that is timed, if the method has one."""
        return self._method.policy

    def timed(self) -> Method:
        """Return the method as it is played under the clock."""
        if self._method.policy is not None:
            return replace(self._method, policy=_under_clock(self, self._method.policy))
        assert self._method.coordinator is not None
        return replace(self._method, coordinator=_TimedCoordinator(self, self._method.coordinator))

    @contextmanager
    def counting(self, shares: Array) -> Iterator[None]:
        """Share out among worlds, (worlds,), what is done within."""
        began, began_cpu = time.perf_counter(), time.process_time()
        yield
        self.seconds += shares * (time.perf_counter() - began)
        self.cpu_seconds += shares * (time.process_time() - began_cpu)

    @property
    def evenly(self) -> Array:
        """Return the same share for each world, (worlds,)."""
        return np.full(len(self.seconds), 1 / len(self.seconds))


class _TimedPolicy:
    """A policy under a clock; what it takes to decide is shared out by rows of the view."""

    def __init__(self, clock: Stopwatch, policy: Policy) -> None:
        self._clock, self._policy = clock, policy
        self.needs_everything = policy.needs_everything

    def begin(self, everything: Sequence[Mission] | None, rng: np.random.Generator) -> None:
        """Start the policy."""
        with self._clock.counting(self._clock.evenly):
            self._policy.begin(everything, rng)

    def decide(self, view: View) -> Decision:
        """Let the policy decide."""
        rows = np.bincount(view.world, minlength=len(self._clock.seconds))
        self._clock.decisions += rows
        with self._clock.counting(rows / rows.sum()):
            return self._policy.decide(view)


class _TimedPlanner(_TimedPolicy):
    """A planner under a clock; what it takes to plan is shared out evenly."""

    def __init__(self, clock: Stopwatch, planner: Planner) -> None:
        super().__init__(clock, planner)
        self._planner = planner

    @property
    def time_limit(self) -> float:
        """Return how long it may plan."""
        return self._planner.time_limit

    @property
    def plans(self) -> Sequence[CentralPlan]:
        """Return what it has found."""
        return self._planner.plans

    def within(self, time_limit: float | None, workers: int | None) -> _TimedPlanner:
        """Return one that may take so long, with so many threads, under the same clock."""
        return _TimedPlanner(self._clock, self._planner.within(time_limit, workers))

    def plan(
        self,
        everything: Sequence[Mission],
        believed: Sequence[Mission],
        rng: np.random.Generator,
    ) -> None:
        """Let it plan."""
        with self._clock.counting(self._clock.evenly):
            self._planner.plan(everything, believed, rng)


def _under_clock(clock: Stopwatch, policy: Policy) -> _TimedPolicy:
    if isinstance(policy, Planner):
        return _TimedPlanner(clock, policy)
    return _TimedPolicy(clock, policy)


class _TimedCoordinator:
    """A coordinator under a clock; what it takes to plan is shared out evenly."""

    def __init__(self, clock: Stopwatch, coordinator: Coordinator) -> None:
        self._clock, self._coordinator = clock, coordinator
        self.heeds = heeded_by(coordinator)

    def update(self, known: Known, plan: Plan | None) -> Plan:
        """Let the coordinator plan."""
        with self._clock.counting(self._clock.evenly):
            return self._coordinator.update(known, plan)


def run_job(job: Job) -> list[Row]:
    """Run the trials of a job."""
    method = ready_method(player_of(job.method), job.time_limit)
    late = {"new_tasks": new_tasks_of(job.setting)}
    method = with_settings(method, late | dict(job.settings))
    worlds = {seed: job.mission(seed) for seed in job.seeds}
    _warm_up(job, method)
    is_in_time = worlds[job.seeds[0]].time == "continuous"
    parts = [[seed] for seed in job.seeds] if job.is_timed else [list(job.seeds)]
    rows = []
    for seeds in parts:
        if is_in_time:
            rows += [_row_in_time(job, seed, worlds[seed], method) for seed in seeds]
            continue
        clock = Stopwatch(method, len(seeds))
        began = time.perf_counter()
        tallies = run_trials(
            [worlds[seed] for seed in seeds], clock.timed(), seeds[0], truth_seeds=seeds
        )
        seconds = (time.perf_counter() - began) / len(seeds)
        for place, seed in enumerate(seeds):
            row = _row(job, seed, worlds[seed], tallies[place])
            row = replace(row, total_seconds=round(seconds, 6), side_by_side=len(seeds))
            rows.append(_with_times(row, clock, place))
    return [_with_bars(row, worlds[row.world_seed]) for row in rows] if job.with_bars else rows


@lru_cache(maxsize=16)
def ready_method(name: str, time_limit: float) -> Method:
    """Return a method by name, kept for the next job; a planner is given its time, one thread."""
    return load_method(name, time_limit, workers=1)


_WARM: set[tuple[str, str]] = set()
"""Methods and settings that have had a trial in this process."""


def _warm_up(job: Job, method: Method) -> None:
    """Run a trial that does not count, so that loading compiled code is not timed."""
    if (job.method, job.setting) in _WARM:
        return
    _WARM.add((job.method, job.setting))
    mission = job.mission(job.seeds[0])
    if mission.time == "continuous":
        return  # each trial there has what it needs compiled before
    if method.needs_everything:  # planning takes as long as it may
        mission = world_of(f"{len(mission.robots)}N1T-C{len(mission.capabilities)}", 0)
    run_trials([mission], method)


@cache
def _version() -> str:
    return version("teamformer")


def known_row(job: Job, seed: int, mission: Mission, makespan: float | None) -> Row:
    """Return the row of a trial of which nothing but the makespan is known; None: it failed."""
    return Row(
        suite=job.suite,
        setting=job.setting,
        world_seed=seed,
        mission=mission.name,
        method=job.method,
        seed=seed,
        completed=makespan is not None,
        makespan=makespan,
        steps=makespan,
        tasks=len(mission.tasks),
        robots=len(mission.robots),
        capabilities=len(mission.capabilities),
        code=job.code,
        rerun=rerun_command(job, seed),
        version=_version(),
    )


def _row(job: Job, seed: int, mission: Mission, tally: Tally) -> Row:
    makespan = tally.steps if tally.status == "completed" else None
    return replace(
        known_row(job, seed, mission, makespan),
        cost=tally.cost,
        steps=tally.steps,
        tasks_done=tally.tasks_done,
        joins=tally.joins,
        splits=tally.splits,
        illegal_decisions=tally.illegal_decisions,
    )


def _row_in_time(job: Job, seed: int, mission: Mission, method: Method) -> Row:
    """Run a trial in continuous time; return its row."""
    began = time.perf_counter()
    trial = play_in_time(mission, method, seed)
    record, end = trial.record, trial.record.end
    limit = method.policy.time_limit if isinstance(method.policy, Planner) else None
    return replace(
        known_row(job, seed, mission, end.makespan),
        cost=end.cost,
        missed=_missed(record.true_mission, end.missed),
        steps=record.length,
        tasks_done=end.tasks_done,
        decisions=trial.plans,
        decision_seconds=round(trial.planning_seconds, 6),
        decision_cpu_seconds=round(trial.cpu_seconds, 6),
        total_seconds=round(time.perf_counter() - began, 6),
        lower_bound=record.lower_bound,
        time_limit=limit,
    )


def _missed(mission: Mission, names: Sequence[str]) -> float | None:
    """Return the weight of the tasks that were missed; None if a mission has no `until`."""
    if mission.until is None:
        return None
    return sum(task.weight for task in mission.tasks if task.name in names)


def _with_times(row: Row, clock: Stopwatch, place: int) -> Row:
    """Add what the clock says of a trial and, of a planner, what it found."""
    row = replace(
        row,
        decisions=int(clock.decisions[place]),
        decision_seconds=round(float(clock.seconds[place]), 6),
        decision_cpu_seconds=round(float(clock.cpu_seconds[place]), 6),
    )
    if not isinstance(clock.policy, Planner):
        return row
    plan = clock.policy.plans[place]
    return replace(
        row,
        time_limit=clock.policy.time_limit,
        lower_bound=plan.bound,
        relaxed=plan.solution.value,
        relaxed_bound=plan.solution.bound,
        curve=[[round(seconds, 3), steps] for seconds, steps in plan.curve],
    )


def _with_bars(row: Row, mission: Mission) -> Row:
    truth = draw_truth(mission, row.seed)
    bound = max(bound_of(truth) or 0, row.lower_bound or 0)
    listed = list_schedule(truth) if truth.time == "steps" else None
    return replace(row, lower_bound=bound, list_schedule=listed)


def rerun_command(job: Job, seed: int) -> str:
    """Return the command that runs this one trial again."""
    options: dict[str, object] = {
        "settings": job.setting,
        "methods": job.method,
        "seed": seed,
        "trials": 1,
        "time-limit": f"{job.time_limit:g}" if job.method == "central" else None,
    }
    worlds = [] if job.worlds is None else [str(job.worlds)]
    said = worlds + [f"--{key} {value}" for key, value in options.items() if value is not None]
    return f"teamformer bench {job.suite} {' '.join(said)} --json"
