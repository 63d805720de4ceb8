"""What a plan that is timed is judged by: its makespan and lateness, or the mission's cost."""

from __future__ import annotations

from typing import TYPE_CHECKING

from teamformer.base.kernels.jit import kernel
from teamformer.planning.problem.links import (
    COMPLETION,
    HOME,
    MAKESPAN,
    MAX_TARDINESS,
    TARDINESS,
    TRAVEL,
)
from teamformer.planning.problem.schedule import BACK_SUM, COST, sum_up

if TYPE_CHECKING:
    from teamformer.planning.problem.coalition_problem import CoalitionProblem
    from teamformer.planning.problem.schedule import Schedule


@kernel
def worth(problem: CoalitionProblem, schedule: Schedule) -> float:
    """Return what a plan with its times comes to, in ticks; the less the better.

    With a cost, when robots are home on average decides a little, as it leads searches.
    """
    sum_up(problem, schedule)
    weight = problem.links.weight
    if len(weight) == 0:
        return float(schedule.total[COST])
    cost = weight[MAKESPAN] * schedule.total[MAKESPAN] + weight[HOME] * schedule.total[BACK_SUM]
    latest = 0
    for task in range(len(schedule.rank)):
        late = max(0, schedule.end[task] - problem.due[task])
        latest = max(latest, late)
        own = weight[TARDINESS] * late + weight[COMPLETION] * schedule.end[task]
        cost += own * problem.links.task_weight[task]
    cost += weight[MAX_TARDINESS] * latest
    return cost + (weight[TRAVEL] * _travel(problem, schedule) if weight[TRAVEL] > 0 else 0.0)


@kernel
def _travel(problem: CoalitionProblem, schedule: Schedule) -> float:
    """Return how long robots are on their way, home included."""
    tasks, travel = len(schedule.rank), 0
    for position in range(tasks):
        task = schedule.plan.order[position]
        for seat in range(schedule.plan.size[task]):
            robot = schedule.plan.coalition[task, seat]
            travel += problem.ways[problem.pace[robot], schedule.last[position, robot], task]
    for robot in range(len(problem.origin)):
        travel += problem.home[problem.kind[robot], schedule.last[tasks, robot]]
    return float(travel)
