"""Missions in steps whose tasks come after others: planned as in continuous time, then played.

The searches that count what forming costs know nothing of precedence; the one over coalitions
does. It takes ways as long as their steps, and a coalition that does not come together takes
`forming_steps` more. What its plans are worth under the step rules is seen when they are played.
"""

from __future__ import annotations

from dataclasses import replace

from teamformer.mission.rules import is_too_short, opening_step
from teamformer.model import Scenario, Task
from teamformer.planning.bounds.makespan import lower_bound
from teamformer.planning.continuous.continuous_mission import ContinuousMission, pose_mission
from teamformer.planning.continuous.problem import CoalitionProblem
from teamformer.planning.continuous.solve import solve as solve_coalitions
from teamformer.planning.relaxation.solve import solve
from teamformer.policies.central.plan_player import PlanPlayer
from teamformer.policies.central.plays import CentralPlan, Plays

RELAXING = 0.1
"""Share of the time for the relaxed schedule and its proof; precedence is not in it."""

SEARCHES = 5
"""How many plans are searched for and played: the best one on paper need not be when played."""

SLOWEST, FASTEST = 0.001, 1000.0
"""Speeds that a scenario may have, in cells or metres a step here."""


def plan_with_precedence(scenario: Scenario, plays: Plays, seed: int, workers: int) -> CentralPlan:
    """Return the best play, of those made before and of plans that know of precedence."""
    solution = solve(scenario, RELAXING * plays.seconds_left, seed=seed, workers=1)
    bound = max(solution.bound, lower_bound(scenario))
    mission = pose_mission(_as_continuous(scenario))
    for number in range(SEARCHES):
        seconds = plays.seconds_left / (SEARCHES - number)
        if seconds == 0.0 or plays.makespan == bound:
            break
        _search_and_play(scenario, mission, plays, seconds, seed + number, workers)
    return plays.report(solution, bound, [], is_first=plays.limit == 0)


def _search_and_play(
    scenario: Scenario,
    mission: ContinuousMission,
    plays: Plays,
    seconds: float,
    seed: int,
    workers: int,
) -> None:
    assert isinstance(mission.problem, CoalitionProblem)
    found = solve_coalitions(mission.problem, seconds, seed, workers)
    if found is None:
        return
    routes = [[stop.task for stop in route.stops] for route in mission.time(found.plan).routes]
    plays.add("coalitions", PlanPlayer(scenario, routes, found.plan.order.tolist()))


def _as_continuous(scenario: Scenario) -> Scenario:
    """Return a mission in which steps are a time like any other.

    Losses are not foreseen; of delays only how fast a robot is on average.
    """
    paced = tuple(
        replace(
            robot,
            speed=_possible(scenario.world.pace(robot.expected_speed)),
            absences=(),
            delays=None,
        )
        for robot in scenario.robots
    )
    tasks = tuple(_without_hopeless_window(task) for task in scenario.tasks)
    forming = float(scenario.forming_steps)
    return replace(
        scenario, robots=paced, tasks=tasks, time="continuous", forming=forming, cost=None
    )


def _without_hopeless_window(task: Task) -> Task:
    """Return a task without the end of a window that it cannot keep: continuous time has none."""
    if not is_too_short(task):
        return task
    return replace(task, between=None, appears=opening_step(task))


def _possible(pace: float) -> float:
    """Return a speed that a scenario may have: steps may be so short that a pace is none."""
    return min(max(pace, SLOWEST), FASTEST)
