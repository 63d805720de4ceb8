"""The rules that plan a coalition problem, by name."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from itertools import islice

from teamformer.planning.coalitions.bounds.makespan import improving_bounds
from teamformer.planning.coalitions.problem import CoalitionProblem, pose_problem
from teamformer.planning.coalitions.reactive import react
from teamformer.planning.coalitions.search.annealing import CoalitionSearch, is_compiled
from teamformer.planning.coalitions.solve import Solution, plan_together, solve

Planner = Callable[[CoalitionProblem, float], Solution | None]

PLANNERS: dict[str, Planner] = {
    "central": lambda problem, seconds: solve(problem, seconds),
    "plan": lambda problem, seconds: plan_together(problem),
    "reactive": lambda problem, seconds: react(problem),
}
"""`central` uses all the time; `plan` is what every robot computes; `reactive` plans nothing."""

__all__ = ["PLANNERS", "is_compiled", "warm_up"]


@cache
def warm_up() -> None:
    """Have everything compiled before the clock starts."""
    problem = pose_problem(
        ways=[[[0, 1], [1, 0], [1, 1]]],
        home=[[1, 1, 0]],
        pace=[0],
        origin=[2],
        counts=[[1]],
        needs=[[1], [1]],
        duration=[1, 1],
    )
    search = CoalitionSearch(problem, 0)
    search.begin_anew()
    search.anneal(1, 1, 0, 10, 10)
    react(problem)
    list(islice(improving_bounds(problem, lambda: 10), 2))
