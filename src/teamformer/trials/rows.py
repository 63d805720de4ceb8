"""What is said of a trial in one row, by `--json` and to Python alike."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from teamformer.methods.central.plays import CentralPlan
from teamformer.mission.checks.costs import judged_by
from teamformer.mission.model import Mission
from teamformer.mission.parts.plane import Plane
from teamformer.record.record import Record
from teamformer.record.task_times import cost_of_record, judged_value, lateness
from teamformer.trials.trial import PlayedTrial


@dataclass(frozen=True)
class Bars:
    """What trials of one mission are measured by: the fastest of them and the highest bound.

    `least` is the least of what plans of the mission are judged by: of the costs, say.
    """

    best: int | None
    bound: int | None
    least: float | None


def bars_of(trials: Sequence[PlayedTrial]) -> Bars:
    """Return the bars of several trials of one mission."""
    replays = [trial.replay for trial in trials]
    makespans = [replay.end.makespan for replay in replays]
    makespans += [trial.plan.makespan for trial in trials if trial.plan]
    bounds = (replay.lower_bound for replay in replays)
    best = min((steps for steps in makespans if steps is not None), default=None)
    bound = max((steps for steps in bounds if steps is not None), default=None)
    if all(judged_by(replay.mission) is None for replay in replays):
        return Bars(best, bound, best)
    judged = (judged_value(replay) for replay in replays)
    least = min((value for value in judged if value is not None), default=None)
    return Bars(best, bound, least)


def result_row(trial: PlayedTrial, bars: Bars) -> dict[str, Any]:
    """Return the row of a trial; `bars` are those of all trials of its mission."""
    replay, end = trial.replay, trial.replay.end
    return {
        "scenario": replay.scenario.name,
        "method": replay.method,
        "seed": replay.seed,
        "completed": end.status == "completed",
        "status": end.status,
        "makespan": end.makespan,
        **({} if replay.mission.cost is None else {"cost": rounded_cost(replay)}),
        "makespan_seconds": seconds_of(replay.scenario, end.makespan),
        "steps": end.steps,
        "tasks_done": end.tasks_done,
        "tasks": len(replay.scenario.tasks),
        "robots": len(replay.scenario.robots),
        "capabilities": len(replay.scenario.capabilities),
        "joins": end.joins,
        "splits": end.splits,
        "illegal_decisions": end.illegal_decisions,
        "blocked_tasks": list(end.blocked_tasks),
        "late": lateness(replay),
        "planning_seconds": round(trial.planning_seconds, 6),
        "decision_seconds": round(trial.decision_seconds, 6),
        "simulating_seconds": round(trial.simulating_seconds, 6),
        "compiling_seconds": round(trial.compiling_seconds, 6),
        "total_seconds": round(trial.total_seconds, 6),
        "best_known": bars.best,
        "lower_bound": replay.lower_bound,
        "percent_over_best": percent_over_least(replay, bars),
        "percent_over_bound": percent_over(end.makespan, replay.lower_bound),
        **_plan_row(trial.plan),
    }


def rounded_cost(replay: Record) -> float | None:
    """Return what a mission cost, to six places; None if not everything was done."""
    cost = cost_of_record(replay)
    return None if cost is None else round(cost, 6)


def percent_over_least(replay: Record, bars: Bars) -> float | None:
    """Return by how many percent a trial is above the best one, by what plans are judged by."""
    return percent_over(judged_value(replay), bars.least)


def percent_over(value: float | None, bar: float | None) -> float | None:
    """Return by how many percent a makespan or a cost is above a bar, if there are both."""
    return None if value is None or not bar else round(100 * (value / bar - 1), 2)


def seconds_of(scenario: Mission, steps: int | None) -> float | None:
    """Return how long steps take on a plane; None on grids, whose steps have no length."""
    if steps is None or not isinstance(scenario.world, Plane):
        return None
    return round(steps * scenario.world.step, 3)


def _plan_row(plan: CentralPlan | None) -> dict[str, Any]:
    """Return what is said of the central planner's work."""
    if plan is None:
        return {}
    return {
        "relaxed": plan.solution.value,
        "proven": plan.solution.status == "optimal",
        "played_by": plan.played_by,
        "curve": plan.curve,
    }
