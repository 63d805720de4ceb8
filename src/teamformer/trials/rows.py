"""What is said of a trial in one row, by `--json` and to Python alike."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from teamformer.model import Scenario
from teamformer.plane import Plane
from teamformer.policies.central.plays import CentralPlan
from teamformer.sim.replay.record import Replay
from teamformer.sim.replay.task_times import cost_of_record, lateness
from teamformer.trials.trial import Trial


def result_row(trial: Trial, best_known: int | None) -> dict[str, Any]:
    """Return the row of a trial; `best_known` is the fastest makespan that is known."""
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
        "best_known": best_known,
        "lower_bound": replay.lower_bound,
        "percent_over_best": percent_over(end.makespan, best_known),
        "percent_over_bound": percent_over(end.makespan, replay.lower_bound),
        **_plan_row(trial.plan),
    }


def rounded_cost(replay: Replay) -> float | None:
    """Return what a mission cost, to six places; None if not everything was done."""
    cost = cost_of_record(replay)
    return None if cost is None else round(cost, 6)


def best_known(trials: Sequence[Trial]) -> int | None:
    """Return the fastest of several trials of one scenario; None if none was completed."""
    makespans = [trial.replay.end.makespan for trial in trials]
    makespans += [trial.plan.makespan for trial in trials if trial.plan]
    return min((steps for steps in makespans if steps is not None), default=None)


def percent_over(value: float | None, bar: float | None) -> float | None:
    """Return by how many percent a makespan or a cost is above a bar, if there are both."""
    return None if value is None or not bar else round(100 * (value / bar - 1), 2)


def seconds_of(scenario: Scenario, steps: int | None) -> float | None:
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
