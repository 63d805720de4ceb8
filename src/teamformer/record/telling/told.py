"""What is told of a record, for everybody who reads it."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple, TypeVar

from teamformer.record.critical_path.stretches import Stretch

Robots = tuple[int, ...]
"""Numbers of robots, ascending."""


Part = TypeVar("Part", "Run", "Chapter")


class ToldService(NamedTuple):
    """What a team did for a task, from the end of one step to the end of another.

    A load has several: each time that it is loaded and carried, and at last unloaded.
    """

    task: int
    doing: str  # one of phases.AT_WORK
    begun: int
    ended: int | None  # None while it goes on
    begun_by: Robots
    robots: Robots  # those that were with it when it ended; nobody yet while it goes on


class Run(NamedTuple):
    """What a robot did from the end of a step on, or another robot whose doings were its own.

    What a team does is told once, by its lowest robot.
    """

    begun: int
    phase: str | None  # one of phases.PHASES; None: as another robot
    task: int  # that it was about, or NOBODY; or that other robot


class Chapter(NamedTuple):
    """What a robot did from the end of a step on, and the reasons for it, as numbers of texts.

    Or another robot whose story is its own: then `what` is None, and `why` names that.
    """

    begun: int
    what: int | None
    why: tuple[int, ...]


@dataclass(frozen=True)
class ToldRecord:
    """What is told of a record of so many steps; `runs` and `chapters` are by robot."""

    steps: int
    services: tuple[ToldService, ...]
    runs: tuple[tuple[Run, ...], ...]
    chapters: tuple[tuple[Chapter, ...], ...]
    texts: tuple[str, ...]
    path: tuple[Stretch, ...] = ()

    def runs_of(self, robot: int) -> Iterator[tuple[int, Run]]:
        """Yield the ends of a robot's runs and the runs, its team's among them."""
        for begun, end, run in _parts(self.runs[robot], 0, self.steps):
            if run.phase is not None:
                yield end, run
                continue
            for start, until, other in _parts(self.runs[run.task], begun, end):
                yield until, other._replace(begun=start)

    def chapters_of(self, robot: int) -> Iterator[tuple[int, Chapter]]:
        """Yield the ends of a robot's chapters and the chapters, its team's among them."""
        for begun, end, chapter in _parts(self.chapters[robot], 0, self.steps):
            if chapter.what is not None:
                yield end, chapter
                continue
            for start, until, other in _parts(self.chapters[chapter.why[0]], begun, end):
                yield until, other._replace(begun=start)


@dataclass(frozen=True)
class ToldOfStep:
    """What one step adds: services by their place among all, runs and chapters by robot, texts.

    Each robot that is not among the runs goes on with what it did.
    """

    services: tuple[tuple[int, ToldService], ...]
    runs: tuple[tuple[int, Run], ...]
    chapters: tuple[tuple[int, Chapter], ...]
    texts: tuple[str, ...]


def _parts(row: Sequence[Part], begin: int, end: int) -> Iterator[tuple[int, int, Part]]:
    """Yield begin, end and each of a robot's runs or chapters between two moments."""
    first = max(0, bisect_right(row, begin, key=lambda part: part.begun) - 1)
    for place in range(first, len(row)):
        part, until = row[place], row[place + 1].begun if place + 1 < len(row) else end
        if part.begun >= end:
            return
        if until > begin:
            yield max(begin, part.begun), min(until, end), part
