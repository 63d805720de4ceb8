"""The rules without search in continuous time: linked tasks, costs, and whom no way leads to."""

from __future__ import annotations

import pytest

from teamformer.files.drawn.named_settings import world_of
from teamformer.files.mission_files import mission_from_tree
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.plane import Plane
from teamformer.planning.continuous.continuous_mission import pose_mission
from teamformer.planning.continuous.reactive import dispatch, react, worth_of
from teamformer.planning.continuous.rules import plan_continuous
from teamformer.planning.problem.coalition_problem import pose_problem
from teamformer.planning.problem.links import HOME
from teamformer.planning.problem.schedule import BACK_SUM, empty_schedule

ISLANDS = {
    "teamformer": 1,
    "time": "continuous",
    "world": {"rows": [".", "@", "."]},
    "capabilities": ["a"],
    "robots": [{"at": [0, 0], "can": ["a"]}, {"at": [0, 2], "can": ["a"]}],
    "tasks": [
        {"at": [0, 0], "needs": ["a"]},
        {"at": [0, 0], "needs": ["a"]},
        {"at": [0, 2], "needs": ["a"]},
    ],
}
"""A robot on each side of a wall. The one below has nothing to do any more before the other."""


def test_what_all_robots_together_cannot_do_is_not_planned() -> None:
    problem = pose_problem(
        ways=[[[0, 0]] * 3],
        home=[[0, 0, 0]],
        pace=[0],
        origin=[2],
        counts=[[1, 0]],
        needs=[[1, 0], [0, 1]],
        duration=[1, 1],
    )
    assert react(problem) is None


def test_whoever_is_on_the_other_side_of_a_wall_is_not_sent() -> None:
    made = plan_continuous(pose_mission(mission_from_tree(ISLANDS)), "reactive", 0.0)
    assert made is not None
    stops = [{stop.task for stop in route.stops} for route in made.routes]
    assert stops == [{0, 1}, {2}]
    assert made.makespan == 0.0


def line(*tasks: Task, robots: dict[str, tuple[float, dict[str, int]]]) -> Mission:
    """Return a mission on a line; robots by name, each with where it starts and what it can."""
    there = tuple(Robot(name, (x, 0.0), can) for name, (x, can) in robots.items())
    return Mission("line", Plane(100, 1), ("a", "b"), there, tasks, time="continuous")


def test_linked_tasks_come_one_after_the_other_and_start_as_their_gap_says() -> None:
    """`one` can begin at 1 and `other` at 20, by whom is there first, and `between` at 2.

    `one` starts at most 5 before `other`, so at 15. `between` is not put between them, though it
    could begin sooner than `other`: its robot is at `one` until 17, and 1 away from it.
    """
    mission = line(
        Task("one", (1.0, 0.0), {"a": 1}, duration=2),
        Task("between", (2.0, 0.0), {"a": 1}),
        Task("other", (30.0, 0.0), {"b": 1}, starts={"one": (0.0, 5.0)}),
        robots={"near": (0.0, {"a": 1}), "far": (50.0, {"b": 1})},
    )
    made = plan_continuous(pose_mission(mission), "soonest", 0.0)
    assert made is not None
    stops = {stop.task: stop.start for route in made.routes for stop in route.stops}
    assert stops == {0: 15.0, 1: 18.0, 2: 20.0}


@pytest.mark.parametrize("method", ["soonest", "reactive"])
def test_where_the_rule_leaves_nobody_for_a_linked_task_there_is_a_plan(method: str) -> None:
    """By the rule `both`, who is near, does `one`; then `only` cannot do `other` beside it."""
    mission = line(
        Task("one", (1.0, 0.0), {"a": 1}),
        Task("other", (2.0, 0.0), {"b": 1}, starts={"one": (0.0, 0.0)}),
        robots={"both": (0.0, {"a": 1, "b": 1}), "only": (40.0, {"a": 1})},
    )
    made = plan_continuous(pose_mission(mission), method, 0.0)
    assert made is not None
    assert [[stop.task for stop in route.stops] for route in made.routes] == [[1], [0]]
    assert made.makespan == 39.0


@pytest.mark.parametrize("seed", range(4000, 4006))
@pytest.mark.parametrize("rule", [dispatch, react])
def test_futures_are_timed_and_judged_as_missions_are(rule: object, seed: int) -> None:
    """With links, windows, loads, forming and costs; ticks are rounded."""
    posed = pose_mission(world_of("clock", seed))
    found = rule(posed.problem)  # type: ignore[operator]
    schedule, links = empty_schedule(posed.problem), posed.problem.links
    worth = worth_of(posed.problem, schedule, found.plan)
    made = posed.time(found.plan)
    for route in made.routes:
        for stop in route.stops:
            assert schedule.start[stop.task] / posed.scale == pytest.approx(stop.start, abs=0.01)
    leads = links.weight[HOME] * schedule.total[BACK_SUM]
    assert (worth - leads) / posed.scale == pytest.approx(posed.worth_of(made), rel=1e-4)
    assert made.cost is None or made.cost > 0


def test_what_is_left_of_a_plan_stays_unless_a_future_is_better() -> None:
    for seed in range(4000, 4004):
        problem = pose_mission(world_of("roads", seed)).problem
        best, rule = react(problem), dispatch(problem)
        assert best is not None
        assert rule is not None
        again, room = react(problem, best.plan), empty_schedule(problem)
        assert again is not None
        first, later, plain = (worth_of(problem, room, s.plan) for s in (best, again, rule))
        assert later <= first <= plain
