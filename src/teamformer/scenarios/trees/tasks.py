"""The `tasks` of a scenario file."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from teamformer.model import Task, World
from teamformer.scenarios.trees.reader import Reader, name_of, read_range
from teamformer.scenarios.trees.world import read_at
from teamformer.scenarios.yaml.reader import Where
from teamformer.scenarios.yaml.words import describe

TASK_KEYS = {
    "name": False,
    "at": True,
    "needs": True,
    "duration": False,
    "appears": False,
    "cancelled": False,
    "after": False,
    "between": False,
    "starts": False,
    "to": False,
    "unload": False,
    "may_need": False,
    "within": False,
    "weight": False,
    "only": False,
    "with": False,
}


def read_tasks(reader: Reader, value: Any, world: World, time: str | None) -> tuple[Task, ...]:
    """Return the tasks; problems are noted in the reader. `time` is the mission's, if it says."""
    tasks = []
    for number, part in enumerate(reader.sequence(("tasks",), value)):
        where = ("tasks", number)
        keys = reader.mapping(where, part, TASK_KEYS)
        tasks.append(
            Task(
                name=reader.text((*where, "name"), keys.get("name", f"t{number + 1}")),
                at=read_at(reader, (*where, "at"), keys.get("at"), world),
                needs=reader.counts((*where, "needs"), keys.get("needs", [])),
                duration=_read_duration(reader, (*where, "duration"), keys, time),
                lasts=_read_lasts(reader, (*where, "duration"), keys.get("duration")),
                may_need=_read_chances(reader, (*where, "may_need"), keys.get("may_need", {})),
                within=reader.number((*where, "within"), keys.get("within", 0.0)),
                weight=reader.number((*where, "weight"), keys.get("weight", 1.0)),
                appears=reader.whole((*where, "appears"), keys.get("appears", 0)),
                cancelled=_read_cancelled(reader, (*where, "cancelled"), keys),
                after=tuple(reader.names((*where, "after"), keys.get("after", []))),
                between=_read_window(reader, (*where, "between"), keys),
                starts=_read_links(reader, (*where, "starts"), keys.get("starts", {})),
                to=read_at(reader, (*where, "to"), keys["to"], world) if "to" in keys else None,
                unload=_read_time(reader, (*where, "unload"), keys.get("unload", 0), time),
            )
        )
    return tuple(tasks)


def _read_duration(
    reader: Reader, where: Where, keys: Mapping[str, Any], time: str | None
) -> float:
    value = keys.get("duration", 0)
    if isinstance(value, list):  # what to expect follows from the range
        return 0
    return _read_time(reader, where, value, time)


def _read_time(reader: Reader, where: Where, value: Any, time: str | None) -> float:
    return reader.number(where, value) if time == "continuous" else reader.whole(where, value)


def _read_cancelled(reader: Reader, where: Where, keys: Mapping[str, Any]) -> int | None:
    """Return the step in which a task is called off; None if it never is."""
    return reader.whole(where, keys["cancelled"]) if "cancelled" in keys else None


def _read_lasts(reader: Reader, where: Where, value: Any) -> tuple[int, int] | None:
    """Return the least and the most steps that a task takes; None if a number stands there."""
    if not isinstance(value, list):
        return None
    return read_range(reader, where, value, "write steps, or [least, most]")


def _read_chances(reader: Reader, where: Where, value: Any) -> dict[str, float]:
    """Return probabilities by capability."""
    if not isinstance(value, dict):
        message = f"{name_of(where)} is {describe(value)}; write a mapping to probabilities"
        reader.refuse(where, f"{message}, such as {{weld: 0.4}}")
        return {}
    return {
        reader.text((*where, name), name): reader.number((*where, name), chance)
        for name, chance in value.items()
    }


def _read_window(
    reader: Reader, where: Where, keys: Mapping[str, Any]
) -> tuple[float, float] | None:
    if "between" not in keys:
        return None
    return _read_pair(reader, where, keys["between"], "[begin, end]")


def _read_links(reader: Reader, where: Where, value: Any) -> dict[str, tuple[float, float]]:
    if not isinstance(value, dict):
        reader.refuse(
            where, f"{name_of(where)} is {describe(value)}; write {{TASK: [least, most]}}"
        )
        return {}
    read = {
        reader.text((*where, name), name): _read_pair(reader, (*where, name), gap, "[least, most]")
        for name, gap in value.items()
    }
    return {name: gap for name, gap in read.items() if gap is not None}


def _read_pair(reader: Reader, where: Where, value: Any, form: str) -> tuple[float, float] | None:
    pair = reader.pair(where, value, f"write it as {form}")
    if pair is None:
        return None
    begin, end = (reader.number((*where, part), time) for part, time in enumerate(pair))
    return begin, end
