"""Missions that are over at a time: what is missed, when and why, by hand; and the referee."""

from __future__ import annotations

from dataclasses import replace
from random import Random
from typing import Any

import pytest

from every_optional_plan import draw_mission
from teamformer.base.errors import TeamformerError
from teamformer.methods.coordinators.shared_plan import SharedPlan
from teamformer.mission.model import Absence, Mission, Robot, Task
from teamformer.mission.parts.charging import Battery, Charger
from teamformer.mission.parts.grid import Grid
from teamformer.planning.continuous.continuous_mission import pose_mission
from teamformer.planning.continuous.rules import plan_continuous
from teamformer.record.record import Record
from teamformer.record.referee import judge
from teamformer.record.task_times import missed_tasks
from teamformer.trials.trial import run_trial


def line(tasks: list[Task], robots: int = 1, **more: Any) -> Mission:
    """Return a mission on a line of cells; robots stand at 0 and do one cell a unit of time."""
    fleet = tuple(Robot(f"r{n}", (0, 0), {"a": 1}) for n in range(robots))
    world, at = Grid(41, 1), more.pop("until", 20.0)
    return Mission("m", world, ("a",), fleet, tuple(tasks), time="continuous", until=at, **more)


def task(name: str, x: int, duration: float = 2.0, **more: Any) -> Task:
    return Task(name, (x, 0), {"a": 1}, duration, **({"optional": True} | more))


def run(mission: Mission) -> Record:
    record = run_trial(mission, SharedPlan(), 0).record
    assert judge(record).findings == ()
    return record


def missed(record: Record) -> dict[str, tuple[float, str]]:
    tasks = record.mission.tasks
    return {tasks[e.task].name: (e.at, e.why) for e in record.events if e.kind == "missed"}


def test_what_is_left_out_is_given_up_once_nobody_has_anything_to_do() -> None:
    """5 there and 2 at work; 30 is too far, and 15 is not reached after 5 is done."""
    record = run(line([task("near", 5, optional=False), task("far", 30), task("other", 15, 9)]))
    assert (record.end.status, record.end.makespan) == ("completed", 7)
    assert missed(record) == {"far": (7, "too far"), "other": (7, "too far")}
    assert record.end.missed == ("far", "other")


def test_who_could_do_it_may_have_other_things_to_do() -> None:
    record = run(line([task("near", 5, 9, optional=False), task("other", 15)]))
    assert missed(record) == {"other": (14, "nobody free")}


@pytest.mark.parametrize("time", ["continuous", "steps"])
def test_shifts_may_leave_no_time(time: str) -> None:
    """There after 5, it takes 4 of the 3 that are left of the only shift."""
    given = line([task("near", 2, optional=False), task("x", 5, 4)])
    robots = tuple(replace(robot, shifts=((0, 8),)) for robot in given.robots)
    record = run(replace(given, robots=robots, time=time))
    assert {number: why for number, (_, why) in missed_tasks(record).items()} == {1: "no shift"}


def test_a_task_may_end_when_the_mission_does_and_no_later() -> None:
    assert missed(run(line([task("x", 18)]))) == {}
    assert missed(run(line([task("x", 19)]))) == {"x": (0, "too far")}


def test_a_task_that_must_be_done_and_is_not_fails_the_mission() -> None:
    """The service is believed to take 4 and takes 6: at 20 it is under way."""
    slow = task("x", 15, optional=False, lasts=(3, 7))
    mission = line([slow])
    truth = replace(mission, tasks=(replace(slow, lasts=None, duration=6.0),))
    record = run_trial(mission, SharedPlan(), 0, truth=truth).record
    assert judge(record).findings == ()
    assert (record.end.status, record.end.makespan, record.length) == ("too late", None, 20)
    assert missed(record) == {"x": (20, "under way")}


def test_who_comes_too_late_gives_the_task_up() -> None:
    """The service at 5 is believed to end at 9 and ends at 11; 15 would end at 21 + 2."""
    first = task("a", 5, optional=False, lasts=(2, 6))
    mission = line([first, task("b", 13, 2.5)])
    truth = replace(mission, tasks=(replace(first, lasts=None, duration=6.0), mission.tasks[1]))
    record = run_trial(mission, SharedPlan(), 0, truth=truth).record
    assert judge(record).findings == ()
    assert missed(record)["b"][1] in ("too late", "nobody free")
    assert record.end.status == "completed"


def test_a_task_that_is_called_off_is_not_missed() -> None:
    cost = {"makespan": 1.0, "missed": 10.0}
    gone = task("gone", 30, cancelled=3.0)
    record = run(line([task("near", 5), gone, task("far", 31)], cost=cost))
    assert list(missed(record)) == ["far"]
    assert record.end.cost == pytest.approx((7 + 10) / 11)


def test_a_robot_that_is_due_back_is_waited_for() -> None:
    mission = line([task("x", 5)])
    away = replace(mission.robots[0], absences=(Absence(1.0, 8.0),))
    record = run(replace(mission, robots=(away,)))
    assert (record.end.status, missed(record)) == ("completed", {})
    assert record.end.makespan == 14  # 4 cells from 8 on, and 2 at work


@pytest.mark.parametrize("seed", range(12))
def test_undisturbed_missions_run_as_they_are_planned(seed: int) -> None:
    mission = draw_mission(seed, tasks=8, share=0.15)
    made = plan_continuous(pose_mission(mission), "plan", 0)
    assert made is not None
    record = run(mission)
    if record.end.status == "completed":
        assert record.end.makespan == pytest.approx(made.makespan, rel=1e-12)
        assert record.end.missed == tuple(mission.tasks[k].name for k in made.missed)


@pytest.mark.parametrize("seed", range(8))
def test_whatever_happens_records_are_legal(seed: int) -> None:
    mission, draws = draw_mission(seed, tasks=8, share=0.15), Random(seed)
    robots, tasks = list(mission.robots), list(mission.tasks)
    lost = draws.randrange(len(robots))
    at = draws.uniform(5, 60)
    robots[lost] = replace(robots[lost], absences=(Absence(at, at + draws.uniform(5, 60)),))
    for k in range(1, len(tasks)):
        if draws.random() < 0.4:
            tasks[k] = replace(tasks[k], appears=draws.uniform(1, 80))
    run(replace(mission, robots=tuple(robots), tasks=tuple(tasks)))


def test_nobody_waits_for_an_optional_task_that_the_plan_leaves_out() -> None:
    """Both are to start together; at 5, as it is over, only the one that takes no time is done."""
    linked = [task("long", 5, weight=0.001), task("short", 5, 0, starts={"long": (0.0, 0.0)})]
    record = run(line(linked, robots=2, until=5.0))
    assert missed(record) == {"long": (5, "too far")}
    assert (record.end.status, record.end.makespan) == ("completed", 5)


def test_optional_tasks_that_cannot_start_together_are_missed() -> None:
    """The battery of one of two robots takes it to 10 and back only; what must be is refused."""
    linked = [task("one", 12), task("other", 15, starts={"one": (0.0, 0.0)}), task("more", 9)]
    given = line(linked, robots=2, chargers=(Charger((0, 0)),), until=50.0)
    weak = replace(given.robots[0], battery=Battery(lasts=20, fills=1.0))
    given = replace(given, robots=(weak, given.robots[1]))
    assert sorted(missed(run(given))) == ["one", "other"]
    must = tuple(replace(it, optional=it.name == "more") for it in linked)
    with pytest.raises(TeamformerError, match="too few get to a charger from there"):
        run_trial(replace(given, tasks=must), SharedPlan(), 0)
