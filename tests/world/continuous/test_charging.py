"""Robots with batteries in continuous time: when they charge, queue and run dry, by hand."""

from __future__ import annotations

from dataclasses import replace

import pytest

from charging_missions import Given, charged_mission, run_course
from teamformer.mission.coordination import Plan
from teamformer.mission.model import Absence, Mission, Robot, Task
from teamformer.mission.parts.charging import Battery, Charger
from teamformer.mission.parts.grid import Grid
from teamformer.planning.continuous.continuous_mission import pose_mission
from teamformer.planning.continuous.rules import plan_continuous
from teamformer.world.rules.charging.stops import ChargeRules
from teamformer.world.rules.constants import NOBODY

# A lane of 60 cells with a charger at 10. A robot at 0 does tasks at 20 and 40, for 4 each; serving
# takes half as much as walking. From 20 it is 10 to the charger, from 40 it is 30.

LANE = Mission(
    "lane",
    Grid(60, 1),
    ("lift",),
    (Robot("a", (0, 0), {"lift": 1}, battery=Battery(62, 31, serving=0.5)),),
    (Task("near", (20, 0), {"lift": 1}, 4), Task("far", (40, 0), {"lift": 1}, 4)),
    time="continuous",
    chargers=(Charger((10, 0)),),
)
IN_TURN = Plan(order=(0, 1), coalitions=((0,), (0,)))


def told(mission: Mission, plan: Plan = IN_TURN) -> list[tuple[float, str]]:
    """Return what happens when; events of plans and of the end left out."""
    events = run_course(mission, Given(plan)).world.events
    return [(event.at, event.kind) for event in events if event.kind not in ("plan", "over")]


def with_battery(**changes: float) -> Mission:
    robots = (replace(LANE.robots[0], battery=replace(LANE.robots[0].battery, **changes)),)
    return replace(LANE, robots=robots)


def test_a_robot_charges_before_a_task_after_which_it_would_get_to_no_charger() -> None:
    # Near: 20 + 2, left 40. Far takes 20 + 2, and then 30 to the charger: 52 are too many. It
    # charges 32 of 62, a half of 31 and a bit: 10 away, left 30.
    assert told(LANE) == [
        (0, "walk"),
        (20, "arrive"),
        (20, "serve"),
        (24, "done"),
        (24, "walk"),
        (34, "arrive"),
        (34, "charge"),
        (50, "charged"),
        (50, "walk"),
        (80, "arrive"),
        (80, "serve"),
        (84, "done"),
    ]


def test_what_just_suffices_is_enough() -> None:
    # 20 + 2 + 20 + 2 + 30 are 74.
    kinds = [kind for _, kind in told(with_battery(lasts=74))]
    assert "charge" not in kinds
    kinds = [kind for _, kind in told(with_battery(lasts=73.9))]
    assert "charge" in kinds


def test_a_robot_charges_before_it_goes_home_if_it_would_not_get_there() -> None:
    # After the far task 62 - 30 - 2 = 30 are left: enough to the charger, and not for 40.
    ends = told(replace(LANE, ends="home"))[-5:]
    assert ends == [
        (114, "arrive"),
        (114, "charge"),
        (145, "charged"),
        (145, "walk"),
        (155, "arrive"),
    ]


def test_a_robot_without_a_battery_never_charges() -> None:
    robots = (replace(LANE.robots[0], battery=None),)
    assert told(replace(LANE, robots=robots))[-1] == (48, "done")


def two_robots(room: int) -> Mission:
    robots = (LANE.robots[0], replace(LANE.robots[0], name="b", at=(1, 0)))
    tasks = (
        Task("near", (20, 0), {"lift": 2}, 4),
        Task("far", (40, 0), {"lift": 2}, 4),
    )
    return replace(LANE, robots=robots, tasks=tasks, chargers=(Charger((10, 0), room),))


@pytest.mark.parametrize(("room", "ends"), [(1, 99.5), (2, 84)])
def test_robots_queue_where_there_is_no_room(room: int, ends: float) -> None:
    # Both are at the charger at 34. Robot a charges until 50, b has a unit more left: for 15.5.
    plan = Plan(order=(0, 1), coalitions=((0, 1), (0, 1)))
    course = run_course(two_robots(room), Given(plan))
    charges = [(e.at, e.robots, e.until) for e in course.world.events if e.kind == "charge"]
    second = 50.0 if room == 1 else 34.0
    assert charges == [(34, (0,), 50), (second, (1,), second + 15.5)]
    assert course.world.now == ends


def test_who_is_lost_leaves_its_place_to_others() -> None:
    robots = (
        replace(LANE.robots[0], absences=(Absence(40, 45),)),
        replace(LANE.robots[0], name="b"),
    )
    tasks = tuple(replace(task, name=f"{task.name} {n}") for n in (0, 1) for task in LANE.tasks)
    plan = Plan(order=(0, 1, 2, 3), coalitions=((0,), (0,), (1,), (1,)))
    course = run_course(replace(LANE, robots=robots, tasks=tasks), Given(plan))
    charges = [(e.at, e.robots, e.until) for e in course.world.events if e.kind == "charge"]
    # Robot a charges 6 long, 12 of 62; b then until 56, and a what it still lacks: 20, in 10.
    assert charges == [(34, (0,), 50), (40, (1,), 56), (56, (0,), 66)]


def test_a_robot_that_waits_too_long_runs_dry_and_stands_still_for_good() -> None:
    robots = (
        replace(LANE.robots[0], battery=Battery(62, 31, waiting=1.0)),
        Robot("slow", (1, 0), {"lift": 1}, speed=0.1),
    )
    tasks = (Task("near", (20, 0), {"lift": 2}, 4),)
    plan = Plan(order=(0,), coalitions=((0, 1),))
    events = run_course(replace(LANE, robots=robots, tasks=tasks), Given(plan)).world.events
    empty = [(event.at, event.robots) for event in events if event.kind == "empty"]
    assert empty == [(pytest.approx(62), (0,))]
    assert events[-1].status == "infeasible"


@pytest.mark.parametrize("seed", range(8))
def test_what_is_planned_is_what_is_played(seed: int) -> None:
    mission = charged_mission(seed)
    posed = pose_mission(mission)
    made = plan_continuous(posed, "plan", 0.0)
    assert made is not None
    stops = {stop.task: stop for route in made.routes for stop in route.stops}
    order = sorted(stops, key=lambda task: (stops[task].start, task))
    who = {task: [] for task in order}
    for route in made.routes:
        for stop in route.stops:
            who[stop.task].append(route.robot)
    plan = Plan(order=tuple(order), coalitions=tuple(tuple(who[task]) for task in order))
    course = run_course(mission, Given(plan))
    assert course.status == "completed"
    assert course.world.now == pytest.approx(made.makespan, abs=1e-9)
    for task, stop in stops.items():
        assert course.world.started[task] == pytest.approx(stop.start, abs=1e-9)


# On a line: chargers at 0, 30 and 60.
LINE = ChargeRules([Battery(40, 1)], [0, 30, 60], [1, 1, 1], lambda robot, a, b: abs(a - b))


@pytest.mark.parametrize(
    ("here", "left", "goal", "spent", "charger"),
    [
        (10, 40, 20, 0, NOBODY),  # 10 there and 10 to the next charger
        (10, 20, 20, 0, NOBODY),
        (10, 19, 20, 0, 0),  # only the charger behind it is in reach
        (12, 18.5, 20, 1, 1),  # by 30 it is 28 to the goal, by 0 it is 32
        (10, 10, 70, 0, 0),  # from 0 by way of 30 and 60
        (10, 5, 20, 0, 0),  # it gets to none: the nearest
        (0, 40, 70, 0, 1),  # full at a charger: on to the next one
        (55, 10, 95, None, 2),  # home, where nothing is left over
    ],
)
def test_a_robot_goes_to_the_charger_with_the_least_detour(
    here: int, left: float, goal: int, spent: float | None, charger: int
) -> None:
    wanted = 0.0 if spent is None else LINE.wanted(0, spent, goal)
    assert LINE.stop(0, here, left, goal, wanted) == charger
