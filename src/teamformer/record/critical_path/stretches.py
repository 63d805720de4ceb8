"""What a critical path consists of: stretches of time, each with somebody who does something."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

from teamformer.mission.model import Mission
from teamformer.mission.parts.shifts import ALWAYS
from teamformer.record.phases import IDLE, OFF, PHASES, WAITING, WALKING
from teamformer.world.rules.constants import NOBODY

NOT_TO_BE_DONE = ("unknown", "closed", "linked", "news")
UNKNOWN, CLOSED, LINKED, NEWS = NOT_TO_BE_DONE
DOINGS = (*PHASES, *NOT_TO_BE_DONE)
"""Until a task is known (`unknown`) or may begin (`closed`), what robots do does not matter, nor
what they did before `news` had a robot turn round.

A `linked` stretch is in continuous time: a task waits for another one, with which its start is
linked.
"""

DIGITS = 6
"""Places after the point that are told of a time."""


@dataclass(frozen=True)
class Stretch:
    """A part of a critical path: what is done from one moment to another, by whom, for which task.

    Times are in steps made, in continuous time in the mission's unit. `robot` and `task` are
    numbers, or NOBODY where there is none. `zone` is the number of one for whose room the task had
    to wait until this began.
    """

    begin: float
    end: float
    doing: str  # one of DOINGS
    robot: int = NOBODY
    task: int = NOBODY
    zone: int = NOBODY


def in_order(backwards: Iterable[Stretch]) -> tuple[Stretch, ...]:
    """Return stretches that were found from the end to the start in the order of time.

    Empty ones are left out; neighbours in which the same is done become one.
    """
    path: list[Stretch] = []
    for found in backwards:
        if found.begin == found.end:
            continue
        last = path[-1] if path else None
        if last is not None and _is_same(last, found) and last.begin == found.end:
            path[-1] = replace(found, end=last.end)
        else:
            path.append(found)
    return tuple(reversed(path))


def _is_same(one: Stretch, other: Stretch) -> bool:
    return (one.doing, one.robot, one.task) == (other.doing, other.robot, other.task)


def in_shifts(mission: Mission, path: Iterable[Stretch]) -> Iterator[Stretch]:
    """Yield the stretches of a path, the walks of robots with shifts cut where they pause."""
    for stretch in path:
        rota = ALWAYS if stretch.robot == NOBODY else mission.robots[stretch.robot].rota
        if not rota or stretch.doing not in (WALKING, WAITING, IDLE):
            yield stretch
            continue
        now = stretch.begin
        for opens, closes in rota.since(stretch.begin):
            for until, doing in ((opens, OFF), (closes, stretch.doing)):
                end = min(until, stretch.end)
                if end > now:
                    yield replace(stretch, begin=now, end=end, doing=doing)
                    now = end
            if now == stretch.end:
                break
        if now < stretch.end:
            yield replace(stretch, begin=now, doing=OFF)


def path_rows(mission: Mission, path: Sequence[Stretch]) -> list[dict[str, Any]]:
    """Return what `--json` prints of a critical path: a row for each stretch, with names."""
    return [
        {
            "from": round(stretch.begin, DIGITS),
            "to": round(stretch.end, DIGITS),
            "doing": stretch.doing,
            "robot": None if stretch.robot == NOBODY else mission.robots[stretch.robot].name,
            "task": None if stretch.task == NOBODY else mission.tasks[stretch.task].name,
            **({} if stretch.zone == NOBODY else {"room in": mission.zones[stretch.zone].name}),
        }
        for stretch in path
    ]
