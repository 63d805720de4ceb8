"""Batteries beside shifts, windows, loads and delays, by hand."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from charging_missions import Given, run_course
from teamformer.methods.coordinators.shared_plan import SharedPlan
from teamformer.mission.coordination import Plan
from teamformer.mission.model import Absence, Delays, Mission, Robot, Task
from teamformer.mission.parts.charging import Battery, Charger
from teamformer.mission.parts.grid import Grid
from teamformer.record.referee import judge
from teamformer.trials.trial import run_trial
from teamformer.world.continuous.course import Course
from teamformer.world.continuous.delays import StandingStill

# A lane of 60 cells with a charger at 10. A robot at 0 does a task at 20 for 4; serving takes half
# as much as walking. From 20 it is 10 to the charger.

LANE = Mission(
    "lane",
    Grid(60, 1),
    ("lift",),
    (Robot("a", (0, 0), {"lift": 1}, battery=Battery(62, 31, serving=0.5, waiting=0.25)),),
    (Task("near", (20, 0), {"lift": 1}, 4),),
    time="continuous",
    chargers=(Charger((10, 0)),),
)
NEAR = Plan(order=(0,), coalitions=((0,),))


def played(mission: Mission, plan: Plan = NEAR) -> Course:
    return run_course(mission, Given(plan))


def told(course: Course) -> list[tuple[float, str]]:
    """Return what happens when; events of plans, of shifts and of the end left out."""
    left_out = ("plan", "over", "rests", "works", "opens")
    return [(event.at, event.kind) for event in course.world.events if event.kind not in left_out]


def with_robot(**changes: Any) -> Mission:
    return replace(LANE, robots=(replace(LANE.robots[0], **changes),))


def test_a_robot_spends_nothing_outside_its_shifts() -> None:
    # It walks 15, pauses for 85, and walks 5 more: 20 of walking and 2 of serving.
    course = played(with_robot(shifts=((0.0, 15.0), (100.0, 200.0))))
    assert told(course)[-1] == (109, "done")
    assert course.world.bodies[0].left == pytest.approx(62 - 22)


def test_who_waits_for_the_next_shift_at_a_task_spends_nothing_until_then() -> None:
    # There at 20 it waits for 1, as 4 do not fit into the shift, and from 100 on no more.
    course = played(with_robot(shifts=((0.0, 21.0), (100.0, 200.0))))
    assert told(course)[-1] == (104, "done")
    assert course.world.bodies[0].left == pytest.approx(62 - 20 - 0.25 - 2)


def test_a_robot_charges_outside_its_shifts_and_goes_on_with_the_next() -> None:
    # With 31 it lacks 1 for 20 there, 2 and 10 back. At the charger at 10 it has 21 left, and is
    # full 20.5 later, when its shift has ended; it goes on at 100.
    battery = replace(LANE.robots[0].battery, starts=0.5)
    course = played(with_robot(battery=battery, shifts=((0.0, 12.0), (100.0, 200.0))))
    assert told(course) == [
        (0, "walk"),
        (10, "arrive"),
        (10, "charge"),
        (30.5, "charged"),
        (30.5, "walk"),
        (110, "arrive"),
        (110, "serve"),
        (114, "done"),
    ]


def test_waiting_for_a_window_is_spent() -> None:
    mission = replace(LANE, tasks=(replace(LANE.tasks[0], between=(40, 60)),))
    course = played(mission)
    assert told(course)[-1] == (44, "done")
    assert course.world.bodies[0].left == pytest.approx(62 - 20 - 20 * 0.25 - 2)


def test_a_robot_that_runs_dry_while_it_waits_for_a_window_does_so_within_its_shift() -> None:
    # There at 20 it has 42 left, and 8 of waiting spend 2 a unit: all is spent 21 later, of which
    # it is off for 50.
    battery = replace(LANE.robots[0].battery, waiting=2.0)
    mission = with_robot(battery=battery, shifts=((0.0, 30.0), (80.0, 900.0)))
    mission = replace(mission, tasks=(replace(LANE.tasks[0], between=(800, 900)),))
    assert (91, "empty") in [(round(at, 6), kind) for at, kind in told(played(mission))]


def loaded(speed: float = 1.0) -> Mission:
    """Return a mission with a load from 20 to 12, and a second robot of a speed that can help."""
    tasks = (Task("crate", (20, 0), {"lift": 1}, 4, to=(12, 0), unload=2),)
    return replace(
        LANE, tasks=tasks, robots=(LANE.robots[0], Robot("b", (0, 0), {"lift": 1}, speed))
    )


def test_carrying_takes_as_much_as_walking() -> None:
    course = played(loaded())
    assert told(course)[-1] == (20 + 4 + 8 + 2, "done")
    assert course.world.bodies[0].left == pytest.approx(62 - 20 - 2 - 8 - 1)


@pytest.mark.parametrize(("lasts", "charges"), [(49, False), (48.9, True)])
def test_a_robot_counts_with_the_slowest_that_may_carry_the_load(
    lasts: float, charges: bool
) -> None:
    # 20 there, 3 of serving and unloading, 24 by the slowest at a third, 2 to the charger.
    battery = replace(LANE.robots[0].battery, lasts=lasts)
    mission = loaded(1 / 3)
    robots = (replace(mission.robots[0], battery=battery), mission.robots[1])
    kinds = [kind for _, kind in told(played(replace(mission, robots=robots)))]
    assert ("charge" in kinds) == charges


def test_who_is_held_up_spends_nothing() -> None:
    course = played(with_robot(delays=Delays(0.5, seed=3)))
    at, kind = told(course)[-1]
    assert kind == "done"
    assert at > 24
    assert course.world.bodies[0].left == pytest.approx(62 - 20 - 2)


def test_a_robot_that_is_held_up_is_expected_to_get_as_far_as_before() -> None:
    robot = with_robot(delays=Delays(0.5)).robots[0].as_expected
    assert robot.battery is not None
    assert robot.speed == 0.5
    assert (robot.battery.lasts, robot.battery.serving) == (124, 1)
    assert robot.battery.fills == 31


def test_how_long_robots_walk_is_what_they_have_walked_when_they_are_there() -> None:
    robots = [
        Robot("a", (0, 0), {}, delays=Delays(0.3, seed=1), shifts=((0.0, 9.5), (14.0, 80.0))),
        Robot("b", (0, 0), {}, delays=Delays(0.3, seed=2)),
    ]
    still = StandingStill(robots)
    for who in ((0,), (1,), (0, 1)):
        for begin, spent in ((0.0, 5.25), (3.5, 12.0), (7.75, 20.5)):
            assert still.walked(who, begin, still.after(who, begin, spent)) == pytest.approx(spent)


def test_who_is_back_between_two_cells_goes_on_to_the_next_before_it_charges() -> None:
    # It is done at 24 with 18 left, 2 too few for home. Lost at 26.5 half-way from 18 to 17, and
    # back at 30, it is at 17 at 30.5 and at the charger 7 later.
    battery = replace(LANE.robots[0].battery, lasts=40)
    mission = with_robot(battery=battery, absences=(Absence(26.5, 30),))
    changes = {
        "capabilities": ("lift", "scan"),
        "robots": (*mission.robots, Robot("b", (50, 0), {"scan": 1})),
        "tasks": (*mission.tasks, Task("late", (50, 0), {"scan": 1}, appears=70)),
    }
    record = run_trial(replace(mission, **changes, ends="home"), SharedPlan()).record
    assert judge(record).findings == ()
    [charge] = [event for event in record.events if event.kind == "charge"]
    assert (charge.at, charge.place) == (37.5, (10, 0))


def test_a_mission_is_over_when_nobody_gets_to_a_task_any_more_be_there_shifts_to_come() -> None:
    # Home at 44 it has 2 left, and the charger is at 10. The next task appears at 100.
    mission = with_robot(
        battery=replace(LANE.robots[0].battery, lasts=44), shifts=((0.0, 90.0),), every=95.0
    )
    late = Task("late", (25, 0), {"lift": 1}, appears=100)
    mission = replace(mission, tasks=(*mission.tasks, late), ends="home", step_limit=0)
    record = run_trial(mission, SharedPlan()).record
    assert judge(record).findings == ()
    assert (record.end.status, record.end.blocked_tasks) == ("infeasible", ("late",))
    assert record.events[-1].at == 100
