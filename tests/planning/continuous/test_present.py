"""What is left of a mission at a moment, as a problem: the rest of the plan ends as before."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from clock_missions import draw_mission
from teamformer.base.errors import MissionError, TeamformerError
from teamformer.files.mission_files import read_mission
from teamformer.methods.coordinators.shared_plan import SharedPlan
from teamformer.mission.coordination import Plan
from teamformer.mission.model import Absence, Mission, Robot, Task
from teamformer.mission.parts.roads import Roads
from teamformer.planning.continuous.continuous_mission import pose_present
from teamformer.planning.continuous.present import plan_present
from teamformer.planning.continuous.repair import repaired
from teamformer.planning.problem.schedule import schedule_of
from teamformer.world.continuous.course import Course

BEHAVIOUR = Path(__file__).parents[2] / "behaviour"
NEAR = 1e-9


def check_presents(mission: Mission) -> int:
    """Run a mission undisturbed; pose each third moment, and compare ends. Return how many."""
    course = Course(mission, mission, SharedPlan())
    course.begin()
    assert course.follower.plan is not None
    first = course.follower.plan
    ends = dict(zip(first.order, first.ends, strict=True))
    posed_presents = moments = 0
    while course.is_running:
        course.go_on()
        moments += 1
        known = course.known()
        if moments % 3 or not known.possible_tasks:
            continue
        posed, rest = pose_present(known), course.follower.rest(course.world)
        mended = repaired(posed, rest)
        assert mended is not None
        again = posed.as_plan(mended)
        left = {task: ends[task] for task in again.order}
        assert dict(zip(again.order, again.ends, strict=True)) == pytest.approx(left, rel=NEAR)
        if not any(task.starts for task in mission.tasks):  # in ticks too
            timed = schedule_of(posed.problem, mended).end[: len(left)] / posed.scale + known.now
            assert timed.tolist() == pytest.approx([left[task] for task in posed.tasks], rel=1e-5)
        posed_presents += 1
    return posed_presents


@pytest.mark.parametrize(("name", "presents"), [("roads.yaml", 4), ("visits.yaml", 2)])
def test_the_rest_of_a_plan_ends_as_before(name: str, presents: int) -> None:
    assert check_presents(read_mission(BEHAVIOUR / name)) >= presents


@pytest.mark.parametrize("seed", range(20))
def test_the_rest_of_plans_of_drawn_missions_ends_as_before(seed: int) -> None:
    mission = draw_mission(seed)
    robots = (replace(it, absences=(), breaks=None, delays=None) for it in mission.robots)
    tasks = (
        replace(it, appears=0.0, cancelled=None, lasts=None, may_need={}, within=0.0)
        for it in mission.tasks
    )
    try:
        check_presents(replace(mission, robots=tuple(robots), tasks=tuple(tasks), arrivals=None))
    except (MissionError, TeamformerError):  # linked tasks for which there are too few robots
        return


TABLE = ((0.0, 4.0, 10.0), (4.0, 0.0, 6.0), (10.0, 6.0, 0.0))
"""From a by b to c: 4 and 6."""


def on_a_road() -> Course:
    """Return a mission 1 after its start: one robot on its way from a by b to c."""
    mission = Mission(
        "road",
        Roads(("a", "b", "c"), {"ground": TABLE}),
        ("lift",),
        (Robot("one", (0, 0), {"lift": 1}), Robot("two", (0, 0), {"lift": 1}, speed=0.1)),
        (Task("far", (2, 0), {"lift": 1}, 1.0), Task("late", (1, 0), {"lift": 1}, 2.0, 1.0)),
        time="continuous",
        ends="home",
    )
    course = Course(mission, mission, SharedPlan())
    course.begin()
    course.go_on()
    assert course.world.now == 1.0
    return course


def test_a_robot_on_a_road_is_free_at_the_next_place_that_its_way_leads_through() -> None:
    """It is at b at 4. So `late` there is done from 4 to 6, and `far`, 6 on, from 12 to 13.

    As long as it takes the other way round: from 10 to 11, from 17 to 19, and home at 23.
    """
    course = on_a_road()
    known = course.known(("task appeared",))
    assert (known.places[0], known.free_at[0], known.came_from[0]) == ((1, 0), 4.0, (0, 0))
    posed = pose_present(known)
    for order, ends in (((1, 0), (6.0, 13.0)), ((0, 1), (11.0, 19.0))):
        assert posed.as_plan(posed.as_arrays(Plan(order, ((0,), (0,))))).ends == ends
    while course.is_running:
        course.go_on()
    assert course.world.now == 23.0


def test_who_is_lost_is_replaced_and_new_tasks_come_last() -> None:
    course = on_a_road()
    known = replace(course.known(), teams=((1,),))
    posed = pose_present(known)
    mended = repaired(posed, Plan((0,), ((0,),)))
    assert mended is not None
    plan = posed.as_plan(mended)
    assert (plan.order, plan.coalitions) == ((0, 1), ((1,), (1,)))


def test_a_plan_after_news_is_never_worse_than_what_is_left() -> None:
    mission = read_mission(BEHAVIOUR / "roads.yaml")
    lost = (replace(mission.robots[0], absences=(Absence(2.5),)), *mission.robots[1:])
    course = Course(mission, replace(mission, robots=lost), SharedPlan())
    course.begin()
    while course.world.next_time < 2.5:
        course.go_on()
    known = replace(course.known(), teams=((1,), (2,), (3,)), now=2.5)
    posed, rest = pose_present(known), course.follower.rest(course.world)
    mended = repaired(posed, rest)
    assert mended is not None
    kept = posed.worth_of(posed.time(mended))
    again = plan_present(known, rest)
    number_of = {task: number for number, task in enumerate(posed.tasks)}
    robot_of = {robot: number for number, robot in enumerate(posed.robots)}
    numbered = Plan(
        tuple(number_of[task] for task in again.order),
        tuple(tuple(robot_of[robot] for robot in robots) for robots in again.coalitions),
    )
    found = posed.worth_of(posed.time(posed.as_arrays(numbered, with_spares=True)))
    assert found <= kept + NEAR
