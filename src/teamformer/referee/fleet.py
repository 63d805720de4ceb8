"""The teams of a record, kept by plain bookkeeping."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

from teamformer.capabilities import covers, total
from teamformer.model import Place, Scenario


@dataclass
class Team:
    """A team: who is in it, where it is, and what it may still do in this step."""

    robots: set[int]
    at: Place
    task: int | None = None
    credit: float = 0.0  # the most that it can have saved of its speed
    has_formed: bool = False
    services: dict[int, int] = field(default_factory=dict)  # task -> steps left


class Fleet:
    """All teams by slot, the lowest robot number in each."""

    def __init__(self, scenario: Scenario, teams: dict[int, Team]) -> None:
        self.scenario = scenario
        self.teams = teams

    def counts(self, team: Team) -> dict[str, int]:
        """Return what a team can do together."""
        return total(self.scenario.robots[robot].can for robot in team.robots)

    def covers(self, team: Team, task: int) -> bool:
        """Say whether a team has everything that a task needs."""
        return covers(self.counts(team), self.scenario.tasks[task].needs)

    def speed(self, team: Team) -> float:
        """Return the speed of the slowest member, in cells a step."""
        return min(self.scenario.robots[robot].speed for robot in team.robots)

    def name(self, team: Team) -> str:
        """Name a team by its robots."""
        names = [self.scenario.robots[robot].name for robot in sorted(team.robots)]
        shown = names if len(names) <= 6 else [*names[:5], f"and {len(names) - 5} more"]
        return f"team [{', '.join(shown)}]"

    def put(self, team: Team) -> None:
        """Enter a team at its slot."""
        self.teams[min(team.robots)] = team

    def find(self, robots: Iterable[int]) -> int | None:
        """Return the slot of the team that has exactly these robots."""
        wanted = set(robots)
        slot = min(wanted, default=-1)
        found = self.teams.get(slot)
        return slot if found is not None and found.robots == wanted else None
