"""`teamformer fleet add`: a new task for a running fleet."""

from __future__ import annotations

import math
import secrets
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from teamformer.base.errors import TeamformerError
from teamformer.cli.verbs.robots.mesh import FleetAt, have_accepted, read_fleet_mission
from teamformer.mission.parts.capabilities import exact, is_exact

if TYPE_CHECKING:
    from teamformer.fleet.fleet_mission import FleetMission
    from teamformer.fleet.messages import TaskFact

MOST_NEEDED = 1000
"""Of one capability, by a task that an operator adds."""


@dataclass(frozen=True)
class AddedTask:
    """A task to add, as the command line has it; `duration` is in steps."""

    name: str
    at: str
    needs: str
    duration: float


def add(path: Path, new: AddedTask, fleet: FleetAt) -> int:
    """Add a task to a running fleet; return 0 once it is accepted."""
    mission = read_fleet_mission(path, "zenoh")
    from teamformer.fleet.operator import Operator

    return have_accepted(Operator(_task(new, mission), mission.robots), mission, fleet)


def _task(new: AddedTask, mission: FleetMission) -> TaskFact:
    """Return the task to add; raises `TeamformerError` for one that no fleet would take."""
    from teamformer.fleet.messages import LONGEST, MOST_NAME, TaskFact

    source, name = mission.source, new.name.strip()
    if not 0 < len(name) <= MOST_NAME:
        raise TeamformerError(f"the task's name has {len(name)} letters", f"use 1 to {MOST_NAME}")
    if name in {task.name for task in source.tasks}:
        raise TeamformerError(f"the mission has a task '{name}' already", "use another name")
    x, y = _place(new.at)
    if not mission.is_site(x, y):
        raise TeamformerError(f"--at {new.at} is no free place of the map", "name another one")
    needs = _needs(new.needs, source.capabilities)
    duration = new.duration * mission.step
    if duration > LONGEST:
        raise TeamformerError(f"--duration {new.duration:g} is too long", "use fewer steps")
    task = TaskFact((1 + secrets.randbits(36)) << 24, name, x, y, needs, duration)
    if not mission.can_do(range(mission.robots), task):
        raise TeamformerError(
            f"all robots together cannot do '{name}'", "lower what it needs, or move it"
        )
    return task


def _place(text: str) -> tuple[float, float]:
    try:
        x, y = (float(part) for part in text.split(","))
    except ValueError:
        raise TeamformerError(f"--at {text} is no place", "write it as in 3,4") from None
    return x, y


def _needs(text: str, capabilities: tuple[str, ...]) -> tuple[float, ...]:
    counts: dict[str, float] = dict.fromkeys(capabilities, 0)
    for part in text.split(","):
        name, _, number = part.strip().partition(":")
        if name not in counts:
            known = ", ".join(capabilities)
            raise TeamformerError(f"--needs: there is no capability '{name}'", f"there are {known}")
        counts[name] = exact(counts[name] + (_count(part.strip(), number) if number else 1))
    return tuple(counts.values())


def _count(part: str, number: str) -> float:
    try:
        count = float(number)
    except ValueError:
        count = math.nan
    if not (0 < count <= MOST_NEEDED and is_exact(count)):
        hint = f"write a number up to {MOST_NEEDED:,}, of three places at most"
        raise TeamformerError(f"--needs {part}: {number} is no count", hint)
    return exact(count)
