"""What is told of a record, for everybody who reads it."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple, TypeVar

from teamformer.mission.parts.layout import Layout
from teamformer.record.critical_path.stretches import Stretch

Robots = tuple[int, ...]
"""Numbers of robots, ascending."""


Part = TypeVar("Part", "Run", "Chapter")


class ToldService(NamedTuple):
    """What a team did for a task, from the end of one step to the end of another, or by times.

    A load has several: each time that it is loaded and carried, and at last unloaded.
    """

    task: int
    doing: str  # one of phases.AT_WORK
    begun: float
    ended: float | None  # None while it goes on
    begun_by: Robots
    robots: Robots  # those that were with it when it ended; nobody yet while it goes on


class Run(NamedTuple):
    """What a robot did from the end of a step on, or another robot whose doings were its own.

    What a team does is told once, by its lowest robot; in continuous time each robot has its own.
    """

    begun: float
    phase: str | None  # one of phases.PHASES; None: as another robot
    task: int  # that it was about, or NOBODY; or that other robot


class Chapter(NamedTuple):
    """What a robot did from the end of a step on, and the reasons for it, as numbers of texts.

    Or another robot whose story is its own: then `what` is None, and `why` names that.
    """

    begun: float
    what: int | None
    why: tuple[int, ...]


@dataclass(frozen=True)
class ToldRecord:
    """What is told of a record of such a length; `runs` and `chapters` are by robot.

    The length is in steps, or in the unit of continuous time, and so are all times. `layout` says
    where a map draws the places of roads.
    """

    length: float
    services: tuple[ToldService, ...]
    runs: tuple[tuple[Run, ...], ...]
    chapters: tuple[tuple[Chapter, ...], ...]
    texts: tuple[str, ...]
    path: tuple[Stretch, ...] = ()
    layout: Layout | None = None

    def runs_of(self, robot: int) -> Iterator[tuple[float, Run]]:
        """Yield the ends of a robot's runs and the runs, its team's among them.

        What it goes on with as it comes into a team, or leaves one, is one run.
        """
        latest: tuple[float, Run] | None = None
        for end, run in self._runs(robot):
            if latest is not None and latest[1][1:] == run[1:]:
                run = latest[1]
            elif latest is not None:
                yield latest
            latest = end, run
        if latest is not None:
            yield latest

    def _runs(self, robot: int) -> Iterator[tuple[float, Run]]:
        for begun, end, run in _parts(self.runs[robot], 0, self.length):
            if run.phase is not None:
                yield end, run
                continue
            for start, until, other in _parts(self.runs[run.task], begun, end):
                yield until, other._replace(begun=start)

    def chapters_of(self, robot: int) -> Iterator[tuple[float, Chapter]]:
        """Yield the ends of a robot's chapters and the chapters, its team's among them."""
        for begun, end, chapter in _parts(self.chapters[robot], 0, self.length):
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


def _parts(row: Sequence[Part], begin: float, end: float) -> Iterator[tuple[float, float, Part]]:
    """Yield begin, end and each of a robot's runs or chapters between two moments."""
    first = max(0, bisect_right(row, begin, key=lambda part: part.begun) - 1)
    for place in range(first, len(row)):
        part, until = row[place], row[place + 1].begun if place + 1 < len(row) else end
        if part.begun >= end:
            return
        if until > begin:
            yield max(begin, part.begun), min(until, end), part
