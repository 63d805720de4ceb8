"""`teamformer robotarium`: missions of small real robots, simulated, drawn, or made to upload."""

from __future__ import annotations

import json
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from rich.table import Table
from rich.text import Text

from teamformer.base.errors import TeamformerError
from teamformer.base.whole_files import write_whole
from teamformer.cli.terminal.compiling import compile_ahead
from teamformer.cli.terminal.console import (
    Counting,
    out,
    prepare_folder,
    print_json,
    say,
    write_rows,
)
from teamformer.cli.verbs.missions.run import chosen_method
from teamformer.files.drawn.smallest import smallest_mission
from teamformer.files.mission_files import read_mission
from teamformer.methods.by_name import Method, load_method
from teamformer.mission.model import Mission
from teamformer.mission.parts.capabilities import describe
from teamformer.robotarium.benchmark import ROUGH, bench_robotarium, count_missions, summarise
from teamformer.robotarium.experiment import Experiment, run_experiment
from teamformer.robotarium.mission_checks import find_problems
from teamformer.robotarium.robots.arena import TICK
from teamformer.robotarium.robots.plant import Weather

SIMULATORS = ("plant", "noisy", "rps")
"""Ours, ours with delay and noise, and the official one."""

SEED = 0
"""Of what is deployed: where its robots face at first."""


@dataclass(frozen=True)
class FlightOptions:
    """What the command line says of a flight."""

    method: str | None = None
    seed: int = 0
    simulator: str = "plant"
    folder: Path | None = None


def fly(path: Path, options: FlightOptions, as_json: bool) -> int:
    """Fly a mission, write its pictures and show what came of it; return the exit status."""
    mission = read_mission(path, find_problems)
    if options.simulator not in SIMULATORS:
        choices = f"use {', '.join(SIMULATORS)}"
        raise TeamformerError(f"there is no simulator '{options.simulator}'", choices)
    method = _decentralised(options.method, mission)
    film: Any = None
    if options.folder is not None:
        from teamformer.robotarium.draw import Film

        prepare_folder(options.folder)
        film = Film()
    compile_ahead([method])
    done = run_experiment(
        mission,
        method,
        options.seed,
        "rps" if options.simulator == "rps" else "plant",
        ROUGH if options.simulator == "noisy" else Weather(),
        watch=None if film is None else film.watch,
    )
    if options.folder is not None:
        _write(done, film, options.folder)
    if as_json:
        print_json(done.row())
    else:
        _show(done)
    return 0 if done.is_good else 1


def _decentralised(name: str | None, mission: Mission) -> Method:
    """Return a method that can fly: a plan of steps is not what real robots keep to."""
    method = chosen_method(name, mission, time_limit=0.0)
    if method.needs_everything:
        raise TeamformerError(
            f"method '{name}' plans every step before the start, and robots drive as they can",
            "name one that decides as the mission goes, such as plan or heuristic",
        )
    return method


def deploy(path: Path, folder: Path, method: str) -> int:
    """Write the folder to upload, and run it where the simulator is; return the exit status.

    That is 1 if the folder does not do what the plant does here.
    """
    from teamformer.robotarium.deployment.folder import deploy as write
    from teamformer.robotarium.deployment.folder import verify

    mission = read_mission(path, find_problems)
    prepare_folder(folder)
    files = write(mission, method, SEED, folder)
    main = files[0]
    say(f"written: {len(files)} files in {folder}; upload all and mark {main.name} as main")
    if find_spec("rps") is None:
        say("without robotarium-python-simulator: the folder was not run")
        return 0
    expected = run_experiment(mission, load_method(method), SEED).row()
    found = verify(folder)
    _show_comparison(found, expected)
    is_same = all(found[key] == expected[key] for key in COMPARED)
    return 0 if is_same and found["status"] == "completed" else 1


def fly_missions(trials: int, method: str, seed: int, folder: Path | None, as_json: bool) -> int:
    """Fly random missions and show how many were good; return the exit status."""
    has_rps = find_spec("rps") is not None
    if not has_rps:
        say("without robotarium-python-simulator: only the plant is measured")
    if folder is not None:
        prepare_folder(folder)
    compile_ahead([_decentralised(method, smallest_mission())])
    rows = []
    with Counting("missions") as counting:
        for row in bench_robotarium(trials, method, seed, has_rps):
            rows.append(row)
            counting.update(len(rows), count_missions(trials, has_rps))
            if as_json:
                print_json(row)
    if folder is not None:
        write_rows(rows, folder / "robotarium.jsonl")
    summaries = summarise(rows)
    if not as_json:
        for summary in summaries:
            out.print(Text(str(summary.pop("setting")), style="bold"))
            cells = (f"{name} {'-' if v is None else v}" for name, v in summary.items())
            out.print("  " + "; ".join(cells), markup=False)
    is_clean = all(not any(row[fault] for fault in FAULTS) for row in rows)
    is_good = is_clean and all(row["completed"] and row.get("accepted", True) for row in rows)
    return 0 if is_good else 1


FAULTS = ("collisions", "boundary_violations", "actuator_violations")

COMPARED = ("status", "done_at_tick", "collisions", "boundary_violations", "actuator_violations")


def _show_comparison(found: dict[str, Any], expected: dict[str, Any]) -> None:
    table = Table("", "folder, on rps", "here, on the plant", box=None, header_style="dim")
    for key in (*COMPARED, "decision_ms", "longest_decision_ms", "tick_ms"):
        table.add_row(key.replace("_", " "), str(found[key]), str(expected[key]))
    out.print(table)


def _write(done: Experiment, film: Any, folder: Path) -> None:
    row = folder / "result.json"
    write_whole(row, json.dumps(done.row(), indent=1, ensure_ascii=False) + "\n")
    for path in [row, *film.write(done.mission, folder)]:
        say(f"written: {path}")


def _show(done: Experiment) -> None:
    mission, outcome, faults = done.mission, done.outcome, done.faults
    out.print(Text(f"{mission.name}: {done.method}, seed {done.seed}", style="bold"))
    table = Table("seconds", "task", "needs", box=None, header_style="dim")
    finished = sorted(zip(outcome.done_at, mission.tasks, strict=True), key=_when)
    for tick, task in finished:
        when = "-" if tick is None else f"{tick * TICK:.1f}"
        table.add_row(when, Text(task.name), Text(describe(task.needs)))
    out.print(table)
    tally = outcome.tally
    verdict = "all done" if outcome.is_completed else f"not all done: {tally.status}"
    style = "green" if done.is_good else "red"
    out.print(f"{verdict} after {outcome.ticks * TICK:.1f} s, {outcome.ticks} ticks", style=style)
    out.print(
        f"{faults.collisions} collisions, {faults.boundary_violations} boundary violations, "
        f"{faults.actuator_violations} actuator violations; the nearest two robots were "
        f"{faults.min_separation:.3f} m apart",
        style="green" if faults.is_clean else "red",
    )
    timing = outcome.timing
    out.print(
        f"{tally.joins} joins, {tally.splits} splits; a decision of all teams took "
        f"{1e3 * timing.decision:.2f} ms, control {1e3 * timing.tick:.2f} ms a tick"
    )


def _when(done: tuple[int | None, Any]) -> float:
    tick = done[0]
    return float("inf") if tick is None else float(tick)
