"""What a peer returns, and what it may be asked: missions without windows, links and forming."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from teamformer.base.errors import TeamformerError
from teamformer.planning.problem.coalition_plan import CoalitionPlan, empty_plan
from teamformer.planning.problem.coalition_problem import NEVER, NOBODY, CoalitionProblem
from teamformer.planning.problem.links import have_weights
from teamformer.planning.problem.schedule import MAKESPAN, schedule_of


@dataclass(frozen=True)
class PeerPlan:
    """A plan that a peer made, and ticks that it says no plan beats, 0 if it says nothing."""

    plan: CoalitionPlan
    bound: int = 0


Peer = Callable[[CoalitionProblem, float], PeerPlan | None]
"""Plans in so many seconds; None if it found nothing in that time."""


class OutOfReachError(TeamformerError):
    """A mission is none that the peer can be asked."""


def plan_of(
    problem: CoalitionProblem, coalitions: Sequence[Sequence[int]], order: Sequence[int]
) -> CoalitionPlan:
    """Return who does each task, in an order, as our own plans have it."""
    plan = empty_plan(problem)
    plan.order[:] = order
    for task, coalition in enumerate(coalitions):
        plan.size[task] = len(coalition)
        plan.coalition[task, : len(coalition)] = sorted(coalition)
    return plan


def makespan_of(problem: CoalitionProblem, plan: CoalitionPlan) -> int:
    """Return when a plan is over, in ticks, by the times of our own plans."""
    return int(schedule_of(problem, plan).total[MAKESPAN])


def plain(problem: CoalitionProblem, name: str) -> CoalitionProblem:
    """Return a problem that peers can be asked; raises `OutOfReachError` for any other."""
    if have_weights(problem.links):
        raise OutOfReachError(f"{name} is asked no missions with linked starts or costs")
    if (problem.due < NEVER).any() or problem.forming[0] > 0 or (problem.release > 0).any():
        raise OutOfReachError(f"{name} is asked no missions with windows or forming")
    if (problem.before != NOBODY).any():
        raise OutOfReachError(f"{name} is asked no missions with precedence")
    return problem
