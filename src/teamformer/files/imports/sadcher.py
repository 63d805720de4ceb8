"""SADCHER's instances: skills `Q` of robots and `R` of tasks, durations `T_e`, places, precedence.

The first place is where all robots start and the last where they end; `[i, j]` says that task i
ends before task j starts, counted from 1. A file holds one instance or several, in one of two
forms. As the authors publish them, `R` and `T_e` have a row for the start and one for the end; in
the short form they have rows of tasks only. `T_t` says how long ways take. Without it they are
straight, at a speed of 1.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import product
from pathlib import Path

from teamformer.base.array_types import Floats
from teamformer.files.imports.trees import TreePart, read_json
from teamformer.mission.model import Mission, Robot, Task, World
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.plane import Plane
from teamformer.mission.parts.roads import GROUND, Roads

STRAIGHT = 1e-6
"""Ways that differ from straight ones by less are straight."""


def read(path: Path) -> list[Mission]:
    """Return the missions in a JSON file."""
    tree = read_json(path)
    if isinstance(tree.value, list):
        return [_mission(part, f"{path.stem}-{key}") for key, part in tree.parts()]
    return [_mission(tree, path.stem)]


def _mission(tree: TreePart, name: str) -> Mission:
    robots, needs, durations = _table(tree["Q"]), _table(tree["R"]), tree["T_e"].numbers(0)
    is_published = "task_locations" in tree.value
    places, order = (
        ("task_locations", "precedence_constraints") if is_published else ("loc", "prec")
    )
    _check_counts(tree, places, is_published)
    if is_published:
        needs, durations = needs[1:-1], durations[1:-1]
    names = ["start", *(f"t{number}" for number in range(1, len(needs) + 1)), "end"]
    world, spots = _read_world(tree, names, places)
    after = _read_order(tree[order], len(needs))
    return Mission(
        name=name,
        world=world,
        capabilities=tuple(f"skill-{n}" for n in range(len(robots[0]))),
        robots=tuple(Robot(f"r{n}", spots[0], _skills(row)) for n, row in enumerate(robots)),
        tasks=tuple(
            Task(names[number], spots[number], _skills(row), duration, after=after[number])
            for number, (row, duration) in enumerate(zip(needs, durations, strict=True), 1)
        ),
        time="continuous",
        ends=spots[-1],
    )


def _check_counts(tree: TreePart, places: str, is_published: bool) -> None:
    """Refuse tables of different numbers of tasks, and a start or an end that is a task."""
    rows = tree["R"].parts()
    tasks = len(rows) - 2 * is_published
    if tasks < 1:
        tree["R"].refuse("has no tasks between the start and the end")
    for key, wanted in (("T_e", len(rows)), (places, tasks + 2)):
        count = len(tree[key].parts())
        if count != wanted:
            tree[key].refuse(f"has {count} entries; with {tasks} tasks it should be {wanted}")
    for at in (0, -1) if is_published else ():
        for part in (*(count for _, count in rows[at][1].parts()), tree["T_e"].parts()[at][1]):
            if part.value != 0:
                part.refuse(f"is {part.value}; here is the {'end' if at else 'start'}, so 0")


def _read_world(tree: TreePart, names: Sequence[str], places: str) -> tuple[World, list[Place]]:
    """Return the world, and where the start, each task and the end are in it."""
    spots: list[Place] = [(one[0].number(0), one[1].number(0)) for _, one in tree[places].parts()]
    ways = tree["T_t"].ways(names) if "T_t" in tree.value else None
    if ways is None or _is_straight(ways, spots):
        return Plane(*(max(1.0, *(spot[axis] for spot in spots)) for axis in (0, 1))), spots
    roads = Roads(tuple(names), {GROUND: tuple(tuple(row) for row in ways.tolist())})
    return roads, [roads.at(name) for name in names]


def _is_straight(ways: Floats, spots: Sequence[Place]) -> bool:
    pairs = product(enumerate(spots), repeat=2)
    return all(abs(ways[i, j] - math.dist(one, two)) < STRAIGHT for (i, one), (j, two) in pairs)


def _read_order(part: TreePart, tasks: int) -> dict[int, tuple[str, ...]]:
    """Return the names of the tasks that each task, counted from 1, comes after."""
    after: dict[int, dict[str, None]] = {number: {} for number in range(1, tasks + 1)}
    for _, pair in part.parts() if part.value else ():
        for side in (0, 1):
            if pair[side].whole(1) > tasks:
                pair.refuse(f"names task {pair[side].value}; there are {tasks}")
        after[pair[1].whole(1)][f"t{pair[0].whole(1)}"] = None
    return {number: tuple(names) for number, names in after.items()}


def _table(part: TreePart) -> list[list[int]]:
    """Return a table of counts whose rows have one length."""
    rows = [[count.whole(0) for _, count in row.parts()] for _, row in part.parts()]
    if len({len(row) for row in rows}) > 1:
        part.refuse("has rows of different lengths")
    return rows


def _skills(row: list[int]) -> dict[str, int]:
    return {f"skill-{number}": count for number, count in enumerate(row) if count}
