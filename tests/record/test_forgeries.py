"""Records written by hand: the rules of a step, one tiny world each, and forgeries of them."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from random_worlds import random_world
from teamformer.mission.model import Absence, Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.record.record import Ending, Record, Step, TeamAt, Wants
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


SLOW = replace(ALONE, robots=(Robot("r", (1, 0), {"a": 1}, speed=0.5),), step_limit=9)
"""A robot that crosses a cell every other step: `. r t . .`"""

OPEN = replace(ALONE, world=Grid(3, 2), tasks=(Task("t", (2, 1), {"a": 1}),))
"""A way along x first, since more is left to go there: `r . .` over `. . t`."""

LOST = replace(ALONE, robots=(Robot("r", (0, 0), {"a": 1}, absences=(Absence(1),)),))
"""A robot that is lost before it gets anywhere."""

Decisions = tuple[tuple[int, tuple[Wants, ...]], ...]


def record_of(
    mission: Mission, *steps: Step, decisions: Decisions = (), orders: Any = None, **end: Any
) -> Record:
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
    if orders is None:
        orders = ((0, tuple(k for k, task in enumerate(mission.tasks) if not task.appears)),)
    end_of = replace(ending, **end)
    return Record(
        mission, "by hand", 0, orders, tuple(places), steps, end=end_of, decisions=decisions
    )


def messages(record: Record) -> list[str]:
    return [finding.message for finding in judge(record).findings]


def at(slot: int, x: int, task: int | None = None, y: int = 0) -> TeamAt:
    return TeamAt(slot, x, y, task)


SETS_OUT = Step(teams=(at(0, 1, 0),))
ARRIVES = Step(teams=(at(0, 2),), done=((0, 0),))
R_WANTS_S: Decisions = ((1, (Wants(0, (1, 1)),)),)
BOTH_APPEAR, U_APPEARS = ((0, (0,)), (1, (0, 1))), ((0, (0,)), (1, (1,)))
DOES_T = Step(teams=(at(0, 1),), done=((0, 0),), pursued=((0, 0),))
BEGINS = Step(teams=(at(0, 0, 0),), served=((0, (0,)),))
JOINED = Step(joins=((0, 1),), teams=(at(0, 1),), done=((0, 0),), pursued=((0, 0),))


@pytest.mark.parametrize(
    "record",
    [
        record_of(ALONE, SETS_OUT, ARRIVES),
        record_of(SLOW, Step(teams=(at(0, 1, 0),)), ARRIVES),
        record_of(FAST, Step(teams=(at(0, 1, 0, y=1),)), ARRIVES),
        record_of(OPEN, SETS_OUT, Step(teams=(at(0, 2, 0),))),
        record_of(MEETING, JOINED, decisions=R_WANTS_S),
        record_of(SERVICE, BEGINS, Step(), Step(teams=(at(0, 0),), done=((0, 0),))),
        record_of(ALONE, SETS_OUT, illegal_decisions=1, decisions=((1, (Wants(0, (2,)),)),)),
        record_of(LOST, Step(lost=(0,)), status="infeasible", blocked_tasks=("t",)),
        record_of(
            TWINS,
            Step(splits=(((0,), (1,)),), teams=(at(1, 0),), pursued=((0, 0), (1, 0))),
            decisions=((1, (Wants(0, (1, 0)),)),),
            orders=BOTH_APPEAR,
        ),
    ],
    ids=[
        *("walks", "slowly", "around the wall", "along the longer axis", "meets on the way"),
        *("serves two steps", "wants what nobody can give", "is lost", "first that fits stays"),
    ],
)
def test_what_the_rules_make_of_decisions_is_legal(record: Record) -> None:
    assert messages(record) == []


@pytest.mark.parametrize(
    ("record", "message"),
    [
        (
            record_of(ALONE, Step(teams=(at(0, 0, 0),))),
            "step 1: team [r] is at (1, 0) by the rules and at (0, 0) in the record",
        ),
        (
            record_of(SLOW, ARRIVES),
            "step 1: team [r] is at (1, 0) by the rules and at (2, 0) in the record",
        ),
        (
            record_of(FAST, ARRIVES),
            "step 1: team [r] is at (1, 1) by the rules and at (2, 0) in the record",
        ),
        (
            record_of(OPEN, Step(teams=(at(0, 0, 0, y=1),))),
            "step 1: team [r] is at (1, 0) by the rules and at (0, 1) in the record",
        ),
        (
            record_of(replace(MEETING, join_radius=1), JOINED, decisions=R_WANTS_S),
            "step 1: the record says that the team of robot r joins the team of robot s, "
            "but by the rules it is not so",
        ),
        (
            record_of(MEETING, replace(JOINED, joins=((0, 1), (0, 1))), decisions=R_WANTS_S),
            "step 1: the rows of joins are not in order, each of them once",
        ),
        (
            record_of(MEETING, JOINED),
            "step 1: the record says that the team of robot r joins the team of robot s, "
            "but by the rules it is not so",
        ),
        (
            record_of(ALONE, Step(teams=(at(0, 1, 0), at(0, 1, 0))), ARRIVES),
            "step 1: the rows of teams are not in order of their slots, one for each",
        ),
        (
            record_of(ALONE, SETS_OUT, Step(teams=(at(0, 2),)), tasks_done=1),
            "step 2: by the rules task t is done by the team of robot r, "
            "and the record does not say so",
        ),
        (
            record_of(
                TWINS,
                Step(splits=(((0,), (1,)),), pursued=((0, 0), (1, 0))),
                decisions=((1, (Wants(0, (1, 0)),)),),
                orders=BOTH_APPEAR,
            ),
            "step 1: team [s] is new, and the record does not say where it is",
        ),
        (
            record_of(
                TWINS,
                Step(splits=(((1,), (0,)),), teams=(at(1, 0),)),
                decisions=((1, (Wants(0, (1, 0)),)),),
                orders=BOTH_APPEAR,
            ),
            "step 1: by the rules [r] stay and [s] leave; in the record [s] stay and [r] leave",
        ),
        (
            record_of(TWINS, replace(DOES_T, teams=(at(0, 1, 1),)), orders=U_APPEARS),
            "step 1: team [r, s] heads for nothing by the rules and for task u in the record",
        ),
        (
            record_of(TWINS, DOES_T),
            "step 1: there is no order made after 1 steps, when tasks appeared or a plan was made",
        ),
        (
            record_of(ALONE, SETS_OUT, ARRIVES, orders=((0, (0,)), (7, (0,)))),
            "orders has a row of step 7, but only 2 were made",
        ),
        (
            record_of(ALONE, SETS_OUT, decisions=((0, (Wants(0, (1,)),)),)),
            "decisions has a row of step 0, and the first step is 1",
        ),
        (
            record_of(ALONE, SETS_OUT, orders=((0, (0,)), (1, (0,)))),
            "step 1: there is an order made after 1 steps, when no task appeared",
        ),
        (
            record_of(LOST, Step(lost=(0,)), Step(), status="infeasible", blocked_tasks=("t",)),
            "step 2: some tasks could never be done any more, and the record goes on",
        ),
        (
            record_of(LOST, Step(lost=(0, 0)), status="infeasible", blocked_tasks=("t",)),
            "step 1: the rows of lost are not in order, each of them once",
        ),
        (
            record_of(ALONE, SETS_OUT, ARRIVES, decisions=((1, (Wants(0),)),)),
            "step 1: what teams decide is not told once and in order, or no team can",
        ),
        (
            record_of(SERVICE, *(Step(),) * 3, decisions=((1, (Wants(0, (0, 0)),)),)),
            "step 1: by the rules task t is served by [r], and the record does not say so",
        ),
        (
            record_of(ALONE, SETS_OUT, ARRIVES, decisions=((3, (Wants(0, (0,)),)),)),
            "decisions has a row of step 3, but only 2 were made",
        ),
        (
            record_of(
                ALONE, SETS_OUT, ARRIVES, decisions=((1, (Wants(0, None, 5),)), (2, (Wants(0),)))
            ),
            "the record says illegal_decisions 0; it is 1",
        ),
    ],
)
def test_what_they_do_not_is_named(record: Record, message: str) -> None:
    assert messages(record) == [message]


def test_nothing_happens_after_the_limit() -> None:
    idle = replace(ALONE, tasks=(Task("t", (2, 0), {"a": 1}, appears=4),))
    orders = ((0, ()), (4, (0,)))
    assert messages(record_of(idle, *(Step(),) * 4, status="step limit", orders=orders)) == []
    assert messages(record_of(idle, *(Step(),) * 5, orders=orders)) == [
        "step 5: the step limit was reached before, and the record goes on"
    ]


@pytest.mark.thorough
def test_hundreds_of_robots_are_judged_in_seconds() -> None:
    """Three hundred robots walk side by side for 300 steps: 90,000 moves."""
    robots = tuple(Robot(f"r{i}", (i, 0), {"a": 1}) for i in range(300))
    tasks = tuple(Task(f"t{i}", (i, 300), {"a": 2}) for i in range(300))
    hall = Mission("hall", Grid(300, 301), ("a",), robots, tasks)
    steps = [Step(teams=tuple(at(i, i, i, y=n) for i in range(300))) for n in range(1, 301)]
    named = ((1, tuple(Wants(i, None, i) for i in range(300))),)
    began = time.perf_counter()
    assert messages(record_of(hall, *steps, decisions=named)) == []
    assert time.perf_counter() - began < 10  # a second on an idle machine


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
