"""What the world of simulated bodies keeps of each robot, and of each piece of work."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

from teamformer.fleet.bodies.body import Command
from teamformer.fleet.bodies.journey import Journey
from teamformer.world.rules.constants import NOBODY

SERVICE, CARRIED, UNLOADING = range(3)
"""The parts of a service: the service itself, which for a load is taking it up, and what follows
where there is one."""


@dataclass(slots=True)
class SimulatedRobot:
    """A robot as it really is."""

    journey: Journey
    command: Command = field(default_factory=Command)
    is_dead: bool = False
    is_stuck: bool = False
    is_dry: bool = False  # its battery is empty
    carries: int = NOBODY  # the task whose load it carries or unloads


class WorkUnderWay(NamedTuple):
    """A team is at work on a task; the part at hand ends at a time."""

    team: int
    end: float
    part: int = SERVICE


@dataclass(frozen=True)
class Done:
    """A task was done at a time by a team: those robots were at work on it."""

    at: float
    key: int
    team: int
    robots: tuple[int, ...]
