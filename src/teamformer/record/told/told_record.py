"""What is told of a record, for everybody who reads it."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from teamformer.mission.parts.layout import Layout
from teamformer.record.critical_path.stretches import Stretch

Robots = tuple[int, ...]
"""Numbers of robots, ascending."""


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
    slot: int | None = None  # of the team that they began it as, if they were one


class Run(NamedTuple):
    """What a robot did from the end of a step on and why, or another robot whose doings it shared.

    What a team does is told once, by its lowest robot; in continuous time each robot has its own.
    """

    begun: float
    phase: str | None  # one of phases.PHASES; None: as another robot
    task: int  # that it was about, or NOBODY; or that other robot
    why: tuple[int, ...] = ()  # numbers of texts


class Level(NamedTuple):
    """How full a battery is from a moment on, 0 to 1, and how much comes in a unit of time."""

    begun: float
    full: float
    rate: float


@dataclass(frozen=True)
class ToldRecord:
    """What is told of a record of such a length; `runs` are by robot, `texts` by number.

    The length is in steps, or in the unit of continuous time, and so are all times. `layout` says
    where a map draws the places of roads.
    """

    length: float
    services: tuple[ToldService, ...]
    runs: tuple[tuple[Run, ...], ...]
    texts: tuple[str, ...]
    path: tuple[Stretch, ...] = ()
    layout: Layout | None = None
    levels: tuple[tuple[Level, ...], ...] = ()  # by robot; empty if nobody has a battery

    def runs_of(self, robot: int) -> Iterator[tuple[float, Run]]:
        """Yield the ends of a robot's runs and the runs, its team's among them.

        What it goes on with as it comes into a team, leaves one or has another reason is one run.
        """
        latest: tuple[float, Run] | None = None
        for end, run in self.reasoned_runs_of(robot):
            if latest is not None and latest[1][1:3] == run[1:3]:
                run = latest[1]
            elif latest is not None:
                yield latest
            latest = end, run
        if latest is not None:
            yield latest

    def reasoned_runs_of(self, robot: int) -> Iterator[tuple[float, Run]]:
        """Yield the ends of a robot's runs and the runs, each with its own reasons."""
        for begun, end, run in _parts(self.runs[robot], 0, self.length):
            if run.phase is not None:
                yield end, run
                continue
            for start, until, other in _parts(self.runs[run.task], begun, end):
                yield until, other._replace(begun=start)


@dataclass(frozen=True)
class ToldOfStep:
    """What one step adds: services by their place among all, runs by robot, texts.

    Each robot that is not among the runs goes on with what it did.
    """

    services: tuple[tuple[int, ToldService], ...]
    runs: tuple[tuple[int, Run], ...]
    texts: tuple[str, ...]


def _parts(row: Sequence[Run], begin: float, end: float) -> Iterator[tuple[float, float, Run]]:
    """Yield begin, end and each of a robot's runs between two moments."""
    first = max(0, bisect_right(row, begin, key=lambda run: run.begun) - 1)
    for place in range(first, len(row)):
        run, until = row[place], row[place + 1].begun if place + 1 < len(row) else end
        if run.begun >= end:
            return
        if until > begin:
            yield max(begin, run.begun), min(until, end), run
