"""What holds between two steps: who is together where, what is open, and what is believed of it."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from teamformer.mission.arrivals import with_arrivals
from teamformer.mission.model import Mission
from teamformer.mission.parts.capabilities import Counts
from teamformer.mission.parts.grid import Grid, Place
from teamformer.mission.parts.places import believed_place, possible_places
from teamformer.mission.parts.plane import Plane
from teamformer.mission.parts.shifts import fits_now, rotas_of
from teamformer.mission.parts.zones import all_rooms_of
from teamformer.mission.precedence import tasks_before
from teamformer.world.reference.ways import PlainWays, apart_squared

Units = tuple[int, ...]
"""Counts of all capabilities of the mission, in whole units."""

Robots = tuple[int, ...]
"""Robots by number, in order."""

SMALLEST_SQUARE = 1e-3  # metres


class Wish(NamedTuple):
    """What a team wants in a step: counts to have (None: its own), and a task that it names."""

    counts: Units | None = None
    task: int | None = None


@dataclass
class PlainTeam:
    """Robots that act as one; `serving` has the steps that each service has left."""

    robots: Robots
    at: Place
    has: Units
    pace: float  # cells or metres a step
    flies: bool
    task: int | None = None
    is_detour: bool = False
    credit: float = 0.0  # what it has saved of a cell
    serving: dict[int, int] = field(default_factory=dict)
    has_formed: bool = False  # in this step
    is_commanded: bool = False  # its decision names a task in this step
    named: int | None = None  # the task that it names; None for who leaves such a team
    pursued: int | None = None  # what it headed for in this step
    charger: int | None = None  # where it charges before it goes on
    charges_for: int | None = None  # the task before which it has asked whether to
    has_walked: bool = False  # in this step


@dataclass
class Happenings:
    """What happened in a step, in the order of robots, slots and tasks."""

    splits: list[tuple[Robots, Robots]] = field(default_factory=list)  # who stays, who leaves
    joins: list[tuple[int, int]] = field(default_factory=list)  # slots of joiner and partner
    named: list[int] = field(default_factory=list)  # slots whose decision named their task
    lost: list[int] = field(default_factory=list)
    back: list[int] = field(default_factory=list)
    cancelled: list[int] = field(default_factory=list)
    found: list[int] = field(default_factory=list)
    moved: dict[int, Place] = field(default_factory=dict)  # where tasks are believed to be now
    shown: list[int] = field(default_factory=list)
    begun: list[int] = field(default_factory=list)  # services
    taken: dict[int, int] = field(default_factory=dict)  # loads taken up, by which slot
    left: dict[int, Place] = field(default_factory=dict)  # loads set down, and where they lie
    done: dict[int, int] = field(default_factory=dict)  # tasks, by which slot
    missed: list[int] = field(default_factory=list)  # tasks that are not done any more
    known: list[int] = field(default_factory=list)  # tasks that appeared
    opened: list[int] = field(default_factory=list)  # tasks that may begin from now on
    charged: set[int] = field(default_factory=set)  # robots that charged
    queued: set[int] = field(default_factory=set)  # robots that waited for room at a charger
    is_elsewhere: bool = False  # a task was found elsewhere than it was believed to be
    any_broken_off: bool = False
    any_overdue: bool = False


class PlainWorld:
    """A mission while it is played by the plain rules; slots, robots and tasks are numbers.

    `truth` is what an uncertain mission really is. `order` has the tasks that are shared out; who
    plays sets it, and where robots go by plans `next` (what each robot does next, by number) and
    `awaited` (the tasks that somebody is to do who is there).
    """

    def __init__(
        self,
        mission: Mission,
        truth: Mission | None = None,
        is_coordinated: bool = False,
        foresight: str = "scouting",
    ) -> None:
        self.truth = truth or mission
        self.mission = mission = with_arrivals(mission, self.truth)
        self.is_coordinated, self.foresight = is_coordinated, foresight
        world = mission.world
        assert isinstance(world, Grid | Plane)
        self.world, self.ways = world, PlainWays(world)
        self.here = world.arrival_radius if isinstance(world, Plane) else 0.0
        self.sensing_radius = max(mission.sensing_radius, self.here)
        self.join_radius = max(mission.join_radius, self.here)
        self.finding_radius = max(mission.finding_radius, self.here)
        self.brings = [self.in_units(robot.can) for robot in mission.robots]
        self.regions = [None if robot.flies else world.region(robot.at) for robot in mission.robots]
        self.rotas = rotas_of(mission.robots)  # by robot; empty where all always work
        self.teams: dict[int, PlainTeam] = {}
        self.slot_of: list[int | None] = [None] * len(mission.robots)
        for robots in mission.starting_teams:
            self.found_team(robots, mission.robots[robots[0]].at)
        self.with_battery = {r: own for r, it in enumerate(mission.robots) if (own := it.battery)}
        self.left = {r: own.starts * own.lasts for r, own in self.with_battery.items()}
        self.wanted = {r: mission.charging.wanted(r) for r in self.with_battery if mission.charging}
        self.queued: dict[int, int] = {}  # robots at chargers, and when they came there
        self.charging: set[int] = set()  # those of them who have a place
        self.dry: set[int] = set()
        self.lost_at: dict[int, Place] = {}
        self.order: list[int] = []
        self.next: list[int | None] = [None] * len(mission.robots)
        self.awaited: set[int] = set()
        self.luck = {  # by which delays are drawn
            number: ((robot.delays.seed or 0) * 2654435769 + 88172645463325252) % 2**64
            for number, robot in enumerate(self.truth.robots)
            if robot.delays is not None
        }
        self.partners: dict[int, int] = {}  # who wants to join whom in this step
        self.steps = self.joins = self.splits = self.illegal = 0
        self._list_tasks(world)

    def _list_tasks(self, world: Grid | Plane) -> None:
        tasks = self.mission.tasks
        self.needs = [self.in_units(task.needs) for task in self.truth.tasks]  # as believed
        self.hidden = {k for k, task in enumerate(tasks) if task.may_need}
        self.at = [believed_place(world, task) for task in tasks]
        self.first_places = tuple(self.at)
        self.task_regions = [world.region(place) for place in self.at]
        self.maybe = {  # where tasks may be that are not found, in the order of preference
            k: list(possible_places(world, task.at, task.within))
            for k, task in enumerate(tasks)
            if task.within
        }
        self._squares: dict[tuple[int, int], set[int]] = defaultdict(set)
        for task, place in enumerate(self.at):
            self._squares[self._square(place)].add(task)
        self.before = tasks_before(tasks)
        self.lies: dict[int, Place] = {}  # where loads were set down last
        self.list_rooms()
        self.known: set[int] = set()
        self.open: set[int] = set()  # known and not over
        self.may_begin: set[int] = set()
        self.done: dict[int, int] = {}  # task -> step
        self.cancelled: dict[int, int] = {}
        self.missed: dict[int, int] = {}
        self.served: set[int] = set()
        self.carried: set[int] = set()  # loads; `serving` has steps at their goals left
        self.let_go: dict[int, Place] = {}  # loads set down in this step, and where
        self.unloading: set[int] = set()  # loads that are unloaded in zones
        self.came: dict[int, int] = {}  # loads that wait for room there, and since which step
        self.due: dict[int, int] = {}  # of services, how many steps they are expected to take
        self.begun_at: dict[int, int] = {}  # the step in which each service began
        self.happened = Happenings()

    def list_rooms(self) -> None:
        """Work out which tasks are in which zones, loads by where they lie."""
        self.rooms = all_rooms_of(self.mission, self.lies)
        self.in_zones = frozenset[int]().union(*(room.tasks for room in self.rooms))
        self.brought_to_zones = frozenset[int]().union(*(room.loads for room in self.rooms))

    def stop_unloading(self, task: int) -> None:
        """Let a load be unloaded no more, nor wait for it."""
        self.unloading.discard(task)
        self.came.pop(task, None)

    def in_units(self, counts: Counts) -> Units:
        """Return counts in the order of the capabilities, in whole units."""
        found = self.mission.in_units(counts)
        return tuple(found.get(cap, 0) for cap in self.mission.capabilities)

    def sum_of(self, robots: Iterable[int]) -> Units:
        """Return what robots bring together."""
        brings = [self.brings[robot] for robot in robots]
        return tuple(map(sum, zip(*brings, strict=True))) or (0,) * len(self.mission.capabilities)

    def found_team(self, robots: Sequence[int], at: Place) -> PlainTeam:
        """Make robots a team that has no task, and return it."""
        members = tuple(sorted(robots))
        fleet = [self.mission.robots[robot] for robot in members]
        team = PlainTeam(
            robots=members,
            at=at,
            has=self.sum_of(members),
            pace=min(self.pace_of(robot) for robot in members),
            flies=all(robot.flies for robot in fleet),
        )
        for robot in members:
            self.slot_of[robot] = members[0]
        self.teams[members[0]] = team
        return team

    def pace_of(self, robot: int) -> float:
        """Return how many cells or metres a robot walks in a step."""
        return self.world.pace(self.mission.robots[robot].speed)

    def is_due(self, robot: int) -> bool:
        """Say whether a robot that is lost will be back."""
        return robot not in self.dry and self.truth.robots[robot].is_due(self.steps)

    def is_in_shift(self, robots: Iterable[int], begin: int, end: int) -> bool:
        """Say whether one shift of each robot has all the time between two numbers of steps."""
        rotas = [self.rotas[robot] for robot in robots] if self.rotas else []
        return fits_now(rotas, begin, end - begin)

    def is_at_work(self, robots: Iterable[int]) -> bool:
        """Say whether all robots work in the step that is made next, or now."""
        return self.is_in_shift(robots, self.steps, self.steps + 1)

    def in_slot_order(self) -> list[tuple[int, PlainTeam]]:
        """Return all teams with their slots, the lowest first."""
        return sorted(self.teams.items())

    def is_same(self, one: Place, other: Place) -> bool:
        """Say whether two places are one: the same cell, or within the arrival radius."""
        return apart_squared(one, other) <= self.here**2

    def tasks_at(self, place: Place) -> list[int]:
        """Return the tasks that are believed to be in a place, in order."""
        column, row = self._square(place)
        if isinstance(self.world, Grid):
            return sorted(self._squares.get((column, row), ()))
        near = (
            self._squares.get((column + i, row + j), ()) for i in (-1, 0, 1) for j in (-1, 0, 1)
        )
        return sorted(k for part in near for k in part if self.is_same(place, self.at[k]))

    def put_task(self, task: int, place: Place) -> None:
        """Believe a task to be in a place from now on."""
        self._squares[self._square(self.at[task])].remove(task)
        self.at[task] = place
        self._squares[self._square(place)].add(task)

    def _square(self, place: Place) -> tuple[int, int]:
        if isinstance(self.world, Grid):
            return int(place[0]), int(place[1])
        side = max(self.here, SMALLEST_SQUARE)
        return math.floor(place[0] / side), math.floor(place[1] / side)

    def covers(self, have: Units, task: int) -> bool:
        """Say whether counts are all that a task needs, as far as anybody knows."""
        return all(h >= n for h, n in zip(have, self.needs[task], strict=True))

    def can_reach(self, team: PlainTeam, task: int) -> bool:
        """Say whether a way leads a team to a task."""
        regions = (self.regions[robot] for robot in team.robots)
        return team.flies or self.task_regions[task] in regions

    def drop(self, task: int) -> None:
        """Let a task be done no more: who serves it or heads for it is free, and a load lies."""
        for tasks in (self.open, self.carried, self.served):
            tasks.discard(task)
        self.let_go.pop(task, None)
        self.stop_unloading(task)
        for team in self.teams.values():
            team.serving.pop(task, None)
            if team.task == task:
                team.task, team.is_detour = None, False

    def rank(self, task: int) -> int:
        """Return the place of a task in the order; of one that has none yet, the first."""
        return self.order.index(task) if task in self.order else 0

    def over_in(self, task: int) -> int | None:
        """Return in which step a task was done, called off or missed; None if it is not over."""
        return self.done.get(task, self.cancelled.get(task, self.missed.get(task)))

    def shared_out(self) -> set[int]:
        """Return the tasks that plans have, all known ones, or the order: those that may begin."""
        return set(self.open) if self.is_coordinated else self.open & self.may_begin
