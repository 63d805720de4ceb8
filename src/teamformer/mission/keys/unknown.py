"""What a mission has that some verbs or robots do not know, told once for all that have it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import TYPE_CHECKING

from teamformer.base.errors import Problem
from teamformer.mission.keys.key import Key, Unknown
from teamformer.mission.keys.mission_keys import MISSION_KEYS
from teamformer.mission.keys.robot_keys import ROBOT_KEYS
from teamformer.mission.keys.task_keys import TASK_KEYS

if TYPE_CHECKING:
    from teamformer.mission.model import Mission

Found = tuple[tuple[str | int, ...], str]
"""Where a robot or a task has something, and what in words."""

MOST_NAMED = 5


def told_once(
    mission: Mission, found: Iterable[Found], rest: Callable[[str], str]
) -> Iterator[Problem]:
    """Return one problem for each key of robots or tasks, with the names of all that have it.

    `rest` returns what is told after these, by key.
    """
    by_key: dict[tuple[str | int, str], list[Found]] = {}
    for where, what in found:
        by_key.setdefault((where[0], str(where[-1])), []).append((where, what))
    for (group, key), alike in by_key.items():
        where, what = alike[0]
        things = mission.robots if group == "robots" else mission.tasks
        names = [f"'{things[int(where[1])].name}'" for where, _ in alike[1:]]
        if len(names) > MOST_NAMED:
            names[MOST_NAMED:] = [f"{len(names) - MOST_NAMED} more"]
        others = f" (likewise {', '.join(names)})" if names else ""
        yield Problem(where, f"{what}{others}, {rest(key)}")


def find_unknown(mission: Mission, to: str, is_surprise: bool = False) -> Iterator[Found]:
    """Return where a mission has keys that somebody does not know, and what they say, in words.

    These are keys of what is open until it shows, if it `is_surprise`, else the other ones.
    """
    for number, robot in enumerate(mission.robots):
        for key, said in _unknown_keys(ROBOT_KEYS, robot, to, is_surprise):
            yield ("robots", number, key.name), f"robot '{robot.name}' {said.what}"
    for key, said in _unknown_keys(MISSION_KEYS, mission, to, is_surprise):
        yield (key.name,), said.what
    for number, task in enumerate(mission.tasks):
        for key, said in _unknown_keys(TASK_KEYS, task, to, is_surprise):
            yield ("tasks", number, key.name), f"task '{task.name}' {said.what}"


def _unknown_keys(
    keys: Sequence[Key], thing: object, to: str, is_surprise: bool
) -> Iterator[tuple[Key, Unknown]]:
    """Return the keys of a thing that somebody does not know, with what is said of them."""
    for key in keys:
        said = key.unknown
        is_meant = said is not None and to in said.to and said.is_surprise == is_surprise
        if said and is_meant and getattr(thing, said.field or key.field):
            yield key, said
