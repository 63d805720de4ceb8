"""The physical world in continuous time, by hand arithmetic; and who may begin what."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from teamformer.mission.coordination import IDLE, UNFORESEEN, Known, Plan
from teamformer.mission.model import Absence, Delays, Mission, Robot, Task, World
from teamformer.mission.parts.capabilities import covers, total
from teamformer.mission.parts.grid import Grid
from teamformer.mission.parts.plane import Plane
from teamformer.mission.parts.roads import Roads
from teamformer.trials.continuous_trial import ending_of
from teamformer.world.continuous.course import Course
from teamformer.world.continuous.delays import StandingStill
from teamformer.world.continuous.events import Event, Passed
from teamformer.world.continuous.ways import Ways

LINE = Grid(11, 1)


class InOrder:
    """Plans tasks in the order of the mission, each for those named who are there and able."""

    def __init__(self, *coalitions: tuple[int, ...]) -> None:
        self._coalitions = coalitions
        self.asked: list[tuple[float, tuple[str, ...]]] = []

    def update(self, known: Known, plan: Plan | None) -> Plan:
        """Return the plan."""
        self.asked.append((known.now, known.news))
        order = [task for task in known.open_tasks if task < len(self._coalitions)]
        there = set(known.robots)
        crews = [tuple(r for r in self._coalitions[task] if r in there) for task in order]
        robots, tasks = known.mission.robots, known.mission.tasks
        for number, task in enumerate(order):
            if not covers(total(robots[r].can for r in crews[number]), tasks[task].needs):
                crews[number] = ()
        return Plan(tuple(order), tuple(crews))


def mission_of(world: World, robots: list[Robot], tasks: list[Task], **more: Any) -> Mission:
    caps = {cap: None for it in robots for cap in it.can}
    return Mission("m", world, tuple(caps), tuple(robots), tuple(tasks), time="continuous", **more)


def robot(x: float, speed: float = 1.0, can: str = "a", **more: Any) -> Robot:
    return Robot(f"r{x:g}{can}{speed:g}", (x, 0), {can: 1}, speed, **more)


def task(x: float, duration: float = 0.0, needs: str = "a", **more: Any) -> Task:
    return Task(more.pop("name", f"t{x:g}"), (x, 0), dict.fromkeys(needs, 1), duration, **more)


def run(mission: Mission, *coalitions: tuple[int, ...], truth: Mission | None = None) -> Course:
    course = Course(mission, mission if truth is None else truth, InOrder(*coalitions))
    course.begin()
    while course.is_running:
        course.go_on()
    return course


def told(course: Course, *kinds: str) -> list[tuple[float, str, tuple[int, ...]]]:
    events = course.world.events
    return [(it.at, it.kind, it.robots) for it in events if it.kind in kinds]


def cause_of(course: Course, event: Event) -> Event:
    return course.world.events[event.cause]


def test_a_team_starts_when_the_last_is_there_and_is_home_after() -> None:
    """There after 4 and 6 / 0.5 = 12, then 3 of service, and as long home."""
    mission = mission_of(LINE, [robot(0), robot(10, 0.5, "b")], [task(4, 3, "ab")], ends="home")
    course = run(mission, (0, 1))
    assert told(course, "arrive", "serve", "done", "over") == [
        (4, "arrive", (0,)),
        (12, "arrive", (1,)),
        (12, "serve", (0, 1)),
        (15, "done", (0, 1)),
        (19, "arrive", (0,)),
        (27, "arrive", (1,)),
        (27, "over", ()),
    ]
    assert (ending_of(course).status, ending_of(course).makespan) == ("completed", 27)


def test_forming_begins_with_the_last_and_those_who_come_together_need_none() -> None:
    """The two come from apart to 2 (there at 2 and 8), form 1.5; to 5 they come together."""
    tasks = [task(2, 1, "ab"), task(5, 1, "ab")]
    course = run(
        mission_of(LINE, [robot(0), robot(10, 1, "b")], tasks, forming=1.5), (0, 1), (0, 1)
    )
    assert told(course, "form", "formed", "serve", "done") == [
        (8, "form", (0, 1)),
        (9.5, "formed", (0, 1)),
        (9.5, "serve", (0, 1)),
        (10.5, "done", (0, 1)),
        (13.5, "serve", (0, 1)),
        (14.5, "done", (0, 1)),
    ]


def test_a_robot_that_is_lost_within_a_cell_goes_on_from_there() -> None:
    """Lost at 2.5 between cells 2 and 3, back at 10: at 3 half a second later, at 6 at 13.5."""
    lost = robot(0, absences=(Absence(2.5, 10),))
    course = run(mission_of(LINE, [lost], [task(6, 1)]), (0,))
    assert told(course, "lost", "back", "arrive", "done") == [
        (2.5, "lost", (0,)),
        (10, "back", (0,)),
        (13.5, "arrive", (0,)),
        (14.5, "done", (0,)),
    ]
    assert course.world.travel == pytest.approx(2.5 + 3.5)


def test_a_service_breaks_off_and_begins_anew_when_enough_are_there() -> None:
    """Served from 2; one of two that are needed is lost at 3, back at 7; then 4 from the start."""
    pair = [robot(2), replace(robot(2, 1, "b"), absences=(Absence(3, 7),))]
    course = run(mission_of(LINE, pair, [task(2, 4, "ab")]), (0, 1))
    assert told(course, "serve", "broken", "done") == [
        (0, "serve", (0, 1)),
        (3, "broken", (0,)),
        (7, "serve", (0, 1)),
        (11, "done", (0, 1)),
    ]


def test_who_is_not_needed_may_be_lost_from_a_service() -> None:
    three = [robot(2), replace(robot(2, 2), absences=(Absence(3),))]
    course = run(mission_of(LINE, three, [task(2, 4)]), (0, 1))
    assert told(course, "serve", "broken", "done") == [(0, "serve", (0, 1)), (4, "done", (0,))]


def test_a_load_goes_as_fast_as_the_slowest_and_lies_where_it_passed_last() -> None:
    """Taken up at 1 by speeds 1 and 0.5: cells at 3, 5, 7. One is lost at 6: the load lies at 2.

    The other is on the way to cell 3, at 7. Alone it cannot lift; the one is back at 8, on at 9 at
    cell 3 and turns to 2: there at 11 (half as fast). Then 1 to take up, 2 x 4 to cell 6.
    """
    two = [robot(0, 1.0), replace(robot(0, 0.5, "b"), absences=(Absence(6, 8),))]
    load = task(0, 1, "ab", to=(6, 0), unload=0.5)
    course = run(mission_of(LINE, two, [load]), (0, 1))
    assert told(course, "lift", "broken", "unload", "done") == [
        (1, "lift", (0, 1)),
        (6, "broken", (0,)),
        (12, "lift", (0, 1)),
        (20, "unload", (0, 1)),
        (20.5, "done", (0, 1)),
    ]
    [broken] = [event for event in course.world.events if event.kind == "broken"]
    assert broken.place == (2, 0)


def test_windows_and_precedence_are_waited_for_at_the_task() -> None:
    """`first` from 2 to 5, its window opens at 4: so from 4 to 7, and `then` beside it at 7."""
    tasks = [task(2, 3, between=(4, 90), name="first"), task(3, 1, after=("first",))]
    course = run(mission_of(LINE, [robot(0), robot(3)], tasks), (0,), (1,))
    assert told(course, "opens", "serve", "done") == [
        (4, "opens", ()),
        (4, "serve", (0,)),
        (7, "done", (0,)),
        (7, "serve", (1,)),
        (8, "done", (1,)),
    ]
    serves = [event for event in course.world.events if event.kind == "serve"]
    assert [cause_of(course, event).kind for event in serves] == ["opens", "done"]


@pytest.mark.parametrize(("gap", "held"), [((0, 0), 8), ((0, 3), 5), ((2, 9), 0)])
def test_a_linked_task_is_held_for_robots_that_come_later(
    gap: tuple[float, float], held: float
) -> None:
    """`late` can start at 8, `early` at 0: held until 8 - most; `late` starts after it."""
    tasks = [task(0, 1, name="early"), task(8, 1, needs="b", starts={"early": gap}, name="late")]
    course = run(mission_of(Grid(20, 1), [robot(0), robot(16, 1, "b")], tasks), (0,), (1,))
    assert told(course, "serve") == [(held, "serve", (0,)), (8, "serve", (1,))]
    assert ending_of(course).broken_links == ()


def test_a_link_that_nobody_can_keep_is_counted_and_holds_nobody() -> None:
    """`early` starts at 7, one before the other can; that one is lost on its way from 7.5 to 20."""
    late = replace(robot(16, 1, "b"), absences=(Absence(7.5, 20),))
    tasks = [task(0, 1, name="early"), task(8, 1, "b", starts={"early": (0, 1)}, name="late")]
    course = run(mission_of(Grid(20, 1), [robot(0), late], tasks), (0,), (1,))
    assert told(course, "serve") == [(7, "serve", (0,)), (20.5, "serve", (1,))]
    assert ending_of(course).broken_links == (("late", "early"),)


def test_what_is_called_off_in_the_moment_it_would_be_done_is_called_off() -> None:
    tasks = [task(2, 3, cancelled=5.0), task(4, 1, after=("t2",))]
    course = run(mission_of(LINE, [robot(0)], tasks), (0,), (0,))
    assert told(course, "cancel", "done", "over") == [
        (5, "cancel", ()),
        (8, "done", (0,)),
        (8, "over", ()),
    ]


def test_a_mission_ends_when_a_task_can_never_be_done() -> None:
    gone = replace(robot(0, 1, "b"), absences=(Absence(1.5),))
    course = run(mission_of(LINE, [robot(0), gone], [task(4), task(6, 1, "b")]), (0,), (1,))
    ending = ending_of(course)
    assert (ending.status, ending.makespan) == ("infeasible", None)
    assert (ending.blocked_tasks, course.world.now) == (("t6",), 1.5)


def test_a_service_that_lasts_longer_is_expected_anew_and_news_only_if_somebody_waits() -> None:
    """Believed 4 of 2 to 6, really 5.5: at 4 expected at 5, the middle of the rest, then at 5.6.

    The latest is at 6: what is left is halved, and never less than a tenth of 6.
    """
    asked = []
    for more in ((), (task(5, 1),)):
        believed = mission_of(LINE, [robot(0)], [task(0, lasts=(2, 6)), *more])
        real = replace(believed.tasks[0], lasts=None, duration=5.5)
        truth = replace(believed, tasks=(real, *more))
        course = run(believed, (0,), (0,), truth=truth)
        overdue = [it for it in course.world.events if it.kind == "overdue"]
        assert [(it.at, it.until) for it in overdue] == [(4, 5), (5, pytest.approx(5.6))]
        coordinator = course.coordinator
        assert isinstance(coordinator, InOrder)
        asked.append([news for _, news in coordinator.asked])
    assert asked == [[("start",)], [("start",), ("service overdue",), ("service overdue",)]]


def test_needs_show_when_somebody_stands_there() -> None:
    """Nobody expects b, which one more robot has to bring: it comes once that is known, at 3."""
    believed = mission_of(LINE, [robot(0), robot(10, 1, "b")], [task(3, 1, may_need={"b": 0.2})])
    real = replace(believed.tasks[0], needs={"a": 1, "b": 1}, may_need={})
    course = Course(believed, replace(believed, tasks=(real,)), Needed())
    course.begin()
    while course.is_running:
        course.go_on()
    assert told(course, "know", "serve") == [(3, "know", (0,)), (10, "serve", (0, 1))]


class Needed:
    """Sends whoever is needed by what is known, as the tests have it."""

    def update(self, known: Known, plan: Plan | None) -> Plan:
        """Return the plan."""
        needs = known.mission.tasks[0].needs
        return Plan((0,), ((0, 1) if "b" in needs else (0,),)) if known.open_tasks else Plan()


def test_a_task_is_found_by_who_comes_near() -> None:
    """Believed at 4, really at 7, seen within 2: at 2 it sees that 4 is empty, at 5 the task."""
    believed = mission_of(LINE, [robot(0)], [task(4, 1, within=3.0)], finding_radius=2.0)
    truth = replace(believed, tasks=(replace(believed.tasks[0], at=(7, 0), within=0.0),))
    course = run(believed, (0,), truth=truth)
    assert told(course, "found", "done") == [(5, "found", (0,)), (8, "done", (0,))]


def test_who_is_delayed_stands_still_in_whole_units() -> None:
    delayed = robot(0, delays=Delays(0.5, seed=3))
    still = StandingStill([delayed])
    stands = [still.after([0], float(unit), 0.5) > unit + 0.5 for unit in range(40)]
    assert 10 < sum(stands) < 30
    walked = [unit for unit in range(40) if not stands[unit]]
    assert still.after([0], 0.0, 2.25) == walked[2] + 0.25
    course = run(mission_of(LINE, [delayed], [task(3)]), (0,))
    assert course.world.now == walked[2] + 1


def test_ways_on_roads_lead_through_all_places_between() -> None:
    table = ((0, 2, 5, 9), (9, 0, 3, 7), (9, 9, 0, 4), (1, 9, 9, 0))
    ways = Ways(Roads(("a", "b", "c", "d"), {"ground": table}))
    assert ways.stages((0, 0), (3, 0)) == [((1, 0), 2.0), ((2, 0), 5.0), ((3, 0), 9.0)]
    assert ways.stages((3, 0), (0, 0)) == [((0, 0), 1.0)]


def test_in_a_plane_one_turns_anywhere() -> None:
    """At 2 of 6 towards (6, 0) a nearer task appears at (2, 3): on its way there 3 more."""
    one = Robot("one", (0, 0), {"a": 1})
    tasks = [Task("new", (2, 3), {"a": 1}, appears=2.0), Task("old", (6, 0), {"a": 1})]
    course = run(mission_of(Plane(9, 9), [one], tasks), (0,), (0,))
    walks = [event for event in course.world.events if event.kind == "walk"]
    assert walks[1].way == (Passed(2.0, (2.0, 0.0)), Passed(5.0, (2, 3)))
    assert course.world.now == 10.0


def test_what_a_plan_leaves_out_is_asked_for_when_nobody_has_anything_to_do() -> None:
    class Reluctant(InOrder):
        def update(self, known: Known, plan: Plan | None) -> Plan:
            made = super().update(known, plan)
            return made if IDLE in known.news else replace(made, coalitions=((),))

    course = Course(mission := mission_of(LINE, [robot(0)], [task(2)]), mission, Reluctant((0,)))
    course.begin()
    while course.is_running:
        course.go_on()
    assert [event.plan.reasons for event in course.world.events if event.plan] == [
        ("start",),
        (IDLE,),
    ]
    assert IDLE not in UNFORESEEN
