"""`teamformer plan`: who goes where when, without playing the mission."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from rich.table import Table
from rich.text import Text

from teamformer.commands.compiling import announce_compiling
from teamformer.commands.console import out, prepare_file, print_json, say
from teamformer.errors import TeamformerError
from teamformer.mission.links import is_linked
from teamformer.mission.rules import rules_not_played
from teamformer.model import Scenario
from teamformer.planning.coalitions.mission import pose_mission
from teamformer.planning.coalitions.routes import MissionPlan, Route
from teamformer.planning.coalitions.rules import (
    PLANNERS,
    is_compiled,
    plan_continuous,
    warm_up,
)
from teamformer.scenarios.files import read_scenario
from teamformer.sim.replay.task_times import lateness
from teamformer.trials.methods import load_method
from teamformer.trials.routes import routes_of
from teamformer.trials.trial import run_trial
from teamformer.truth import expected_mission
from teamformer.viewer.gantt import write_gantt

LONGEST_TABLE = 40  # robots
DIGITS = 6
"""Places after the point that are printed of a time."""


def plan(path: Path, method: str, time_limit: float, page: Path | None, as_json: bool) -> int:
    """Plan a mission and show the plan; return the exit status."""
    scenario = read_scenario(path)
    if method not in PLANNERS:
        raise TeamformerError(f"--method {method} is unknown", f"use {', '.join(PLANNERS)}")
    if page is not None:
        prepare_file(page)
    if scenario.time == "continuous":
        made = _plan_continuous(scenario, method, time_limit)
    else:
        made = _plan_steps(path, scenario, method, time_limit)
    if made is None:
        say(f"no plan was found for {scenario.name}; a longer --time-limit may find one")
        return 1
    row = plan_row(scenario, made)
    if page is not None:
        write_gantt(row, page)
        say(f"page: {page}")
    if as_json:
        print_json(row)
    else:
        _show(scenario, made)
    return 0


def plan_row(scenario: Scenario, made: MissionPlan) -> dict[str, Any]:
    """Return what `--json` prints of a plan; times are in the scenario's unit."""
    tasks, robots = scenario.tasks, scenario.robots
    return {
        "scenario": scenario.name,
        "makespan": round(made.makespan, DIGITS),
        **({} if made.cost is None else {"cost": round(made.cost, DIGITS)}),
        "bound": round(made.bound, DIGITS),
        "proven": made.is_proven,
        "routes": [
            {
                "robot": robots[route.robot].name,
                "stops": [
                    {
                        "task": tasks[stop.task].name,
                        "arrive": round(stop.arrive, DIGITS),
                        "start": round(stop.start, DIGITS),
                        "end": round(stop.end, DIGITS),
                    }
                    for stop in route.stops
                ],
                "back": round(route.back, DIGITS),
            }
            for route in made.routes
        ],
        "late": {tasks[task].name: round(by, DIGITS) for task, by in made.late.items()},
        "curve": [[round(seconds, 3), round(when, DIGITS)] for seconds, when in made.curve],
    }


def _plan_continuous(scenario: Scenario, method: str, time_limit: float) -> MissionPlan | None:
    if not is_compiled(is_linked(scenario)):
        say("compiling the planner, on the first run only (half a minute, more if busy) ...")
    warm_up(is_linked(scenario))
    return plan_continuous(pose_mission(scenario), method, time_limit)


def _plan_steps(
    path: Path, scenario: Scenario, method: str, time_limit: float
) -> MissionPlan | None:
    """Plan a mission in steps by the central planner, and read the routes off its play."""
    for problem in rules_not_played(scenario):
        raise TeamformerError(f"{path}: {problem.message}")
    if method != "central":
        raise TeamformerError(
            f"--method {method} plans missions in continuous time", "leave --method out"
        )
    central = load_method(method, time_limit)
    announce_compiling([central])
    if scenario.has_surprises:
        say("not everything is known: this is planned for what is to be expected")
    trial = run_trial(expected_mission(scenario), central)
    end, bound = trial.replay.end, trial.replay.lower_bound or 0
    if end.makespan is None:
        return None
    number_of = {task.name: number for number, task in enumerate(scenario.tasks)}
    return MissionPlan(
        makespan=end.makespan,
        bound=bound,
        is_proven=end.makespan <= bound,
        routes=routes_of(trial.replay),
        late={number_of[name]: by for name, by in lateness(trial.replay).items()},
        curve=() if trial.plan is None else trial.plan.curve,
    )


def _show(scenario: Scenario, made: MissionPlan) -> None:
    cost = "" if made.cost is None else f", at a cost of {made.cost:g}"
    out.print(f"{scenario.name}: over at {made.makespan:g}{cost}{_known(made)}", markup=False)
    for task, by in made.late.items():
        out.print(f"late: {scenario.tasks[task].name} by {by:g}", markup=False)
    table = Table("robot", "tasks: start to end", "back", box=None)
    for route in made.routes[:LONGEST_TABLE]:
        words = (scenario.robots[route.robot].name, _stops(scenario, route), f"{route.back:g}")
        table.add_row(*map(Text, words))
    out.print(table)
    if len(made.routes) > LONGEST_TABLE:
        say(f"and {len(made.routes) - LONGEST_TABLE} robots more; --json tells all")


def _known(made: MissionPlan) -> str:
    """Say how good a plan is; of one with a cost no bound is known."""
    if made.bound <= 0:
        return ""
    gap = 100 * (made.makespan / made.bound - 1)
    known = "proven" if made.is_proven else f"{gap:.1f}% above what no plan beats"
    return f" ({known}: {made.bound:g})"


def _stops(scenario: Scenario, route: Route) -> str:
    shown = (
        f"{scenario.tasks[stop.task].name} {stop.start:.6g}-{stop.end:.6g}" for stop in route.stops
    )
    return ", ".join(shown) or "-"
