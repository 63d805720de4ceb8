"""Forgeries of records in continuous time: every field of every event, and of the ending."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator
from typing import Any

from teamformer.base.errors import TeamformerError
from teamformer.record.files.reading import record_from_tree
from teamformer.record.referee import judge

Tree = Any
Forgery = tuple[str, Tree]

LITTLE = 0.25


def findings_in(tree: Tree) -> list[str]:
    """Return what `check` tells of a record, be it that it cannot be read."""
    try:
        return [finding.message for finding in judge(record_from_tree(tree, "record")).findings]
    except TeamformerError as error:
        return str(error).splitlines()


def forgeries(tree: Tree) -> Iterator[Forgery]:
    """Yield forged records, each with what is forged; what is told would give all of them away."""
    honest = {key: value for key, value in tree.items() if key != "told"}
    for number, (_, kind, said) in enumerate(honest["events"]):
        for name, change in (*_of_event(said, honest), ("gone", None)):
            forged = copy.deepcopy(honest)
            if change is None:
                _take_out(forged["events"], number)
            else:
                change(forged["events"][number])
            if forged != honest:
                yield f"{kind}: {name}", forged
    for key, value in _of_ending(honest["end"]):
        if honest["end"][key] != value:
            yield f"end: {key}", {**honest, "end": {**honest["end"], key: value}}


def _of_event(said: Tree, tree: Tree) -> Iterator[tuple[str, Callable[[Any], None]]]:
    """Yield changes of an event."""
    yield "later", lambda event: event.__setitem__(0, event[0] + LITTLE)
    yield "earlier", lambda event: event.__setitem__(0, max(0, event[0] - LITTLE))
    tasks, robots = (len(tree["mission"][key]) for key in ("tasks", "robots"))
    for key, value in said.items():
        for name, other in _others(key, value, tasks, robots):
            yield (
                f"{key} {name}".strip(),
                lambda event, key=key, it=other: event[2].update({key: it}),
            )
    if "cause" in said:
        yield "no cause", lambda event: event[2].pop("cause")


def _others(key: str, value: Any, tasks: int, robots: int) -> Iterator[tuple[str, Any]]:
    """Yield other values of a field."""
    if key == "robots":
        yield "others", [(value[0] + 1) % robots]
        yield "fewer", value[:-1]
    elif key == "task":
        yield "other", (value + 1) % tasks
    elif key == "place":
        yield "other", _beside(value)
    elif key == "until":
        yield "later", value + 2 * LITTLE
    elif key == "way":
        yield "shorter", value[:-1]
        yield "slower", [[at + LITTLE, place] for at, place in value]
        yield "elsewhere", [*value[:-1], [value[-1][0], _beside(value[-1][1])]]
    elif key == "cause":
        yield "earlier", max(0, value - 1)
    elif key == "needs":
        yield "more", {name: count + 1 for name, count in value.items()}
    elif key == "status":
        yield "other", "interrupted"
    elif key == "plan":
        yield "reason", [["taken over" if value[0] == ["robot back"] else "robot back"], value[1]]


def _beside(place: Any) -> Any:
    x, y = place
    return [x + 1 if x == 0 else x - 1, y]


def _take_out(events: list[Any], number: int) -> None:
    """Take an event out; what hung on it hangs on the one before, and all others as they did."""
    events.pop(number)
    for _, _, said in events:
        if said.get("cause", -1) >= number:
            said["cause"] = max(0, said["cause"] - 1)


def _of_ending(end: Tree) -> Iterator[tuple[str, Any]]:
    yield "makespan", (end["makespan"] or 0) + LITTLE
    yield "tasks_done", end["tasks_done"] + 1
    yield "cost", (end["cost"] or 0) + 1
    yield "late", {**end["late"], "nothing of the sort": 1}
    yield "broken_links", [*end["broken_links"], ["one", "other"]]
    yield "status", "interrupted"
