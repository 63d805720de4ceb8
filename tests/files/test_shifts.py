"""Shifts of robots: read, written, refused; and how long walks take by them, by hand."""

from __future__ import annotations

import math
import random
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from teamformer.base.errors import MissionError
from teamformer.files.mission_files import mission_from_tree, read_mission, write_mission
from teamformer.methods.by_name import load_method
from teamformer.mission.checks.rules import rules_not_played
from teamformer.mission.model import Arrivals, Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.mission.parts.shifts import ALWAYS, Rota, fits_all
from teamformer.mission.truth import draw_truth
from teamformer.record.files.reading import read_record
from teamformer.record.files.writing import save_record
from teamformer.record.referee import judge
from teamformer.trials.trial import run_trial

DAY = Rota(((8, 12), (13, 17)), 24)
ONCE = Rota(((0, 4), (6, 10)))

MISSION = Mission(
    "mission",
    Grid(9, 9),
    ("a", "b"),
    (
        Robot("p", (0, 0), {"a": 1}, shifts=((0, 4), (6, 10)), every=12),
        Robot("q", (0, 0), {"b": 1}, shifts=((3, 9.5),)),
        Robot("r", (0, 0), {"a": 1}),
    ),
    (Task("x", (1, 1), {"a": 1, "b": 1}, duration=2),),
    time="continuous",
)


@pytest.mark.parametrize("name", ["mission.yaml", "mission.json"])
def test_what_is_written_is_read(name: str, tmp_path: Path) -> None:
    write_mission(MISSION, tmp_path / name)
    assert read_mission(tmp_path / name) == MISSION


def test_a_walk_pauses_between_shifts() -> None:
    assert ONCE.walked(1, 2) == 3
    assert ONCE.walked(1, 3) == 4  # just done when the shift ends
    assert ONCE.walked(1, 5) == 8
    assert ONCE.walked(4.5, 1) == 7
    assert ONCE.walked(1, 7.5) == math.inf  # it works 7 from then on
    assert ONCE.walked(11, 0) == 11
    assert list(ONCE.walks(1, 5)) == [(1, 4), (6, 8)]
    assert DAY.walked(0, 1) == 9
    assert DAY.walked(11, 6) == 24 + 9
    assert DAY.walked(16, 16) == 48 + 16
    assert ALWAYS.walked(3, 2) == 5


def test_something_fits_into_one_shift_of_each() -> None:
    assert ONCE.fits(0, 4) == 0
    assert ONCE.fits(0.5, 4) == 6
    assert ONCE.fits(0, 4.5) == math.inf
    assert DAY.fits(13.5, 4) == 24 + 8
    assert fits_all([ONCE, Rota(((0, 2), (3, 9)))], 0, 2.5) == 6
    assert fits_all([ONCE, ALWAYS], 3, 2) == 6
    assert fits_all([ALWAYS], 3, 2) == 3
    assert fits_all([], 3, 2) == 3
    assert fits_all([Rota(((0, 2),), 5), Rota(((3, 5),), 5)], 0, 1) == math.inf  # turn about
    assert fits_all([Rota(((0, 2),), 5), Rota(((3, 5),), 6)], 0, 1) == 10  # 10 to 12, 9 to 11


def test_shifts_are_counted_from_a_moment() -> None:
    later = DAY.counted_from(20)
    assert later.shifts == ((-12, -8), (-7, -3))
    for begin, spent in [(0.0, 1.0), (5, 6), (30, 20)]:
        assert later.walked(begin, spent) == DAY.walked(begin + 20, spent) - 20


def test_when_somebody_works_and_for_how_long() -> None:
    assert [DAY.is_at_work(now) for now in (0, 8, 11.9, 12, 13, 17, 32)] == [
        *(False, True, True, False, True, False, True)
    ]
    assert DAY.worked(0, 48) == 16
    assert DAY.worked(9, 14) == 4


def test_walks_take_the_time_that_is_worked() -> None:
    rng = random.Random(3)
    for _ in range(300):
        moments = sorted(rng.sample(range(40), 2 * rng.randint(1, 4)))
        shifts = tuple(zip(moments[::2], moments[1::2], strict=True))
        rota = Rota(shifts, rng.choice([0, moments[-1] - moments[0], 50]))
        begin, spent = rng.randint(0, 60), rng.randint(1, 30)
        end = rota.walked(begin, spent)
        if math.isinf(end):
            assert not rota.every
            assert rota.worked(begin, 1000) < spent
        else:
            assert rota.worked(begin, end) == spent
            assert rota.worked(begin, end - 1) == spent - 1  # not before


@pytest.mark.parametrize(
    ("robot", "told"),
    [
        ({"shifts": ((5, 5),)}, "has a shift from 5 to 5; use [begin, end], 0 or more and in"),
        ({"shifts": ((-1, 5),)}, "has a shift from -1 to 5; use [begin, end]"),
        ({"shifts": ((0, math.nan),)}, "has a shift from 0 to nan; use [begin, end]"),
        ({"shifts": ((0, 5), (4, 9))}, "has a shift from 4 on, before the one before it ends at 5"),
        ({"every": 9.0}, "robot 'p' has every but no shifts; add shifts or drop it"),
        ({"shifts": ((0, 5),), "every": -1}, "come again every -1; use more than 0"),
        ({"shifts": ((2, 5), (6, 9)), "every": 6.5}, "every 6.5, but take 7 from first to last"),
        ({"shifts": ((0, 1.5), (9, 12))}, "task 'x' takes 2, but robots that can do it have no"),
    ],
)
def test_shifts_are_refused(robot: dict[str, Any], told: str) -> None:
    first, second, _ = MISSION.robots
    changed = replace(first, **{"shifts": (), "every": 0.0} | robot)
    with pytest.raises(MissionError) as refused:
        replace(MISSION, robots=(changed, second))
    assert told in str(refused.value)


@pytest.mark.parametrize("time", ["continuous", "steps"])
def test_ways_there_and_of_loads_have_to_fit_as_well(time: str) -> None:
    """a works from 0 to 10, b always; it is 20 to x, and 28 from y to where its load goes."""
    robots = (Robot("p", (0, 0), {"a": 1}, shifts=((0, 10),)), Robot("q", (0, 0), {"a": 1}))
    far = Task("x", (20, 0), {"a": 2}, duration=2)
    load = Task("y", (2, 0), {"a": 1}, duration=2, to=(30, 0))
    given = Mission("m", Grid(40, 40), ("a",), robots, (load,), time=time)
    cases = [
        ((robots[0], robots[1]), far, "robots that can do task 'x' do not get there within"),
        ((replace(robots[0], every=20.0),), load, "task 'y' takes 30 or more with the way of its"),
        ((robots[0],), replace(load, at=(9, 0), to=None), "robots that can do task 'y' do not get"),
    ]
    for fleet, task, told in cases:
        with pytest.raises(MissionError) as refused:
            replace(given, robots=fleet, tasks=(task,))
        [problem] = refused.value.problems
        assert problem.message.startswith(told)
        may_be_missed = (replace(task, optional=True),)
        missed = replace(given, robots=fleet, tasks=may_be_missed, until=60.0)
        record = run_trial(missed, load_method("plan")).record
        assert record.end.missed == (task.name,)
        assert judge(record).findings == ()
    replace(given, robots=(robots[0],), tasks=(replace(load, at=(3, 4), to=(4, 4)),))
    replace(given, robots=(replace(robots[0], every=20.0), robots[1]), tasks=(far,))


def test_shifts_that_touch_and_tasks_that_just_fit_are_good() -> None:
    first, second, _ = MISSION.robots
    for shifts in [((0, 4), (4, 8)), ((7.5, 9.5),)]:
        there = replace(first, at=(1, 1), shifts=shifts, every=0.0)
        replace(MISSION, robots=(there, second))


def test_what_is_no_list_of_windows_is_refused_with_its_place() -> None:
    tree = {
        "teamformer": 1,
        "world": {"grid": [3, 3]},
        "capabilities": ["a"],
        "robots": [
            {"at": [0, 0], "can": ["a"], "shifts": []},
            {"at": [0, 0], "can": ["a"], "shifts": [3, [1, 2, 3]]},
        ],
        "tasks": [{"at": [1, 1], "needs": ["a"]}],
    }
    with pytest.raises(MissionError) as refused:
        mission_from_tree(tree)
    assert [problem.where for problem in refused.value.problems] == [
        ("robots", 0, "shifts"),
        ("robots", 1, "shifts", 0),
        ("robots", 1, "shifts", 1),
    ]


def test_in_steps_shifts_are_whole_numbers_of_steps() -> None:
    first, second, third = MISSION.robots
    whole = replace(second, shifts=((3, 9),))
    odd = replace(first, name="s", shifts=((0, 4), (6.5, 10)))
    robots = (replace(first, every=12.5), odd, whole, third)
    with pytest.raises(MissionError) as refused:
        replace(MISSION, time="steps", robots=robots)
    assert [problem.message for problem in refused.value.problems] == [
        "the shifts of robot 'p' come again every 12.5; in steps use a whole number",
        "robot 's' has a shift from 6.5 to 10; in steps use whole numbers",
    ]
    assert not list(rules_not_played(replace(MISSION, time="steps", robots=(first, whole, third))))


def test_in_steps_nothing_begins_before_the_first_one() -> None:
    """So a task of two steps does not fit into a shift from 0 to 2."""
    robots = [Robot("p", (1, 1), {"a": 1, "b": 1}, shifts=((0, end),)) for end in (2, 3)]
    good = replace(MISSION, time="steps", robots=(robots[1],))
    assert not list(rules_not_played(good))
    with pytest.raises(MissionError) as refused:
        replace(good, robots=(robots[0],))
    assert "task 'x' takes 2, but robots that can do it have no shift" in str(refused.value)
    replace(good, time="continuous", robots=(robots[0],))


def test_tasks_that_appear_must_fit_as_well() -> None:
    """What needs `a` and `b` has 4 to 9 or so in common; what needs one of them has more."""
    rules = {"time": "steps", "step_limit": 0}
    robots = (replace(MISSION.robots[0], every=0), replace(MISSION.robots[1], shifts=((3, 9),)))
    for most, lasts in [(0, 3), (1, 4)]:
        replace(MISSION, robots=robots, arrivals=Arrivals(0.1, 9, most, lasts), **rules)
        with pytest.raises(MissionError) as refused:
            replace(MISSION, robots=robots, arrivals=Arrivals(0.1, 9, most, lasts + 1), **rules)
        assert "tasks that appear take" in str(refused.value)


def test_a_truth_need_not_fit_into_shifts(tmp_path: Path) -> None:
    """Robots that are there after step 7 or later have no four steps left; the record is legal."""
    robots = tuple(replace(robot, shifts=((0, 5), (6, 11)), every=0) for robot in MISSION.robots)
    task = replace(MISSION.tasks[0], at=(3, 0), within=6, duration=4)
    mission = replace(MISSION, time="steps", robots=robots, tasks=(task,), step_limit=30)
    seed = next(n for n in range(99) if max(draw_truth(mission, n).tasks[0].at) >= 8)
    record = run_trial(mission, load_method("plan"), seed).record
    assert record.end.blocked_tasks == ("x",)
    save_record(record, tmp_path / "record.json")
    assert not judge(read_record(tmp_path / "record.json")).findings


def test_no_sensible_method_reaches_the_limit_of_steps() -> None:
    """Half the time is worked, so all takes twice as long; 10 turns of 12 for each of 2 tasks."""
    robots = tuple(replace(robot, shifts=((0, 6),), every=12) for robot in MISSION.robots)
    always = tuple(Robot(r.name, r.at, r.can) for r in robots)
    plain = replace(MISSION, robots=always, step_limit=0)
    limit = replace(MISSION, robots=robots, step_limit=0).step_limit
    assert limit == plain.step_limit / 0.5 + 10 * 2 * 12 + 6
