"""The `robots` of a mission file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import zip_longest
from typing import Any

from teamformer.files.trees.values import Given, read_part
from teamformer.files.yaml.reader import Where
from teamformer.files.yaml.tree_reader import Reader
from teamformer.mission.keys.key import Key
from teamformer.mission.keys.kinds import LONGEST_TEXT, Text
from teamformer.mission.keys.robot_keys import MOST_ALIKE, ROBOT_KEYS
from teamformer.mission.model import Absence, Robot


@dataclass(frozen=True)
class FileRobots:
    """The robots of a file, by number, and the entry that each comes from.

    A name stands for one robot, or for all that an entry with `count` makes.
    """

    robots: tuple[Robot, ...]
    entries: tuple[int, ...]
    named: Mapping[str, tuple[int, ...]]


def read_robots(reader: Reader, value: Any, given: Given) -> FileRobots:
    """Return the robots; problems are noted in the reader."""
    robots: list[Robot] = []
    entries: list[int] = []
    groups: dict[str, tuple[int, ...]] = {}
    for number, part in enumerate(reader.sequence(("robots",), value)):
        where, first = ("robots", number), len(robots)
        said = read_part(reader, where, part, _keys_for(part), given)
        count = said.pop("count", None)
        names = [f"r{first + n + 1}" for n in range(count or 1)]
        if "name" in said and count is None:
            names = [said["name"]]
        elif "name" in said:
            names = [f"{said['name']}-{n + 1}" for n in range(count)]
            groups[said["name"]] = tuple(range(first, first + count))
        said["absences"] = _absences(reader, where, said, said.get("name", names[0]))
        robot = Robot(**said | {"name": names[0]})
        robots += [replace(robot, name=name) for name in names]
        entries += [number] * len(names)
    one = {robot.name: (number,) for number, robot in reversed(list(enumerate(robots)))}
    return FileRobots(tuple(robots), tuple(entries), groups | one)


def _keys_for(part: Any) -> tuple[Key, ...]:
    """Return the keys of a robot; the name of several alike has room for their numbers."""
    count = part.get("count") if isinstance(part, dict) else None
    if not isinstance(count, int) or not 1 <= count <= MOST_ALIKE:
        return ROBOT_KEYS
    name, *others = ROBOT_KEYS
    return (replace(name, kind=Text(LONGEST_TEXT - len(f"-{count}"))), *others)


def _absences(reader: Reader, where: Where, said: dict[str, Any], name: str) -> tuple[Absence, ...]:
    """Return when a robot is lost and back, and take both out of what is said of it."""
    lost, back = said.pop("lost", []), said.pop("back", [])
    if len(back) > len(lost):
        what = "is back but never lost" if not lost else "is back more often than it is lost"
        reader.refuse((*where, "back"), f"robot '{name}' {what}; add lost or drop back")
    return tuple(Absence(*pair) for pair in zip_longest(lost, back[: len(lost)]))
