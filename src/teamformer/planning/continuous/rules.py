"""The rules that plan a mission in continuous time, by name."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from itertools import islice

import numpy as np

from teamformer.base.errors import TeamformerError
from teamformer.mission.coordination import Plan
from teamformer.mission.model import Mission
from teamformer.planning.continuous.continuous_mission import ContinuousMission, refuse_no_way
from teamformer.planning.continuous.reactive import dispatch, react
from teamformer.planning.continuous.solve import Solution, plan_together, solve
from teamformer.planning.continuous_bounds.makespan import improving_bounds
from teamformer.planning.continuous_bounds.relaxations import relax
from teamformer.planning.continuous_bounds.routes import COARSE, raise_by_routes
from teamformer.planning.problem.coalition_plan import CoalitionPlan
from teamformer.planning.problem.coalition_problem import CoalitionProblem, pose_problem
from teamformer.planning.problem.links import have_weights
from teamformer.planning.problem.misses import Misses
from teamformer.planning.problem.routes import MissionPlan
from teamformer.planning.problem.schedule import schedule_of
from teamformer.planning.search.arc_search import ArcSearch

Planner = Callable[[CoalitionProblem, float, CoalitionPlan | None], Solution | None]

PLANNERS: dict[str, Planner] = {
    "central": lambda problem, seconds, start: solve(problem, seconds, start=start),
    "plan": lambda problem, seconds, start: plan_together(problem),
    "reactive": lambda problem, seconds, start: react(problem),
    "soonest": lambda problem, seconds, start: dispatch(problem),
}
"""`central` uses all the time, and may begin with a plan; `plan` is what every robot computes;
`reactive` and `soonest` search nothing."""

__all__ = ["PLANNERS", "plan_continuous", "warm_up"]


def plan_continuous(
    mission: ContinuousMission, method: str, seconds: float, start: Plan | None = None
) -> MissionPlan | None:
    """Return the plan that a method makes; None if there is no coalition for some task.

    `central` begins with `start`, a plan of all tasks, if that is better than its own first one.
    What it returns is never worse: if nothing better is found, it is that plan as it is.
    """
    first = None if start is None else mission.as_arrays(start)
    solution = PLANNERS[method](mission.problem, seconds, first)
    made = None if solution is None else mission.tell(solution)
    if start is not None:
        given = mission.time(mission.as_arrays(start, with_spares=True))
        made = _better_one(mission, made, given)
    if made is not None:
        refuse_no_way(mission, made)
    elif have_weights(mission.problem.links):
        raise TeamformerError(
            f"{mission.source.name}: no coalitions were found for tasks that are linked",
            "different robots do them, so add robots or drop a link",
        )
    return made


def _better_one(
    mission: ContinuousMission, made: MissionPlan | None, given: MissionPlan
) -> MissionPlan | None:
    """Return the better one of what was found and what was given, with what is known of both."""
    if made is None:
        return None if math.isinf(given.makespan) else given
    if mission.rank_of(made) <= mission.rank_of(given):
        return made
    bound = min(made.bound, given.makespan)
    return replace(given, bound=bound, curve=made.curve)


def warm_up(mission: Mission | None = None) -> None:
    """Have everything compiled before the clock starts that plans of a mission need.

    Searches are compiled twice (`may_have_extras`); without a mission, they are as for most.
    """
    _compile(False)
    if mission is not None and _has_extras(mission):
        _compile(True)


def _has_extras(mission: Mission) -> bool:
    """Say whether plans of a mission have to do with batteries, shifts, zones or missed tasks."""
    bound = (robot for robot in mission.robots if robot.battery or robot.shifts)
    return mission.until is not None or bool(mission.zones) or any(bound)


@cache
def _compile(has_extras: bool) -> None:
    problem = pose_problem(
        ways=[[[0, 1], [1, 0], [1, 1]]],
        home=[[1, 1, 0]],
        pace=[0],
        origin=[2],
        counts=[[1]],
        needs=[[1], [1]],
        duration=[1, 1],
    )
    if has_extras:
        ones = np.ones(2, np.int64)
        problem = problem._replace(
            misses=Misses(10 * ones[:1], judged=ones, leads=ones, optional=ones)
        )
    search = ArcSearch(problem, 0)
    search.begin_anew()
    search.anneal(1, 1, 0, 10, 10)
    schedule_of(problem, search.best)
    react(problem)
    relaxation = relax(problem)
    raise_by_routes(problem, relaxation, 1, COARSE)
    list(islice(improving_bounds(problem, relaxation, 1, lambda: 10), 2))
