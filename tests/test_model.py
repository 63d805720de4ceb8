"""The words of the project: what they refuse, and the step limit, by hand arithmetic."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import pytest

from teamformer.base.errors import MissionError
from teamformer.mission.model import (
    MOST_WAITING,
    MOST_WALKING,
    Absence,
    Mission,
    Robot,
    Task,
    default_step_limit,
)
from teamformer.mission.parts.grid import Grid, Place

LIFTER = Robot("a", (0, 0), {"lift": 1})
SCANNER = Robot("b", (0, 0), {"scan": 1})
CRATE = Task("x", (3, 2), {"lift": 1, "scan": 1})


def mission(**changes: Any) -> Mission:
    """Return two robots at [0, 0] of 4 x 3 cells and a task at [3, 2] that needs both."""
    parts: dict[str, Any] = {
        "name": "small",
        "world": Grid(4, 3),
        "capabilities": ("lift", "scan"),
        "robots": (LIFTER, SCANNER),
        "tasks": (CRATE,),
    }
    return Mission(**(parts | changes))


def robots(**changes: Any) -> dict[str, Any]:
    return {"robots": (LIFTER, replace(SCANNER, **changes))}


def third(can: dict[str, float]) -> dict[str, Any]:
    return {"robots": (LIFTER, SCANNER, Robot("c", (0, 0), can))}


def tasks(**changes: Any) -> dict[str, Any]:
    return {"tasks": (replace(CRATE, **changes),)}


WORLD, ROBOT, TASK, TEAM = ("world",), ("robots", 1), ("tasks", 0), ("teams", 0)
EDGES: list[tuple[dict[str, Any], dict[str, Any] | None, tuple[str | int, ...], str]] = [
    # what is refused, its nearest that is not, where, the message
    ({"world": Grid(0, 3)}, None, WORLD, "the grid is 0 x 3; make it 1 x 1 or more"),
    ({"world": Grid(4, -1)}, None, WORLD, "the grid is 4 x -1; make it 1 x 1 or more"),
    (
        {"world": Grid(4, 3, ("....", "...", "...."))},
        {"world": Grid(4, 3, ("....",) * 3)},
        WORLD,
        "the rows of the map are not all 4 cells long",
    ),
    (
        {"world": Grid(4, 3, ("....",) * 2)},
        {"world": Grid(4, 3, ("....",) * 3)},
        WORLD,
        "the map has 2 rows, not 3",
    ),
    ({"tasks": ()}, None, ("tasks",), "there is no task; add one"),
    (
        {"capabilities": ("lift", "scan", "lift")},
        None,
        ("capabilities", 2),
        "the name 'lift' is used twice; rename one",
    ),
    (robots(name="a"), robots(name="A"), ROBOT, "the name 'a' is used twice; rename one"),
    (
        {"tasks": (CRATE, CRATE)},
        {"tasks": (CRATE, replace(CRATE, name="y"))},
        ("tasks", 1),
        "the name 'x' is used twice; rename one",
    ),
    (
        {"sensing_radius": -0.5},
        {"sensing_radius": 0.0},
        ("sensing_radius",),
        "sensing_radius is -0.5; it must be 0 or more",
    ),
    (
        {"sensing_radius": math.nan},
        {"sensing_radius": math.inf},
        ("sensing_radius",),
        "sensing_radius is nan; it must be 0 or more",
    ),
    (
        {"join_radius": -1.0},
        {"join_radius": 1.0},
        ("join_radius",),
        "join_radius is -1.0; it must be 0 or more",
    ),
    (
        {"join_radius": 1.5},
        {"join_radius": 1.5, "sensing_radius": 1.5},
        ("join_radius",),
        "join_radius 1.5 is larger than sensing_radius 1; "
        "a team joins only what it senses, so raise the latter",
    ),
    (
        {"forming_steps": 2},
        {"forming_steps": 0},
        ("forming_steps",),
        "forming_steps is 2; use 0 or 1",
    ),
    ({"step_limit": -1}, {"step_limit": 1}, ("step_limit",), "step_limit is -1; use 1 or more"),
    (
        robots(at=(4, 0)),
        robots(at=(3, 0)),
        (*ROBOT, "at"),
        "robot 'b' is at [4, 0], outside the map; x goes from 0 to 3 and y from 0 to 2",
    ),
    (
        tasks(at=(0, -1)),
        tasks(at=(0, 0)),
        (*TASK, "at"),
        "task 'x' is at [0, -1], outside the map; x goes from 0 to 3 and y from 0 to 2",
    ),
    (
        {"world": Grid(4, 3, ("....", "....", "...@"))},
        {"world": Grid(4, 3, ("....", "....", "..@."))},
        (*TASK, "at"),
        "task 'x' is at [3, 2], inside an obstacle; the nearest free cell is [2, 2]",
    ),
    (
        {"world": Grid(4, 3, ("....", "...@", "..@."))},
        {"world": Grid(4, 3, ("....", "....", "..@."))},
        (*TASK, "at"),
        "task 'x' cannot be reached by robots that bring lift, scan; move it, open the map, or let "
        "such robots fly with moves: air",
    ),
    (
        {"world": Grid(4, 3, ("..@.",) * 3), **robots(at=(3, 0))},
        {"world": Grid(4, 3, (".@..", "....", "....")), **robots(at=(3, 0))},
        (*TASK, "at"),
        "task 'x' cannot be reached by robots that bring lift; move it, open the map, or let such "
        "robots fly with moves: air",
    ),
    (
        third(can={}),
        third(can={"lift": 1}),
        ("robots", 2, "can"),
        "robot 'c' can nothing; name at least one capability",
    ),
    (
        third(can={"scan": 0}),
        third(can={"scan": 0.001}),
        ("robots", 2, "can", "scan"),
        "robot 'c' can 'scan' 0 times; use more than 0",
    ),
    (
        robots(can={"scan": 1, "weld": 1}),
        robots(can={"scan": 1, "lift": 1}),
        (*ROBOT, "can"),
        "robot 'b' can 'weld', which is not under capabilities; add it there",
    ),
    (
        robots(speed=0.00099),
        robots(speed=0.001),
        (*ROBOT, "speed"),
        "robot 'b' has speed 0.00099; use 0.001 to 1000",
    ),
    (
        robots(speed=1000.5),
        robots(speed=1000.0),
        (*ROBOT, "speed"),
        "robot 'b' has speed 1000.5; use 0.001 to 1000",
    ),
    (
        robots(absences=(Absence(0),)),
        robots(absences=(Absence(1),)),
        (*ROBOT, "lost"),
        "robot 'b' is lost at step 0; the first step is 1",
    ),
    (
        robots(can={"scan": 16_000_001}),
        robots(can={"scan": 16_000_000}),
        ("robots",),
        "all robots together have 16000001 x 'scan'; 16000000 are possible",
    ),
    (
        robots(can={"scan": 1}) | third({"scan": 16_000.001}),
        robots(can={"scan": 1}) | third({"scan": 16_000.002}),
        ("robots",),
        "all robots together have 16001.001 x 'scan'; 16000 are possible in steps of 0.001, "
        "so use rounder figures",
    ),
    ({"teams": ((),)}, {"teams": ()}, TEAM, "this starting team has no robot; remove it"),
    ({"teams": ((0, 2),)}, {"teams": ((0, 1),)}, TEAM, "there is no robot number 2"),
    ({"teams": ((-1,),)}, {"teams": ((0,),)}, TEAM, "there is no robot number -1"),
    (
        {"teams": ((0,), (0, 1))},
        {"teams": ((0,), (1,))},
        ("teams", 1),
        "robot 'a' is in two starting teams; keep one",
    ),
    (
        {"teams": ((0, 1),), **robots(at=(1, 0))},
        {"teams": ((0,),), **robots(at=(1, 0))},
        TEAM,
        "the robots of a starting team must start in the same place",
    ),
    (
        tasks(needs={}),
        tasks(needs={"lift": 1}),
        (*TASK, "needs"),
        "task 'x' needs nothing; name at least one capability",
    ),
    (
        tasks(needs={"lift": 2, "scan": 3}),
        tasks(needs={"lift": 1, "scan": 1}),
        (*TASK, "needs"),
        "task 'x' needs 2 x lift, 3 x scan but all robots together have 1 x lift, 1 x scan; "
        "add such a robot or lower the requirement",
    ),
    (
        {"capabilities": ("lift", "scan", "weld", "dig"), **tasks(needs={"weld": 1, "dig": 1})},
        {"capabilities": ("lift", "scan", "weld", "dig")},
        (*TASK, "needs"),
        "task 'x' needs 'weld', 'dig' but no robot has them; "
        "add such a robot or drop the requirement",
    ),
    (
        tasks(duration=-1),
        tasks(duration=0),
        (*TASK, "duration"),
        "task 'x' has duration -1; use 0 or more",
    ),
    (
        tasks(appears=-1),
        tasks(appears=0),
        (*TASK, "appears"),
        "task 'x' has appears -1; use 0 or more",
    ),
    # what files cannot say, but Python can
    (
        {"world": Grid(1_400_001, 3)},
        {"world": Grid(1_400_000, 3)},
        WORLD,
        "the grid has 4,200,003 cells; 4,200,000 are possible",
    ),
    (
        robots(at=(0.5, 0)),
        robots(at=(1.0, 0)),
        (*ROBOT, "at"),
        "robot 'b' is at [0.5, 0], which is no cell; use whole numbers",
    ),
    (
        tasks(at=(1, math.nan)),
        tasks(at=(1, 1)),
        (*TASK, "at"),
        "task 'x' is at [1, nan], which is no cell; use whole numbers",
    ),
    (
        third(can={"scan": 1.0005}),
        third(can={"scan": 1.001}),
        ("robots", 2, "can", "scan"),
        "robot 'c' can 'scan' 1.0005 times; round it to 3 places",
    ),
    (
        third(can={"scan": math.inf}),
        third(can={"scan": 1}),
        ("robots", 2, "can", "scan"),
        "robot 'c' can 'scan' inf times; use more than 0",
    ),
    (
        robots(absences=(Absence(2.5),)),
        robots(absences=(Absence(2),)),
        (*ROBOT, "lost"),
        "robot 'b' is lost at step 2.5; use a whole number up to 1,000,000,000",
    ),
    (
        tasks(duration=10**9 + 1),
        tasks(duration=10**9),
        (*TASK, "duration"),
        "task 'x' has duration 1000000001; use a whole number up to 1,000,000,000",
    ),
    (
        tasks(appears=10**9 + 1),
        tasks(appears=10**9),
        (*TASK, "appears"),
        "task 'x' has appears 1000000001; use a whole number up to 1,000,000,000, counted from the "
        "mission's start",
    ),
    (
        tasks(between=(0, 1.5e9)),
        tasks(between=(0, 1e9)),
        (*TASK, "between"),
        "task 'x' is to be done between 0 and 1.5e+09; use [begin, end], up to 1e9, counted from "
        "the mission's start",
    ),
    (
        tasks(appears=math.nan),
        tasks(appears=1),
        (*TASK, "appears"),
        "task 'x' has appears nan; use 0 or more",
    ),
    (
        {"step_limit": 9_999_999_999},
        {"step_limit": 10**9},
        ("step_limit",),
        "step_limit is 9999999999; use a whole number up to 1,000,000,000",
    ),
]


@pytest.mark.parametrize(("wrong", "right", "where", "message"), EDGES)
def test_what_is_impossible_is_refused_at_the_edge(
    wrong: dict[str, Any],
    right: dict[str, Any] | None,
    where: tuple[str | int, ...],
    message: str,
) -> None:
    with pytest.raises(MissionError) as caught:
        mission(**wrong)
    assert [(problem.where, problem.message) for problem in caught.value.problems] == [
        (where, message)
    ]
    if right is not None:
        mission(**right)


def test_without_robots_there_is_nobody_for_the_tasks_either() -> None:
    with pytest.raises(MissionError) as caught:
        mission(robots=())
    assert [problem.where for problem in caught.value.problems] == [
        ("robots",),
        ("tasks", 0, "needs"),
    ]


def test_all_problems_are_told_at_once() -> None:
    with pytest.raises(MissionError) as caught:
        mission(
            step_limit=-1,
            **robots(speed=-1.0, absences=(Absence(0),)),
            **tasks(at=(9, 9), duration=-1),
        )
    assert len(caught.value.problems) == 5
    assert len(str(caught.value).splitlines()) == 5


def test_a_requirement_must_be_met_on_the_tasks_side_of_a_wall() -> None:
    """Each side of the wall has a lifter, but only the left has the scanner."""
    walled = Grid(4, 3, ("..@.",) * 3)
    right = Robot("c", (3, 0), {"lift": 1})
    with pytest.raises(MissionError, match="robots that bring scan"):
        mission(world=walled, robots=(LIFTER, SCANNER, right))
    lifted = (replace(CRATE, needs={"lift": 1}), Task("y", (1, 2), {"scan": 1}))
    mission(world=walled, robots=(LIFTER, SCANNER, right), tasks=lifted)


def test_starting_teams_are_sorted_and_include_lone_robots() -> None:
    five = tuple(replace(LIFTER, name=f"r{r}") for r in range(5))
    built = mission(robots=five, teams=((4, 1), (2,)), tasks=tasks(needs={"lift": 1})["tasks"])
    assert built.starting_teams == ((0,), (1, 4), (2,), (3,))


def test_cells_of_a_grid() -> None:
    grid = Grid(3, 2, (".@.", "..."))
    assert grid.is_inside((2, 1))
    assert not grid.is_inside((3, 1))
    assert not grid.is_inside((0, -1))
    assert not grid.is_free((1, 0))
    assert not grid.is_free((-1, 0))
    assert sorted(grid.neighbours((1, 1))) == [(0, 1), (2, 1)]
    assert sorted(Grid(3, 2).neighbours((0, 0))) == [(0, 1), (1, 0)]


def test_step_limit_on_an_open_grid() -> None:
    # Two tasks, so 4 x 3 walks of 4 + 3 steps: 84, or 168 at half a cell a step;
    # a step for each of two robots and 12 walks, to form.
    late = replace(CRATE, name="y", duration=5, appears=30)
    built = mission(tasks=(CRATE, late), **robots(speed=0.5))
    assert built.step_limit == 168 + 24 + 5 + 30
    assert default_step_limit(built) == built.step_limit
    assert mission(step_limit=9).step_limit == 9  # what is set stays


def test_step_limit_leaves_fast_robots_the_time_to_form() -> None:
    """All three must be at the only task together; at their speed any walk is one step."""
    fast = [Robot(name, (0, 0), {name: 1}, speed=1000.0) for name in "abc"]
    task = Task("all", (3, 2), dict.fromkeys("abc", 1))
    built = Mission("fast", Grid(4, 3), tuple("abc"), tuple(fast), (task,))
    assert built.step_limit == 1 + 4 * 2 * 3  # 4 x 2 walks of 7 cells fit into one step


def test_step_limit_behind_walls() -> None:
    """Walk through a corridor that winds: 14 steps from end to end, where 4 + 7 seem enough.

    . . . .
    @ @ @ .
    . . . .
    . @ @ @
    . . . .
    @ @ @ .
    . . . .
    """
    rows = ("....", "@@@.", "....", ".@@@", "....", "@@@.", "....")
    winding = mission(world=Grid(4, 7, rows))
    assert winding.step_limit == 4 * 2 * 2 * (3 * 4 + 3 * 2) + 16
    walled = mission(world=Grid(4, 3, ("....", "..@.", "....")))
    assert walled.step_limit == 4 * 2 * 2 * (4 + 3) + 16


def test_step_limit_has_room_for_late_tasks_and_an_end_for_slow_robots() -> None:
    assert mission(**tasks(appears=5_000_000)).step_limit == 56 + 16 + 5_000_000
    far = mission(world=Grid(2000, 2000), **robots(speed=0.001), **tasks(duration=7))
    assert far.step_limit == MOST_WALKING + 16 + 7
    slow = replace(CRATE, duration=10**9)
    late = replace(CRATE, name="y", appears=10**9)
    assert mission(tasks=(slow, late)).step_limit == 84 + 24 + MOST_WAITING <= 10**9


@pytest.mark.parametrize(
    ("rows", "place", "nearest"),
    [
        (("...", ".@.", "..."), (1, 1), (0, 1)),  # of four alike the first
        (("@@@@", "@@@@", "@@@."), (0, 0), (3, 2)),
        (("@@@@@", "@@@@@", "@@@@.", ".@@@@"), (0, 0), (0, 3)),  # 3 cells; the other is 4.5 away
        (("..", ".."), (1, 0), (1, 0)),
        (("@@", "@@"), (0, 0), None),
    ],
)
def test_the_nearest_free_cell(rows: tuple[str, ...], place: Place, nearest: Place | None) -> None:
    assert Grid(len(rows[0]), len(rows), rows).nearest_free(place) == nearest
