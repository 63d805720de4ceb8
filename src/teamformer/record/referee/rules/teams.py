"""The teams of a record, kept by plain bookkeeping."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace

from teamformer.mission.model import Mission, Robot, World
from teamformer.mission.parts.capabilities import covers, total
from teamformer.mission.parts.grid import Grid, Place
from teamformer.mission.parts.plane import Plane


@dataclass
class RecordedTeam:
    """A team: who is in it, where it is, and what it may still do in this step.

    `counts` (what it can do together), `speed` (that of its slowest, in cells or metres a step)
    and `flies` follow from its robots when it is put into a fleet.
    """

    robots: set[int]
    at: Place
    task: int | None = None
    credit: float = 0.0  # the most that it can have saved of its speed
    least_credit: float = 0.0  # what it has saved at least
    walked_from: Place | None = None  # in this step; None if it had to wait, or its way was told
    walked_at: float = 0.0  # its speed then, before robots of it were lost
    flew: bool = False  # none of its robots was on the ground then
    has_formed: bool = False
    is_delayed: bool = False  # one of its robots stands still in this step
    due: int | None = None  # the task that the plan gives it
    is_named: bool = False  # its decision named its task
    was_serving: bool = False  # when tasks were given
    may_seek: bool = True  # it may walk to a partner
    had_task: bool = False  # and it kept the one that it had, or another was named
    is_pursuit_sure: bool = True  # whether it is known what it has pursued in this step
    pursues: int | None = None  # the task, if it is; None for none
    is_way_told: bool = True  # False if all its robots were lost in a step, on their way
    met_at: Place | None = None  # where the other one of two that have just joined stood
    met_task: int | None = None  # and what it headed for: the one with the higher slot
    services: dict[int, int] = field(default_factory=dict)  # task -> steps left
    carries: int | None = None  # the load; its service has the steps left where it is brought to
    counts: dict[str, float] = field(default_factory=dict)
    speed: float = 0.0
    flies: bool = False  # none of its robots is on the ground


def gets_there(world: World, robot: Robot, place: Place) -> bool:
    """Say whether a robot can get to a place alone: flying, or within one part of the map."""
    return robot.flies or world.region(robot.at) == world.region(place)


def are_together(world: World, one: Place, other: Place) -> bool:
    """Say whether two places are the same: one cell, or points within the arrival radius."""
    if isinstance(world, Grid):
        return one == other
    return squared_distance(one, other) <= world.arrival_radius**2


def squared_distance(one: Place, other: Place) -> float:
    """Return the squared distance of two places, in a straight line."""
    away_x, away_y = one[0] - other[0], one[1] - other[1]
    return away_x * away_x + away_y * away_y


class Fleet:
    """All teams by slot, the lowest robot number in each."""

    def __init__(
        self, mission: Mission, teams: dict[int, RecordedTeam], is_coordinated: bool = False
    ) -> None:
        self.mission, self.is_coordinated = mission, is_coordinated
        world, reach = mission.world, mission.join_radius
        self.reach = max(reach, world.arrival_radius) if isinstance(world, Plane) else reach
        self.teams = teams
        self.lost: dict[int, RecordedTeam] = {}  # robots not back, and the team each was lost from

    def covers(self, team: RecordedTeam, task: int) -> bool:
        """Say whether a team has everything that a task needs."""
        return covers(team.counts, self.mission.tasks[task].needs)

    def name(self, team: RecordedTeam) -> str:
        """Name a team by its robots."""
        names = [self.mission.robots[robot].name for robot in sorted(team.robots)]
        shown = names if len(names) <= 6 else [*names[:5], f"and {len(names) - 5} more"]
        return f"team [{', '.join(shown)}]"

    def is_at(self, team: RecordedTeam, place: Place) -> bool:
        """Say whether a team is in a place: in its cell, or near enough on a plane."""
        return are_together(self.mission.world, team.at, place)

    def put(self, team: RecordedTeam) -> None:
        """Enter a team at its slot."""
        robots = [self.mission.robots[robot] for robot in team.robots]
        team.counts = total(robot.can for robot in robots)
        team.speed = min(self.mission.world.pace(robot.speed) for robot in robots)
        team.flies = all(robot.flies for robot in robots)
        self.teams[min(team.robots)] = team

    def accept(self, slot: int) -> None:
        """Let a robot lead a team as the record has it: those below it stay behind."""
        for below, team in list(self.teams.items()):
            if slot in team.robots and slot != below:
                leaving = {robot for robot in team.robots if robot >= slot}
                self.put(replace(team, robots=team.robots - leaving))
                self.put(replace(team, robots=leaving, services={}))

    def find(self, robots: Iterable[int]) -> int | None:
        """Return the slot of the team that has exactly these robots."""
        wanted = set(robots)
        slot = min(wanted, default=-1)
        found = self.teams.get(slot)
        return slot if found is not None and found.robots == wanted else None
