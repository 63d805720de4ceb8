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
from teamformer.record.task_times import (
    cost_of_record,
    judged_value,
    lateness,
    missed_tasks,
    missed_weight,
)
from teamformer.trials.trial import PlayedTrial


@dataclass(frozen=True)
class Bars:
    """What trials of one mission are measured by: the fastest of them and the highest bound.

    `least` is the least of what plans of the mission are judged by: of the costs, say.
    """

    best: float | None
    bound: float | None
    least: float | None
    missed: float = 0.0  # what the best of them missed, where that counts first


def bars_of(trials: Sequence[PlayedTrial]) -> Bars:
    """Return the bars of several trials of one mission."""
    records = [trial.record for trial in trials]
    makespans = [record.end.makespan for record in records]
    makespans += [trial.plan.makespan for trial in trials if trial.plan]
    bounds = (record.lower_bound for record in records)
    best = min((steps for steps in makespans if steps is not None), default=None)
    bound = max((steps for steps in bounds if steps is not None), default=None)
    if all(judged_by(record.true_mission) is None for record in records) and not _miss(records):
        return Bars(best, bound, best)
    values = ((judged_value(record), _missed_first(record)) for record in records)
    judged = [(missed, value) for value, missed in values if value is not None]
    missed, least = min(judged, default=(0.0, None))
    return Bars(best, bound, least, missed)


def result_row(trial: PlayedTrial, bars: Bars) -> dict[str, Any]:
    """Return the row of a trial; `bars` are those of all trials of its mission."""
    record, end = trial.record, trial.record.end
    return {
        "mission": record.mission.name,
        "method": record.method,
        "seed": record.seed,
        "completed": end.status == "completed",
        "status": end.status,
        "makespan": end.makespan,
        **({} if record.true_mission.cost is None else {"cost": rounded_cost(record)}),
        "makespan_seconds": seconds_of(record.mission, end.makespan),
        "steps": end.steps,
        "tasks_done": end.tasks_done,
        "tasks": len(record.mission.tasks),
        "robots": len(record.mission.robots),
        "capabilities": len(record.mission.capabilities),
        "joins": end.joins,
        "splits": end.splits,
        "illegal_decisions": end.illegal_decisions,
        "blocked_tasks": list(end.blocked_tasks),
        "late": lateness(record),
        **({"missed": _missed(record)} if record.mission.until is not None else {}),
        **({"broken_links": list(map(list, end.broken_links))} if record.is_continuous else {}),
        "planning_seconds": round(trial.planning_seconds, 6),
        "decision_seconds": round(trial.decision_seconds, 6),
        "simulating_seconds": round(trial.simulating_seconds, 6),
        "compiling_seconds": round(trial.compiling_seconds, 6),
        "total_seconds": round(trial.total_seconds, 6),
        "best_known": bars.best,
        "lower_bound": record.lower_bound,
        "percent_over_best": percent_over_least(record, bars),
        "percent_over_bound": percent_over(end.makespan, record.lower_bound),
        **_plan_row(trial.plan),
    }


def _miss(records: Sequence[Record]) -> bool:
    """Say whether tasks of a mission may be missed."""
    return any(record.mission.until is not None for record in records)


def _missed_first(record: Record) -> float:
    """Return what was missed, by weight, where that counts before all else: without a cost."""
    return missed_weight(record) if record.mission.cost is None else 0.0


def _missed(record: Record) -> dict[str, str]:
    """Return why each task was missed that was, by name."""
    tasks = record.true_mission.tasks
    return {tasks[task].name: why for task, (_, why) in missed_tasks(record).items()}


def rounded_cost(record: Record) -> float | None:
    """Return what a mission cost, to six places; None if not everything was done."""
    cost = cost_of_record(record)
    return None if cost is None else round(cost, 6)


def percent_over_least(record: Record, bars: Bars) -> float | None:
    """Return by how many percent a trial is above the best one, by what plans are judged by.

    None for one that missed more, where that counts first.
    """
    if _missed_first(record) > bars.missed:
        return None
    return percent_over(judged_value(record), bars.least)


def percent_over(value: float | None, bar: float | None) -> float | None:
    """Return by how many percent a makespan or a cost is above a bar, if there are both."""
    return None if value is None or not bar else round(100 * (value / bar - 1), 2)


def seconds_of(mission: Mission, steps: float | None) -> float | None:
    """Return how long steps take on a plane; None on grids, whose steps have no length.

    Speeds on a plane are in metres a second, so there the unit of continuous time is a second.
    """
    if steps is None or not isinstance(mission.world, Plane):
        return None
    return round(steps * (mission.world.step if mission.time == "steps" else 1.0), 3)


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
