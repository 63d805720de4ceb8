"""SADCHER's instances: skills `Q` of robots and `R` of tasks, durations `T_e`, places, precedence.

The first place is where all robots start and the last where they end; `[i, j]` in `prec` says that
task i ends before task j starts, counted from 1. The speed is 1. A file holds one or several.
"""

from __future__ import annotations

from pathlib import Path

from teamformer.model import Robot, Scenario, Task
from teamformer.plane import Plane
from teamformer.scenarios.imports.trees import Part, read_json


def read(path: Path) -> list[Scenario]:
    """Return the missions in a JSON file."""
    tree = read_json(path)
    if isinstance(tree.value, list):
        return [_mission(part, f"{path.stem}-{key}") for key, part in tree.parts()]
    return [_mission(tree, path.stem)]


def _mission(tree: Part, name: str) -> Scenario:
    robots, needs = _table(tree["Q"]), _table(tree["R"])
    durations = [part.number(0) for _, part in tree["T_e"].parts()]
    spots = [(part[0].number(0), part[1].number(0)) for _, part in tree["loc"].parts()]
    for key, count, wanted in (
        ("T_e", len(durations), len(needs)),
        ("loc", len(spots), len(needs) + 2),
    ):
        if count != wanted:
            tree[key].refuse(f"has {count} entries; with {len(needs)} tasks it should be {wanted}")
    pairs = tree["prec"].parts() if tree["prec"].value else []
    after: dict[int, list[str]] = {}
    for _, pair in pairs:
        for side in (0, 1):
            if pair[side].whole(1) > len(needs):
                pair.refuse(f"names task {pair[side].value}; there are {len(needs)}")
        after.setdefault(pair[1].whole(1), []).append(f"t{pair[0].whole(1)}")
    return Scenario(
        name=name,
        world=Plane(*(max(1.0, *(spot[axis] for spot in spots)) for axis in (0, 1))),
        capabilities=tuple(f"skill-{n}" for n in range(len(robots[0]))),
        robots=tuple(Robot(f"r{n}", spots[0], _skills(row)) for n, row in enumerate(robots)),
        tasks=tuple(
            Task(
                f"t{number}",
                spots[number],
                _skills(row),
                duration,
                after=tuple(dict.fromkeys(after.get(number, ()))),
            )
            for number, (row, duration) in enumerate(zip(needs, durations, strict=True), 1)
        ),
        time="continuous",
        ends=spots[-1],
    )


def _table(part: Part) -> list[list[int]]:
    """Return a table of counts whose rows have one length."""
    rows = [[count.whole(0) for _, count in row.parts()] for _, row in part.parts()]
    if len({len(row) for row in rows}) > 1:
        part.refuse("has rows of different lengths")
    return rows


def _skills(row: list[int]) -> dict[str, int]:
    return {f"skill-{number}": count for number, count in enumerate(row) if count}
