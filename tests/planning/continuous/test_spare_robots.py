"""Robots that take part in tasks that can be done without them, where that pays."""

from __future__ import annotations

import pytest

from teamformer.mission.coordination import Plan
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.mission.parts.roads import Roads
from teamformer.planning.continuous.continuous_mission import pose_mission
from teamformer.planning.continuous.rules import plan_continuous
from teamformer.planning.problem.coalition_problem import SPARES
from teamformer.planning.problem.routes import MissionPlan

LIFT = {"lift": 1}


def planned(mission: Mission, method: str = "plan", start: Plan | None = None) -> MissionPlan:
    made = plan_continuous(pose_mission(mission), method, 0.05, start)
    assert made is not None
    return made


def together(**rules: object) -> Mission:
    """Return two robots at x = 0, a task for one at 5 and one for both at 10; forming takes 5."""
    robots = (Robot("a", (0, 0), LIFT), Robot("b", (0, 0), LIFT))
    tasks = (Task("small", (5, 0), LIFT), Task("large", (10, 0), {"lift": 2}))
    parts = (Grid(12, 1), ("lift",), robots, tasks)
    return Mission("together", *parts, time="continuous", forming=5.0, **rules)  # type: ignore[arg-type]


GO_TOGETHER = Plan(order=(0, 1), coalitions=((0, 1), (0, 1)))


@pytest.mark.parametrize("rules", [{}, {"cost": {"makespan": 1.0}}])
def test_who_comes_along_need_not_form(rules: dict[str, object]) -> None:
    """Both go by 5 and are at 10 after 10; who meets there after parting takes 15."""
    assert planned(together(**rules)).makespan == 10.0


@pytest.mark.parametrize("rules", [{}, {"cost": {"makespan": 1.0}}])
def test_a_plan_that_is_handed_in_keeps_its_spares(rules: dict[str, object]) -> None:
    mission = pose_mission(together(**rules))
    laid = mission.as_arrays(GO_TOGETHER)
    assert laid.size.tolist() == [2, 2]
    assert mission.time(laid).makespan == 10.0
    assert planned(together(**rules), "central", GO_TOGETHER).makespan == 10.0


def test_a_detour_by_a_task_may_be_the_quicker_road() -> None:
    """From p0 it takes b 20 to p2, but 2 by p1, where a does a task."""
    times = ((0.0, 1.0, 20.0), (1.0, 0.0, 1.0), (20.0, 1.0, 0.0))
    roads = Roads(("p0", "p1", "p2"), {"ground": times})
    at = [roads.at(name) for name in roads.places]
    robots = (Robot("a", at[1], {"scan": 1}), Robot("b", at[0], LIFT))
    tasks = (Task("look", at[1], {"scan": 1}), Task("crate", at[2], LIFT))
    mission = Mission("roads", roads, ("scan", "lift"), robots, tasks, time="continuous")
    assert planned(mission).makespan == 2.0


def test_a_way_with_a_load_costs_no_travel() -> None:
    """A crate goes from 0 to 9, where a lamp is: who comes along with it is there for free."""
    robots = (Robot("a", (0, 0), LIFT), Robot("b", (0, 0), {"scan": 1}))
    tasks = (Task("crate", (0, 0), LIFT, to=(9, 0)), Task("lamp", (9, 0), {"scan": 1}))
    parts = (Grid(10, 1), ("lift", "scan"), robots, tasks)
    mission = Mission("ride", *parts, time="continuous", cost={"travel": 1.0})
    assert planned(mission).cost == 0.0


def test_nobody_comes_along_for_nothing() -> None:
    robots = tuple(Robot(name, (0, 0), LIFT) for name in "abc")
    tasks = (Task("t", (5, 0), LIFT), Task("u", (6, 0), LIFT))
    parts = (Grid(12, 1), ("lift",), robots, tasks)
    made = planned(Mission("lone", *parts, time="continuous", forming=5.0))
    assert sorted(len(route.stops) for route in made.routes) in ([0, 0, 2], [0, 1, 1])


def test_searches_have_seats_for_spares_only_where_they_may_pay() -> None:
    robots, tasks = (Robot("a", (0, 0), LIFT),), (Task("t", (5, 0), LIFT),)
    plain = Mission("plain", Grid(9, 1), ("lift",), robots, tasks, time="continuous")
    spares = [pose_mission(mission).problem.spares for mission in (together(), plain)]
    assert spares == [SPARES, 0]
