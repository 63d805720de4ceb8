"""Small named worlds, drawn as they start, and a way to play them by hand.

In the drawings small letters are robots that can do what the letter says, T, U, V are tasks, and
digits count cells from the left.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from teamformer.mission.model import Absence, Mission, Robot, Task
from teamformer.mission.parts.grid import Grid, Place
from teamformer.world.env import Decision, TeamFormation
from teamformer.world.rules.constants import NOBODY

CAPS = ("a", "b", "c")


def robot(can: str, x: int, y: int = 0, speed: float = 1.0, lost: int | None = None) -> Robot:
    """Return a robot that can do each letter of `can`, twice where it stands twice."""
    absences = () if lost is None else (Absence(lost),)
    return Robot(f"{can}@{x},{y}", (x, y), Counter(can), speed, absences)


def task(needs: str, x: int, y: int = 0, duration: int = 0, appears: int = 0) -> Task:
    """Return a task that needs each letter of `needs`."""
    return Task(f"{needs}@{x},{y}", (x, y), Counter(needs), duration, appears)


def make(
    robots: Sequence[Robot], tasks: Sequence[Task], world: Grid | None = None, **rules: Any
) -> Mission:
    """Return a mission in a corridor of 20 cells, or elsewhere; names are made distinct."""
    named_robots = (Robot(f"r{r}", *list(vars(one).values())[1:]) for r, one in enumerate(robots))
    named_tasks = (Task(f"t{k}", *list(vars(one).values())[1:]) for k, one in enumerate(tasks))
    grid = world or Grid(20, 1)
    return Mission("small", grid, CAPS, tuple(named_robots), tuple(named_tasks), **rules)


def pair_with_a_task_each_side() -> Mission:
    """Robots {a}, {a} in one cell as one team; tasks need a: t0 one cell left, t1 two right."""
    return Mission(
        "pair",
        Grid(4, 1),
        ("a",),
        (Robot("r0", (1, 0), {"a": 1}), Robot("r1", (1, 0), {"a": 1})),
        (Task("t0", (0, 0), {"a": 1}), Task("t1", (3, 0), {"a": 1})),
        teams=((0, 1),),
    )


def two_robots_one_task(**rules: Any) -> Mission:
    """Two that start together must be at the task as one.

    a
    b . . T        T needs a, b
    0 1 2 3
    """
    return make([robot("a", 0), robot("b", 0)], [task("ab", 3)], **rules)


def two_apart(pace: float = 1.0, **rules: Any) -> Mission:
    """Both walk to the right; who wants to join has to catch up.

    a . b . . . . . . T        T needs a, b; b walks at `pace`
    0 1 2 3 4 5 6 7 8 9
    """
    radii = {"sensing_radius": 3.0, "join_radius": 3.0}
    robots = [robot("a", 0), robot("b", 2, speed=pace)]
    return make(robots, [task("ab", 9)], **{**radii, **rules})


def walker(speed: float, goal: int = 10) -> Mission:
    """One robot on its way.

    a . . . . . . . . . T
    """
    return make([robot("a", 0, speed=speed)], [task("a", goal)])


def two_tasks_two_pairs(**rules: Any) -> Mission:
    """The first pair covers the first task, so that the second pair takes the next one.

    b a b a
    . . . . T . U        slots 0 to 3 in the same cell 3; T and U need a, b
    """
    robots = [robot(can, 3) for can in "baba"]
    return make(robots, [task("ab", 4), task("ab", 6)], **rules)


def detour_on_the_way(**rules: Any) -> Mission:
    """The tour begins far right of the robot that can do both tasks.

    a . . U . T . . . . . . . . . . . . . b        T and U need a; the centroid is at 10
    0     3   5                           19
    """
    return make([robot("a", 0), robot("b", 19)], [task("a", 5), task("a", 3)], **rules)


def service(duration: int = 3, **rules: Any) -> Mission:
    """A team of two that starts one cell from a task that takes its time.

    a
    b T        T needs a, b, for `duration` steps
    0 1
    """
    robots = [robot("a", 0), robot("b", 0)]
    return make(robots, [task("ab", 1, duration=duration)], teams=((0, 1),), **rules)


def late_task(**rules: Any) -> Mission:
    """A second task becomes known after two steps.

    U . . a . . . . T        both need a; U appears after 2 steps
    0     3         8
    """
    return make([robot("a", 3)], [task("a", 8), task("a", 0, appears=2)], **rules)


def late_pair(weights: tuple[float, float] = (1.0, 1.0), **changes: Any) -> Mission:
    """Return a robot at 5 of a corridor, and tasks at 0 and 10 that are due in step 1."""
    tasks = tuple(
        Task(name, (x, 0), {"a": 1}, between=(0, 1), weight=weight)
        for name, x, weight in zip(("left", "right"), (0, 10), weights, strict=True)
    )
    robots = (Robot("r", (5, 0), {"a": 1}),)
    return replace(Mission("pair", Grid(11, 1), ("a",), robots, tasks), **changes)


def at_work(mission: Mission, *shifts: tuple[tuple[int, int], ...], every: int = 0) -> Mission:
    """Return a mission whose robots have shifts, one after the other."""
    robots = [
        replace(one, shifts=own, every=every if own else 0)
        for one, own in zip(mission.robots, shifts, strict=True)
    ]
    return replace(mission, robots=tuple(robots), step_limit=0)


def reachable(grid: Grid, place: Place) -> frozenset[Place]:
    """Return every cell that can be walked to from a place, itself included."""
    reached, frontier = {place}, {place}
    while frontier:
        frontier = {beside for cell in frontier for beside in grid.neighbours(cell)} - reached
        reached |= frontier
    return frozenset(reached)


def play(
    env: TeamFormation,
    steps: int = 1,
    joins: Mapping[int, int] | None = None,
    splits: Mapping[int, Sequence[int]] | None = None,
) -> None:
    """Make steps; in the first, slots join slots or keep only some robots; all else maintains."""
    for step in range(steps):
        view = env.view()
        wanted = view.counts.copy()
        row = {slot: i for i, slot in enumerate(view.slot.tolist())}
        if step == 0:
            for joiner, partner in (joins or {}).items():
                wanted[row[joiner]] += view.counts[row[partner]]
            for slot, stayers in (splits or {}).items():
                wanted[row[slot]] = env.worlds.brings[0, list(stayers)].sum(axis=0)
        env.step(Decision(wanted))


def teams_of(env: TeamFormation) -> dict[int, list[int]]:
    """Return the robots of each team, by slot."""
    slots = env.worlds.robots["team"][0]
    return {s: np.flatnonzero(slots == s).tolist() for s in sorted(set(slots.tolist())) if s >= 0}


def places(env: TeamFormation) -> dict[int, int]:
    """Return each team's x, by slot."""
    return {slot: int(env.worlds.teams["x"][0, slot]) for slot in teams_of(env)}


def assignments(env: TeamFormation) -> dict[int, int | None]:
    """Return each team's task, by slot."""
    tasks = env.worlds.teams["task"][0]
    return {slot: None if tasks[slot] == NOBODY else int(tasks[slot]) for slot in teams_of(env)}


def done_at(env: TeamFormation) -> list[int | None]:
    """Return the step in which each task was done."""
    steps = env.worlds.tasks["done_at"][0].tolist()
    return [None if step == NOBODY else step for step in steps]


def order_of(env: TeamFormation) -> list[int]:
    """Return the open tasks in their shared order."""
    return [int(k) for k in env.worlds.order[0, : env.worlds.count["open"][0]]]


def far_from_what_may_be_needed() -> Mission:
    """T needs a and may need b, U needs a for 8 steps, V needs b; c has nothing to do.

    U . c . T . . . . ab . . . . . . . . . V
    0   2   4         9                    19
    """
    tasks = [replace(task("a", 4), may_need={"b": 0.5}), task("a", 0, duration=8), task("b", 19)]
    robots = [robot("a", 9), robot("b", 9), robot("c", 2)]
    return make(robots, tasks)
