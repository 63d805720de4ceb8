"""What plans in continuous time are kept by is what the mission counts, however it is searched."""

from __future__ import annotations

from dataclasses import replace

import pytest

from teamformer.base.errors import TeamformerError
from teamformer.files.mission_files import mission_from_tree
from teamformer.mission.checks.costs import judged_by
from teamformer.mission.coordination import Plan
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.mission.parts.plane import Plane
from teamformer.planning.continuous.continuous_mission import pose_mission
from teamformer.planning.continuous.rules import plan_continuous
from teamformer.planning.problem.routes import MissionPlan

DEFAULT = {"makespan": 1.0, "tardiness": 2.0}


def planned(
    mission: Mission, method: str = "plan", seconds: float = 0.0, start: Plan | None = None
) -> MissionPlan:
    plan = plan_continuous(pose_mission(mission), method, seconds, start)
    assert plan is not None
    return plan


def urgent(**cost: float) -> Mission:
    """Return two tasks that are due at once, one of weight 9 far from the robot, one of 1 near."""
    return Mission(
        "urgent",
        Grid(30, 1),
        ("a",),
        (Robot("r", (5, 0), {"a": 1}),),
        (
            Task("near", (6, 0), {"a": 1}, duration=9, between=(0, 9)),
            Task("far", (25, 0), {"a": 1}, between=(0, 9), weight=9.0),
        ),
        time="continuous",
        cost=cost or None,
    )


def test_the_default_is_a_cost_in_which_tasks_have_their_weights() -> None:
    """First to the far one, late by 11 with weight 9, then back: over at 48, late by 39.

    The other way round all is over at 29, and they are late by 1 and by 20: 29 + 2 * (1 + 9 * 20).
    """
    default, written = urgent(), urgent(**DEFAULT)
    assert planned(default).routes == planned(written).routes
    assert planned(default).order == (1, 0)
    assert planned(default).cost is None
    assert pose_mission(default).worth_of(planned(default)) == (48 + 2 * (39 + 9 * 11)) / 3


def test_a_mission_with_windows_is_searched_by_its_cost() -> None:
    assert judged_by(urgent()) is not None
    assert judged_by(replace(urgent(), tasks=(Task("t", (6, 0), {"a": 1}),))) is None
    both = [pose_mission(one).problem for one in (urgent(), urgent(**DEFAULT))]
    weights = [one.links.weight.tolist() for one in both]
    assert weights[0] == weights[1] != []


def test_reactive_judges_futures_by_windows_and_costs() -> None:
    """First to the near one all is over at 12, late by 1 and 11; else at 14, late by 5 and 2."""
    near = Task("near", (6, 0), {"a": 1}, duration=9, between=(0, 9))
    far = Task("far", (8, 0), {"a": 1}, between=(0, 1), weight=9.0)
    mission = replace(urgent(), tasks=(near, far))
    assert planned(mission, "soonest").makespan == 12
    assert planned(mission, "reactive").makespan == 14
    assert planned(replace(mission, cost=DEFAULT), "reactive").cost == (14 + 2 * (5 + 9 * 2)) / 3
    assert planned(replace(mission, cost={"makespan": 1}), "reactive").cost == 12


def test_a_plan_in_time_that_is_over_at_the_bound_is_proven() -> None:
    mission = replace(urgent(), tasks=(Task("t", (6, 0), {"a": 1}, between=(7, 9)),))
    for one in (mission, replace(mission, cost=DEFAULT)):
        made = planned(one, "central", 5.0)
        assert (made.makespan, made.is_proven) == (7, True)
        assert made.bound == pytest.approx(7, abs=1e-5)


@pytest.mark.parametrize("between", [None, (0.0, 200.0)])
def test_a_shorter_plan_is_not_lost_for_one_that_has_all_home_sooner_on_average(
    between: tuple[float, float] | None,
) -> None:
    """One robot does both from 2 to 102; two are over at 52 and 101, which is later on average."""
    mission = Mission(
        "both",
        Grid(101, 1),
        ("a",),
        (Robot("left", (0, 0), {"a": 1}), Robot("right", (53, 0), {"a": 1})),
        tuple(Task(name, (2, 0), {"a": 1}, duration=50, between=between) for name in "xy"),
        time="continuous",
    )
    for method in ("plan", "central"):
        assert planned(mission, method).makespan == 101


def test_a_window_far_away_does_not_make_the_others_coarse() -> None:
    """First to the right, which is due first, then to the left: both are in time."""
    tasks = [("q", (4.6, 5.0), (0.0, 1.3)), ("p", (5.4, 5.0), (0.0, 0.9))]
    tasks.append(("audit", (5.0, 5.0), (9e8, 1e9)))
    mission = Mission(
        "far",
        Plane(10, 10),
        ("a",),
        (Robot("r", (5.0, 5.0), {"a": 1}),),
        tuple(Task(name, at, {"a": 1}, between=window) for name, at, window in tasks),
        time="continuous",
        cost={"tardiness": 1},
    )
    assert planned(mission).late == {}


def test_a_gap_that_is_just_long_enough_is_kept() -> None:
    """In the best plan t2 starts 15.5 after t3, which is the most, and nothing has any duration.

    In a graph of arcs what takes no time takes a tick. All plans were tried to find the best one.
    """
    tree = {
        "teamformer": 1,
        "world": {"rows": ["@@.....", "@...@..", "....@@@", ".......", "...@..."]},
        "capabilities": ["lift", "scan"],
        "robots": [
            {"name": "r1", "at": [0, 2], "can": {"lift": 0.5}, "speed": 0.5, "moves": "air"},
            {"name": "r2", "at": [1, 4], "can": {"lift": 0.5, "scan": 1.25}},
        ],
        "tasks": [
            {"name": "t1", "at": [2, 4], "needs": {"lift": 1}},
            {"name": "t2", "at": [6, 3], "needs": {"lift": 0.5}, "starts": {"t3": [5.5, 15.5]}},
            {"name": "t3", "at": [6, 3], "needs": {"lift": 0.5, "scan": 1.25}},
            {"name": "t4", "at": [5, 4], "needs": {"lift": 1.0, "scan": 1.25}},
        ],
        "time": "continuous",
        "forming": 0.5,
        "cost": {"makespan": 0.5, "completion": 3},
    }
    assert planned(mission_from_tree(tree)).cost == 51.5


def in_a_row(**more: dict[str, tuple[float, float]]) -> Mission:
    """Return two tasks that a third is linked with, and two robots."""
    gap = (0.0, 9.0)
    tasks = (
        Task("first", (1, 0), {"a": 1}),
        Task("second", (3, 0), {"a": 1}, **more),
        Task("last", (5, 0), {"a": 1}, starts={"first": gap, "second": gap}),
    )
    robots = (Robot("r", (0, 0), {"a": 1}), Robot("s", (0, 0), {"a": 1}))
    return Mission("row", Grid(8, 1), ("a",), robots, tasks, time="continuous")


@pytest.mark.parametrize("method", ["plan", "central"])
def test_tasks_that_are_linked_through_a_third_may_have_one_robot(method: str) -> None:
    made = planned(in_a_row(), method, 0.1)
    assert made.makespan == 5
    assert sorted(len(route.stops) for route in made.routes) == [1, 2]


def test_three_that_are_all_linked_with_one_another_need_three_robots() -> None:
    with pytest.raises(TeamformerError, match="'first', 'second', 'last' are done by different"):
        in_a_row(starts={"first": (0.0, 9.0)})


def carried() -> Mission:
    """Return a load that a fast or a slow robot carries; plans count on the fast one."""
    robots = (Robot("slow", (0, 0), {"a": 1}, speed=0.5), Robot("fast", (9, 0), {"a": 1}))
    load = Task("load", (0, 0), {"a": 1}, to=(9, 0))
    return Mission("carried", Grid(10, 1), ("a",), robots, (load,), time="continuous")


@pytest.mark.parametrize("mission", [carried(), urgent()])
def test_what_begins_with_a_plan_is_never_worse_by_true_times(mission: Mission) -> None:
    """A plan that is handed in is judged as any other, and is what comes out if it is the best."""
    posed = pose_mission(mission)
    robots, tasks = range(len(mission.robots)), range(len(mission.tasks))
    for robot in robots:
        for order in (tuple(tasks), tuple(reversed(tasks))):
            given = Plan(order, ((robot,),) * len(order))
            worth = posed.worth_of(posed.time(posed.as_arrays(given)))
            assert posed.worth_of(planned(mission, "central", 0.0, given)) <= worth


def test_robots_that_wait_for_one_another_for_ever_make_no_plan() -> None:
    """`last` starts with `first` and 5 before `second`; r does `second` before `first`."""
    first, second, last = in_a_row().tasks
    tasks = (
        first,
        replace(second, starts={"last": (5, 5)}),
        replace(last, starts={"first": (0, 0)}),
    )
    mission = replace(in_a_row(), tasks=tasks)
    posed = pose_mission(mission)
    given = Plan((1, 0, 2), ((0,), (0,), (1,)))
    assert posed.time(posed.as_arrays(given)).makespan == float("inf")
    assert planned(mission, "central", 0.0, given).makespan < float("inf")


def test_what_no_plan_costs_less_than_by_hand() -> None:
    """Three robots that lift each go to one task or on from one to the next, and home.

    A weight of 3 on travel and 1 on tardiness makes shares of 3/4 and 1/4.
    """
    line = Mission(
        "line",
        Grid(21, 1),
        ("lift",),
        (Robot("r", (10, 0), {"lift": 1}), Robot("s", (10, 0), {"lift": 1})),
        (
            Task("left", (0, 0), {"lift": 1}, between=(0, 4)),
            Task("right", (20, 0), {"lift": 1}, between=(0, 99)),
        ),
        time="continuous",
        ends="home",
        cost={"travel": 3.0, "tardiness": 1.0},
    )
    made = planned(line, "central", 1.0)
    assert made.cost == pytest.approx((3 * 40 + 6) / 4)  # there and back twice, six too late
    assert made.least_cost == pytest.approx(made.cost, abs=1e-3)
    both = (Task("left", (0, 0), {"lift": 2}), line.tasks[1])
    together = planned(replace(line, tasks=both), "central", 1.0)
    assert together.cost == pytest.approx(3 * 60 / 4)  # two go left, and one of them right as well
    assert together.least_cost == pytest.approx(together.cost, abs=1e-3)
