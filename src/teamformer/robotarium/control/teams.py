"""Teams as the environment has them, for those who move robots."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from teamformer.base.array_types import Array
from teamformer.world.env import TeamFormation
from teamformer.world.phases.formation import JOIN
from teamformer.world.rules.constants import NOBODY


@dataclass(frozen=True)
class RobotTeam:
    """A team: its robots, and where it is to go."""

    slot: int
    robots: tuple[int, ...]
    task: int | None
    partner: int | None  # slot of the team it is on its way to join


def teams_of(env: TeamFormation) -> list[RobotTeam]:
    """Return the teams of the first world, by slot."""
    slots, records = env.worlds.robots["team"][0], env.worlds.teams[0]
    found = []
    for slot in np.unique(slots[slots != NOBODY]).tolist():
        task, partner = int(records["task"][slot]), int(records["partner"][slot])
        is_joining = records["intent"][slot] == JOIN and not records["has_formed"][slot]
        found.append(
            RobotTeam(
                slot=slot,
                robots=tuple(np.flatnonzero(slots == slot).tolist()),
                task=None if task == NOBODY else task,
                partner=int(slots[partner]) if is_joining else None,
            )
        )
    return found


def distance(team: RobotTeam, other: RobotTeam, robots: Array) -> float:
    """Return how far apart the nearest robots (robots, 2) of two teams are, in metres."""
    between = robots[list(team.robots)][:, None] - robots[list(other.robots)][None]
    return float(np.linalg.norm(between, axis=2).min())
