"""Forgeries that a careless referee lets through, one tiny world each."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from random_worlds import random_world
from teamformer.mission.model import Absence, Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.record.record import Ending, Record, Step, TeamAt
from teamformer.record.referee import judge

ALONE = Mission(
    name="alone",
    world=Grid(5, 1),
    capabilities=("a",),
    robots=(Robot("r", (0, 0), {"a": 1}),),
    tasks=(Task("t", (2, 0), {"a": 1}),),
    step_limit=4,
)
"""One robot, one task: `r . t . .`"""

TWINS = Mission(
    name="twins",
    world=Grid(5, 1),
    capabilities=("a", "b"),
    robots=(Robot("r", (0, 0), {"a": 1}), Robot("s", (0, 0), {"a": 1})),
    tasks=(Task("t", (1, 0), {"a": 2}), Task("u", (0, 0), {"a": 1}, appears=1)),
    teams=((0, 1),),
    step_limit=9,
)
"""Two equal robots that start as one team: `rs t . . .`, with `u` later where they start."""

MEETING = Mission(
    name="meeting",
    world=Grid(5, 1),
    capabilities=("a", "b"),
    robots=(Robot("r", (0, 0), {"a": 1}), Robot("s", (2, 0), {"b": 1})),
    tasks=(Task("t", (1, 0), {"a": 1, "b": 1}),),
    sensing_radius=2,
    join_radius=2,
    forming_steps=0,
    step_limit=9,
)
"""Two robots that may become one team on the way: `r t s . .`"""

SERVICE = Mission(
    name="service",
    world=Grid(5, 1),
    capabilities=("a", "b"),
    robots=(Robot("r", (0, 0), {"a": 1}), Robot("s", (0, 0), {"b": 1})),
    tasks=(Task("t", (0, 0), {"a": 1}, duration=2),),
    step_limit=9,
)
"""Two robots at a task that one of them serves: `rst . . . .`"""

FAST = replace(
    ALONE,
    world=Grid(3, 2, (".@.", "...")),
    robots=(Robot("r", (0, 0), {"a": 1}, speed=2),),
)
"""A robot of speed 2 that must walk four cells around a wall: `r @ t`."""


def record_of(mission: Mission, *steps: Step, **end: Any) -> Record:
    """Return a record with the true start, the first order and an ending counted from the steps."""
    done = sum(len(step.done) for step in steps)
    is_completed = done == len(mission.tasks)
    ending = Ending(
        status="completed" if is_completed else "interrupted",
        makespan=len(steps) if is_completed else None,
        steps=len(steps),
        tasks_done=done,
        joins=sum(len(step.joins) for step in steps),
        splits=sum(len(step.splits) for step in steps),
        illegal_decisions=0,
    )
    places = [(team[0], team, *mission.robots[team[0]].at) for team in mission.starting_teams]
    known = tuple(k for k, task in enumerate(mission.tasks) if not task.appears)
    orders = ((0, known),)
    return Record(mission, "by hand", 0, orders, tuple(places), steps, replace(ending, **end))


def messages(record: Record) -> list[str]:
    return [finding.message for finding in judge(record).findings]


def at(slot: int, x: int, task: int | None = None, y: int = 0) -> TeamAt:
    return TeamAt(slot, x, y, task)


ARRIVES = Step(teams=(at(0, 2),), done=((0, 0),))


@pytest.mark.parametrize(
    "record",
    [
        record_of(ALONE, Step(teams=(at(0, 1, 0),)), ARRIVES),
        record_of(ALONE, Step(), Step(), Step(teams=(at(0, 1, 0),)), ARRIVES),
        record_of(FAST, Step(teams=(at(0, 1, 0, y=1),)), ARRIVES),
        record_of(MEETING, Step(joins=((0, 1),), teams=(at(0, 1),), done=((0, 0),))),
        record_of(SERVICE, Step(), Step(), Step(done=((0, 0),))),
    ],
    ids=["walks", "waits first", "around the wall", "meets on the way", "serves two steps"],
)
def test_what_is_legal_is_found_legal(record: Record) -> None:
    assert messages(record) == []


def test_standing_saves_up_no_second_cell() -> None:
    forged = record_of(ALONE, Step(), ARRIVES)
    assert messages(forged) == [
        "step 2: team [r] jumped from [0, 0] to [2, 0]; it can cross 1 cell now"
    ]


def test_a_slow_robot_saves_up_one_cell_and_no_more() -> None:
    slow = replace(ALONE, robots=(Robot("r", (0, 0), {"a": 1}, speed=0.5),))
    sets_out, first_cell = Step(teams=(at(0, 0, 0),)), Step(teams=(at(0, 1, 0),))
    assert messages(record_of(slow, sets_out, first_cell, ARRIVES)) == [
        "step 3: team [r] jumped from [1, 0] to [2, 0]; it can cross 0 cells now"
    ]
    assert messages(record_of(slow, sets_out, first_cell, Step(), ARRIVES)) == []


def test_who_pursues_nothing_saves_nothing_up() -> None:
    slow = replace(ALONE, robots=(Robot("r", (0, 0), {"a": 1}, speed=0.5),))
    assert messages(record_of(slow, Step(), Step(teams=(at(0, 1, 0),)))) == [
        "step 2: team [r] jumped from [0, 0] to [1, 0]; it can cross 0 cells now"
    ]


def test_nobody_goes_through_a_wall() -> None:
    assert messages(record_of(FAST, ARRIVES)) == [
        "step 1: team [r] went through a wall from [0, 0] to [2, 0]; it can cross 2 cells now"
    ]


def test_who_meets_was_within_the_join_radius() -> None:
    far = replace(MEETING, join_radius=1)
    forged = record_of(far, Step(joins=((0, 1),), teams=(at(0, 1),), done=((0, 0),)))
    assert messages(forged) == ["step 1: team [r] joins team [s] from beyond the join radius"]


def test_a_team_is_in_one_place() -> None:
    twice = Step(teams=(at(0, 1, 0), at(0, 1, 0)))
    assert messages(record_of(ALONE, twice, ARRIVES)) == [
        "step 1: the record has the team of robot r in two places"
    ]


def test_a_new_team_has_a_place() -> None:
    split = replace(record_of(TWINS, Step(splits=(((0,), (1,)),))), orders=((0, (0,)), (1, (0, 1))))
    assert messages(split) == ["step 1: team [s] is new, and the record does not say where it is"]


def test_robots_that_stay_are_the_first_that_fit() -> None:
    """Who wants to keep one `a` of two keeps robot r, which comes first."""
    orders = ((0, (0,)), (1, (0, 1)))
    for stay, leave, expected in (
        ((0,), (1,), []),
        ((1,), (0,), ["step 1: [s] are not the first of team [r, s] that fit"]),
    ):
        step = Step(splits=((stay, leave),), teams=(at(1, 0),))
        assert messages(replace(record_of(TWINS, step), orders=orders)) == expected


def test_one_robot_cannot_do_what_takes_two() -> None:
    step = Step(splits=(((0,), (1,)),), teams=(at(1, 0),))
    forged = record_of(TWINS, step, Step(teams=(at(0, 1),), done=((0, 0),)))
    assert "step 2: task t cannot be done: team [r] lacks a" in messages(forged)


def test_whoever_serves_neither_joins_nor_is_joined() -> None:
    for pair in ((0, 1), (1, 0)):
        forged = record_of(SERVICE, Step(), Step(joins=(pair,)))
        assert "step 2: team [r] joins while it serves a task" in messages(forged)


def test_two_joins_of_the_same_walkers_are_found() -> None:
    step = Step(joins=((0, 1), (0, 1)), teams=(at(0, 1),), done=((0, 0),))
    assert messages(record_of(MEETING, step)) == [
        "step 1: a join of r with s is not one of two teams"
    ]


def test_nothing_happens_after_the_limit() -> None:
    assert messages(record_of(ALONE, *(Step(),) * 4, status="step limit")) == []
    assert "step 5: the step limit was reached before, and the record goes on" in messages(
        record_of(ALONE, *(Step(),) * 5)
    )


def test_nothing_happens_after_a_task_has_become_impossible() -> None:
    lost = replace(ALONE, robots=(Robot("r", (0, 0), {"a": 1}, absences=(Absence(1),)),))
    ending = {"status": "infeasible", "blocked_tasks": ("t",)}
    assert messages(record_of(lost, Step(lost=(0,)), **ending)) == []
    assert messages(record_of(lost, Step(lost=(0,)), Step(), **ending)) == [
        "step 2: some tasks could never be done since a robot was lost, and the record goes on"
    ]
    assert "step 1: the record loses a robot twice" in messages(
        record_of(lost, Step(lost=(0, 0)), **ending)
    )


def test_tasks_that_appear_get_an_order_and_no_other_step_has_one() -> None:
    legal = replace(record_of(TWINS, Step(), Step(done=((1, 0),))), orders=((0, (0,)), (1, (1, 0))))
    assert messages(legal) == []
    assert messages(replace(legal, orders=((0, (0,)),))) == [
        "there is no order from after 1 steps, when tasks appeared"
    ]
    assert "there is an order from after 7 steps, but only 2 were made" in messages(
        replace(legal, orders=(*legal.orders, (7, (0,))))
    )


def test_nobody_heads_for_a_task_in_the_step_after_which_it_appears() -> None:
    step = Step(teams=(at(0, 0, 1),))
    forged = replace(record_of(TWINS, step), orders=((0, (0,)), (1, (1, 0))))
    assert messages(forged) == ["step 1: team [r, s] heads for task u, which is not open"]


def test_a_completion_left_out_is_told_once() -> None:
    forged = record_of(ALONE, Step(teams=(at(0, 1, 0),)), Step(teams=(at(0, 2),)), tasks_done=1)
    assert [m for m in messages(forged) if "leaves it out" in m] == [
        "step 2: team [r] does task t, and the record leaves it out"
    ]


@pytest.mark.thorough
def test_hundreds_of_robots_are_judged_in_seconds() -> None:
    """Three hundred robots walk side by side for 300 steps: 90,000 moves."""
    robots = tuple(Robot(f"r{i}", (i, 0), {"a": 1}) for i in range(300))
    tasks = tuple(Task(f"t{i}", (i, 300), {"a": 2}) for i in range(300))
    hall = Mission("hall", Grid(300, 301), ("a",), robots, tasks)
    steps = [Step(teams=tuple(at(i, i, i, y=n) for i in range(300))) for n in range(1, 301)]
    began = time.perf_counter()
    assert messages(record_of(hall, *steps)) == []
    assert time.perf_counter() - began < 10  # half a second on an idle machine


def wild_step(world: Mission, rng: np.random.Generator) -> Step:
    """Return a step with random numbers in every place that a reader lets them into."""
    robots, tasks = len(world.robots), len(world.tasks)

    def some(limit: int, length: int) -> tuple[int, ...]:
        return tuple(rng.integers(limit, size=length).tolist())

    a, b, c, d, e, f = some(4, 6)
    x, y = rng.integers(-2, 9, size=2).tolist()
    return Step(
        joins=tuple(zip(some(robots, a), some(robots, a), strict=True)),
        splits=((some(robots, b), some(robots, c)),),
        lost=some(robots, d),
        teams=tuple(at(slot, x, some(tasks, 1)[0], y) for slot in some(robots, e)),
        done=tuple(zip(some(tasks, f), some(robots, f), strict=True)),
    )


def test_no_record_is_too_wild_to_judge() -> None:
    rng = np.random.default_rng(15)
    for _ in range(150):
        world = random_world(rng)
        assert judge(record_of(world, *(wild_step(world, rng) for _ in range(12)))).findings


SLOW_TO_T = replace(ALONE, robots=(Robot("r", (1, 0), {"a": 1}, speed=0.5),), step_limit=9)
"""A robot that crosses a cell every other step: `. r t . .`"""

OPEN = replace(ALONE, world=Grid(3, 2), tasks=(Task("t", (2, 1), {"a": 1}),))
"""A way along x first, since more is left to go there: `r . .` over `. . t`."""

SEEKER = replace(MEETING, robots=(MEETING.robots[0], replace(MEETING.robots[1], at=(2, 0))))
SEEKER = replace(SEEKER, world=Grid(3, 2), join_radius=2, sensing_radius=2)
"""Two robots of which one may walk to the other to join it: `r t s` over `. . .`"""

WALLED = replace(ALONE, world=Grid(3, 2, (".@.", "...")), step_limit=9)
"""`r @ t`, with the way around below."""


@pytest.mark.parametrize(
    ("mission", "steps", "expected"),
    [
        (
            ALONE,
            [Step(teams=(at(0, 0, 0),)), Step(teams=(at(0, 1, 0),)), ARRIVES],
            "step 1: team [r] waits at [0, 0]; it must get 1 cell nearer to task t",
        ),
        (
            ALONE,
            [Step(teams=(at(0, 1, 0),)), Step(teams=(at(0, 0, 0),))],
            "step 2: team [r] goes from [1, 0] to [0, 0]; it must get 1 cell nearer to task t",
        ),
        (
            SLOW_TO_T,
            [Step(teams=(at(0, 1, 0),)), Step(), ARRIVES],
            "step 2: team [r] waits at [1, 0]; it must get 1 cell nearer to task t",
        ),
        (SLOW_TO_T, [Step(teams=(at(0, 1, 0),)), ARRIVES], ""),
        (
            WALLED,
            [Step(teams=(at(0, 0, 0, y=1),)), Step(teams=(at(0, 1, 0, y=1),)), Step()],
            "step 3: team [r] waits at [1, 1]; it must get 1 cell nearer to task t",
        ),
        (
            replace(ALONE, sensing_radius=2, join_radius=1),
            [Step(teams=(at(0, 0, 0),))],
            "step 1: team [r] waits at [0, 0]; it must get 1 cell nearer to task t",
        ),
        (
            ALONE,
            [Step(teams=(at(0, 1),))],
            "step 1: team [r] goes from [0, 0] to [1, 0]; it pursues no task, so that it must stay",
        ),
        (ALONE, [Step(teams=(at(0, 1),), pursued=((0, 0),))], ""),
        (
            ALONE,
            [Step(teams=(at(0, 1, 0),)), Step(teams=(at(0, 0),))],
            "step 2: team [r] goes from [1, 0] to [0, 0]; it must get 1 cell nearer to task t",
        ),
        (OPEN, [Step(teams=(at(0, 1, 0),))], ""),
        (
            OPEN,
            [Step(teams=(at(0, 0, 0, y=1),))],
            "step 1: team [r] goes from [0, 0] to [0, 1]; that is not on its way to task t",
        ),
        (SEEKER, [Step(teams=(at(0, 1, y=0),))], ""),
        (
            SEEKER,
            [Step(teams=(at(0, 0, y=1),))],
            "step 1: team [r] goes from [0, 0] to [0, 1]; it pursues no task, so that it must stay",
        ),
        (ALONE, [Step(), Step(), Step(teams=(at(0, 1, 0),)), ARRIVES], ""),
    ],
    ids=[
        *("waits", "turns back", "waits too long", "slow", "around a wall", "nobody to join"),
        *("free and walks", "took back by news", "turns back and is free", "along the longer axis"),
        *("along the other axis", "to a partner", "away from a partner", "free"),
    ],
)
def test_who_has_somewhere_to_go_gets_on(
    mission: Mission, steps: list[Step], expected: str
) -> None:
    assert messages(record_of(mission, *steps)) == ([expected] if expected else [])
