"""The `robots` of a scenario file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import zip_longest
from typing import Any

from teamformer.mission.checks import LARGEST_NUMBER, LATEST_RETURN
from teamformer.model import Absence, Breakdown, Delays, Robot, World
from teamformer.roads import AIR, GROUND, Roads
from teamformer.scenarios.trees.reader import LONGEST_TEXT, Reader, name_of, read_range
from teamformer.scenarios.trees.world import read_at
from teamformer.scenarios.yaml.reader import Where
from teamformer.scenarios.yaml.words import shorten

MOST_ALIKE = 1000
"""Robots that one entry of a file stands for."""

ROBOT_KEYS = {
    "name": False,
    "at": True,
    "can": True,
    "speed": False,
    "lost": False,
    "back": False,
    "breaks": False,
    "delays": False,
    "moves": False,
    "count": False,
}

MOVES = (GROUND, AIR)

BREAKS_KEYS = {"rate": True, "repair": False}

DELAYS_KEYS = {"chance": True, "seed": True}


@dataclass(frozen=True)
class Fleet:
    """The robots of a file, by number, and the entry that each comes from.

    A name stands for one robot, or for all that an entry with `count` makes.
    """

    robots: tuple[Robot, ...]
    entries: tuple[int, ...]
    named: Mapping[str, tuple[int, ...]]

    def read_names(self, reader: Reader, where: Where, value: Any) -> tuple[int, ...]:
        """Return the robots in a list of names; those that are none are refused."""
        found: list[int] = []
        for entry, name in enumerate(reader.names(where, value)):
            if name not in self.named and name != "?":
                message = f"there is no robot '{shorten(name)}'; write the name of one"
                reader.refuse((*where, entry), message)
            found += self.named.get(name, ())
        return tuple(found)


def read_robots(reader: Reader, value: Any, world: World) -> Fleet:
    """Return the robots; problems are noted in the reader."""
    robots: list[Robot] = []
    entries: list[int] = []
    groups: dict[str, tuple[int, ...]] = {}
    for number, part in enumerate(reader.sequence(("robots",), value)):
        where = ("robots", number)
        keys = reader.mapping(where, part, ROBOT_KEYS)
        count, longest = 1, LONGEST_TEXT
        if "count" in keys:
            count = reader.whole((*where, "count"), keys["count"], 1, MOST_ALIKE)
            longest -= len(f"-{count}")
        robot = Robot(
            name=reader.text((*where, "name"), keys.get("name", f"r{len(robots) + 1}"), longest),
            at=read_at(reader, (*where, "at"), keys.get("at"), world),
            can=reader.counts((*where, "can"), keys.get("can", [])),
            speed=reader.number((*where, "speed"), keys.get("speed", 1.0)),
            absences=_read_absences(reader, where, keys),
            breaks=_read_breaks(reader, (*where, "breaks"), keys),
            delays=_read_delays(reader, (*where, "delays"), keys.get("delays")),
            moves=_read_moves(reader, (*where, "moves"), keys.get("moves", GROUND), world),
        )
        if "count" not in keys:
            alike = [robot]
        elif "name" in keys:
            alike = [replace(robot, name=f"{robot.name}-{n + 1}") for n in range(count)]
            groups[robot.name] = tuple(range(len(robots), len(robots) + count))
        else:
            alike = [replace(robot, name=f"r{len(robots) + n + 1}") for n in range(count)]
        robots += alike
        entries += [number] * len(alike)
    one = {robot.name: (number,) for number, robot in reversed(list(enumerate(robots)))}
    return Fleet(tuple(robots), tuple(entries), groups | one)


def _read_moves(reader: Reader, where: Where, value: Any, world: World) -> str:
    """Return how a robot moves: on the ground, in the air or, on roads, by a table's name."""
    word = reader.text(where, value)
    if word not in MOVES and not isinstance(world, Roads):
        reader.refuse(where, f"{name_of(where)} is '{word}'; write {' or '.join(MOVES)}")
    return word


def _read_absences(reader: Reader, where: Where, keys: Mapping[str, Any]) -> tuple[Absence, ...]:
    """Return when a robot is lost and back: `lost` and `back` are a step each, or lists."""
    lost = _read_steps(reader, (*where, "lost"), keys.get("lost", []), LARGEST_NUMBER)
    back = _read_steps(reader, (*where, "back"), keys.get("back", []), LATEST_RETURN)
    if len(back) > len(lost):
        what = "is back but never lost" if not lost else "is back more often than it is lost"
        name = keys.get("name", name_of(where))
        reader.refuse((*where, "back"), f"robot '{name}' {what}; add lost or drop back")
    return tuple(Absence(*pair) for pair in zip_longest(lost, back[: len(lost)]))


def _read_steps(reader: Reader, where: Where, value: Any, latest: int) -> list[int]:
    if not isinstance(value, list):
        return [reader.whole(where, value, most=latest)]
    return [
        reader.whole((*where, number), steps, most=latest) for number, steps in enumerate(value)
    ]


def _read_breaks(reader: Reader, where: Where, keys: Mapping[str, Any]) -> Breakdown | None:
    if "breaks" not in keys:
        return None
    said = reader.mapping(where, keys["breaks"], BREAKS_KEYS)
    rate = reader.number((*where, "rate"), said.get("rate", 0.0))
    if "repair" not in said:
        return Breakdown(rate)
    remedy = "write it as [least, most]"
    return Breakdown(rate, read_range(reader, (*where, "repair"), said["repair"], remedy))


def _read_delays(reader: Reader, where: Where, value: Any) -> Delays | None:
    if value is None:
        return None
    if not isinstance(value, dict):
        return Delays(reader.number(where, value))
    said = reader.mapping(where, value, DELAYS_KEYS)
    chance = reader.number((*where, "chance"), said.get("chance", 0.0))
    return Delays(chance, reader.whole((*where, "seed"), said.get("seed", 0)))
