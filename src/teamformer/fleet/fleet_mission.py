"""What every robot knows before it starts: the mission as numbers, and how patient it is."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from msgspec.structs import replace

from teamformer.files.mission_files import mission_to_tree
from teamformer.fleet.charging import FleetCharging
from teamformer.fleet.messages import TaskFact
from teamformer.mission.checks.optional import is_in_time
from teamformer.mission.checks.windows import window_opens
from teamformer.mission.model import Mission, Task, World
from teamformer.mission.parts.capabilities import Counts, exact
from teamformer.mission.parts.charging import has_batteries
from teamformer.mission.parts.grid import Grid, Place
from teamformer.mission.parts.places import believed_place, possible_places, sight_of
from teamformer.mission.parts.plane import Plane
from teamformer.mission.parts.roads import Roads
from teamformer.mission.parts.shifts import fits_all
from teamformer.mission.precedence import tasks_before
from teamformer.mission.truth import draw_truth, expected_mission
from teamformer.world.continuous.ways import Ways

ANYWHERE: Mapping[int, Place] = {}

Row = tuple[float, ...]
"""How much there is of each capability, in the mission's order."""

SLACK = 0.0005
"""Half of the last place of counts: sums of such fractions are not exact, but nearer than this."""


@dataclass(frozen=True)
class Timers:
    """How long a robot waits for what, in seconds; losses on the network stretch most of them."""

    beat: float = 1.0  # between heartbeats
    hurry: float = 0.2  # between heartbeats while others at the same task wait for word
    near: float = 3.0  # a word so old still counts at a task
    hold: float = 2.6  # for which READY is a promise to stay
    lost: float = 10.0  # without word of a robot until it is called lost
    deaf: float = 6.0  # without any word until a robot says that it is unfit
    stuck: float = 5.0  # without getting on until a robot says that it is unfit
    settle: float = 0.5  # for which a reason to plan must stand
    turn: float = 1.0  # more for each live robot with a lower number
    rest: float = 2.0  # for which a plan holds in any case


@dataclass(frozen=True)
class FleetMission:
    """A mission as agents need it; `step` is how many seconds a step, or a unit of time, takes.

    On roads a place is the number of the one that a robot is at, or comes to next, and the seconds
    until it is there.
    """

    source: Mission
    step: float = 1.0
    timers: Timers = field(default_factory=Timers)

    def __post_init__(self) -> None:
        tree = json.dumps([mission_to_tree(self.source), self.step], sort_keys=True)
        digest = hashlib.blake2b(tree.encode(), digest_size=8).digest()
        caps, robots = self.source.capabilities, self.source.robots
        world = self.source.world
        keep = object.__setattr__
        keep(self, "number", int.from_bytes(digest, "big") >> 2)
        keep(self, "counts", tuple(row_of(robot.can, caps) for robot in robots))
        keep(self, "brings", tuple(self.in_units(can) for can in self.counts))
        keep(self, "_regions", {})
        keep(self, "regions", tuple(self.region(robot.at) for robot in robots))
        keep(self, "tasks", self.facts_of(self.source))
        unsure = (key for key, task in enumerate(self.source.tasks) if task.may_need)
        keep(self, "unsure", frozenset(unsure))
        tours = ((k, places_to_look(self.source, task)) for k, task in enumerate(self.source.tasks))
        keep(self, "hidden", {key: tour for key, tour in tours if tour})
        keep(self, "believed", self.source)
        if self.source.has_surprises:
            keep(self, "believed", expected_mission(self.source))
        off = ((key, task.cancelled) for key, task in enumerate(self.source.tasks))
        keep(self, "off_at", {key: self.begin_of(at) for key, at in off if at is not None})
        keep(self, "radius", world.arrival_radius if isinstance(world, Plane) else 0.0)
        is_in_steps = self.source.time == "steps"
        forming = self.source.forming_steps if is_in_steps else self.source.forming
        keep(self, "forming", forming * self.step)
        keep(self, "sight", max(self.radius, self.source.sensing_radius))
        keep(self, "ways", Ways(world))
        charging = FleetCharging(self.source, self.ways) if has_batteries(robots) else None
        keep(self, "charging", charging)
        before = tasks_before(self.source.tasks)
        keep(self, "before", {key: frozenset(others) for key, others in before.items()})
        opens = ((key, _opens(task, is_in_steps)) for key, task in enumerate(self.source.tasks))
        keep(self, "opens", {key: at * self.step for key, at in opens if at})
        until = self.source.until
        keep(self, "until", math.inf if until is None else until * self.step)
        keep(self, "has_shifts", any(robot.rota for robot in robots))
        optional = (key for key, task in enumerate(self.source.tasks) if task.optional)
        keep(self, "optional", frozenset(optional))
        pace = world.pace if is_in_steps else float
        keep(self, "paces", tuple(pace(robot.speed) / self.step for robot in robots))
        expected = (pace(robot.expected_speed) / self.step for robot in robots)
        keep(self, "longest_walk", _length_across(world) / min(expected))

    number: int = field(init=False)  # the same for who has the same mission, 62 bits
    counts: tuple[Row, ...] = field(init=False)  # of each robot
    brings: tuple[tuple[int, ...], ...] = field(init=False)  # the same in units, as views have it
    tasks: tuple[TaskFact, ...] = field(init=False)
    regions: tuple[int, ...] = field(init=False)  # of each robot
    _regions: dict[Place, int] = field(init=False, repr=False, compare=False)
    radius: float = field(init=False)  # within which two places are the same
    forming: float = field(init=False)  # seconds that a split or join takes
    paces: tuple[float, ...] = field(init=False)  # of each robot, cells or metres a second
    longest_walk: float = field(init=False)  # seconds that the slowest takes across the map
    sight: float = field(init=False)  # within which a robot sees a load
    ways: Ways = field(init=False, repr=False, compare=False)
    charging: FleetCharging | None = field(init=False, repr=False, compare=False)
    unsure: frozenset[int] = field(init=False)  # tasks that may need more than is known
    hidden: dict[int, tuple[Place, ...]] = field(init=False)  # where to look for tasks, in order
    believed: Mission = field(init=False, repr=False, compare=False)  # with what to expect
    off_at: dict[int, float] = field(init=False)  # when tasks are called off, which nobody foresees
    before: dict[int, frozenset[int]] = field(init=False)  # what tasks come after, where anything
    opens: dict[int, float] = field(init=False)  # when tasks may begin, if later than at once

    until: float = field(init=False)  # when the mission is over, infinite for never
    optional: frozenset[int] = field(init=False)  # tasks that may be left out
    has_shifts: bool = field(init=False)  # of a robot

    @property
    def robots(self) -> int:
        """Return how many robots there are."""
        return len(self.counts)

    @property
    def across(self) -> float:
        """Return how long the longer side of the map is, or the longest way on roads."""
        world = self.source.world
        return world.longest_way if isinstance(world, Roads) else max(world.width, world.height)

    @property
    def ends(self) -> bool:
        """Say whether the mission ends with its robots home, or at a place."""
        return self.source.ends is not None

    @property
    def ends_by_places(self) -> bool:
        """Say whether the mission may be over as robots are home, or have no way or shift."""
        return self.ends or self.has_shifts or isinstance(self.source.world, Roads)

    def home_of(self, robot: int) -> Place | None:
        """Return where a robot has to be when the mission is over; None if it may be anywhere."""
        ends = self.source.ends
        return self.source.robots[robot].at if isinstance(ends, str) else ends

    def begin_of(self, moment: float) -> float:
        """Return the seconds after which a step begins, or what is the time in continuous time."""
        return (moment - 1 if self.source.time == "steps" else moment) * self.step

    def in_time(self, seconds: float) -> float:
        """Return seconds in the mission's unit: in steps whole ones."""
        units = seconds / self.step
        is_whole = self.source.time == "steps" and math.isfinite(units)
        return round(units) if is_whole else units

    def step_time(self, *robots: int) -> float:
        """Return for how long robots on their way stand in one place: in a cell, on a grid.

        Who is delayed may stand there for several steps.
        """
        pace = min(self.paces[robot] for robot in robots)
        delays = [self.source.robots[robot].delays for robot in robots]
        still = max((2 * self.step / (1 - it.chance) for it in delays if it), default=0.0)
        return still + (1.0 / pace if isinstance(self.source.world, Grid) else 0.0)

    def leads(self, robot: int, here: Place, there: Place) -> bool:
        """Say whether a way leads a robot from one place to another."""
        it, world = self.source.robots[robot], self.source.world
        if isinstance(world, Roads):
            return world.leads(it.moves, here, there)
        return it.flies or self.region(here) == self.region(there)

    def can_be_at(self, robot: int, place: Place) -> bool:
        """Say whether a robot can be at a place: over obstacles only if it flies."""
        world = self.source.world
        if isinstance(world, Roads):
            return place[1] >= 0 and world.is_inside((place[0], 0))
        return world.is_inside(place) if self.source.robots[robot].flies else world.is_free(place)

    def apart(self, here: Place, there: Place) -> float:
        """Return how far two places are from one another: on roads the time of the shorter way."""
        world = self.source.world
        if not isinstance(world, Roads):
            return math.dist(here, there)
        one, other = int(here[0]), int(there[0])
        if one == other:  # they go to the same place, or are there
            return abs(here[1] - there[1])
        pairs = ((one, other), (other, one))
        way = min(rows[a][b] for rows in world.ways.values() for a, b in pairs)
        return way + here[1] + there[1]

    def may_begin(self, key: int, over: Collection[int], age: float) -> bool:
        """Say whether a task may begin: those before it are over, and its window is open."""
        is_free = all(other in over for other in self.before.get(key, ()))
        return is_free and age >= self.opens.get(key, 0.0)

    def may_miss(self, key: int) -> bool:
        """Say whether a task may be left out; that may what operators add, if there is an end."""
        return key in self.optional or (key >= len(self.tasks) and self.may_miss_added)

    @property
    def may_miss_added(self) -> bool:
        """Say whether tasks that operators add may be left out."""
        cost = self.source.cost
        return self.until < math.inf and (cost is None or "missed" in cost)

    def ends_in_time(self, task: TaskFact, robots: Iterable[int], age: float) -> bool:
        """Say whether a task that robots begin at an age ends before the mission is over."""
        return self.until == math.inf or is_in_time(age + self.takes(task, robots), self.until)

    def takes(self, task: TaskFact, robots: Iterable[int]) -> float:
        """Return how many seconds robots are at work on a task, its load's way included."""
        lasts = task.duration + task.unload
        if task.to is None:
            return lasts
        here, movers = (task.x, task.y), [(self.source.robots[r].moves, r) for r in robots]
        ways = (self.ways.length(here, task.to, moves) / self.paces[r] for moves, r in movers)
        return lasts + max(ways, default=0.0)

    def comes(self, robot: int, here: Place, there: Place, age: float) -> float:
        """Return when a robot is at a place that sets out at an age; infinite for never."""
        it, left = self.source.robots[robot], 0.0
        if isinstance(self.source.world, Roads):
            left = here[1]
        length = self.ways.length(place_in(self.source.world, here), there, it.moves)
        walk = left + length / self.paces[robot]
        return it.rota.walked(age / self.step, walk / self.step) * self.step

    def is_at_work(self, robot: int, age: float) -> bool:
        """Say whether a robot is in one of its shifts at an age of the mission."""
        return self.source.robots[robot].rota.is_at_work(age / self.step)

    def fits(self, task: TaskFact, robots: Iterable[int], age: float, spare: float = 0.0) -> float:
        """Return at which age a task first fits into a shift of each robot, infinite for never.

        So many seconds of the shift are to be left to `spare`.
        """
        who = list(robots)
        if not self.has_shifts:
            return age
        rotas = [self.source.robots[robot].rota for robot in who]
        takes = self.takes(task, who) + spare
        return fits_all(rotas, age / self.step, takes / self.step) * self.step

    def is_same_place(self, x: float, y: float, other_x: float, other_y: float) -> bool:
        """Say whether two places are one."""
        if self.radius == 0.0:
            return x == other_x and y == other_y
        return (x - other_x) ** 2 + (y - other_y) ** 2 <= self.radius**2

    def is_site(self, x: float, y: float) -> bool:
        """Say whether a task can be at a place: in a free cell of a grid, anywhere on a plane."""
        world = self.source.world
        is_cell = float(x).is_integer() and float(y).is_integer()
        return world.is_free((x, y)) and (is_cell or not isinstance(world, Grid))

    def covers(self, robots: Iterable[int], needs: Sequence[float]) -> bool:
        """Say whether robots together have what is needed."""
        lacking = list(needs)
        for robot in robots:
            for cap, count in enumerate(self.counts[robot]):
                if count:
                    lacking[cap] -= count
        return max(lacking, default=0) < SLACK

    def reach(self, robot: int, task: TaskFact, here: Place | None = None) -> bool:
        """Say whether there is a way for a robot to a task, and on with its load.

        `here` is where it stands, by default where it starts; on roads not all ways lead back.
        """
        it = self.source.robots[robot]
        if not isinstance(self.source.world, Roads):
            return it.flies or self.regions[robot] == self.region((task.x, task.y))
        at = (task.x, task.y)
        has_way_on = task.to is None or self.leads(robot, at, task.to)
        return has_way_on and self.leads(robot, here or it.at, at)

    def region(self, place: Place) -> int:
        """Return the connected part of the map that a place is in."""
        found = self._regions.get(place)
        if found is None:
            found = self._regions[place] = self.source.world.region(place)
        return found

    def can_do(
        self, robots: Iterable[int], task: TaskFact, places: Mapping[int, Place] = ANYWHERE
    ) -> bool:
        """Say whether robots that get there together have what a task needs.

        `places` says where they stand, by default where they start.
        """
        there = [robot for robot in robots if self.reach(robot, task, places.get(robot))]
        if self.charging is not None:
            there = [r for r in there if self.charging.is_able(r, task, self.step)]
        return self.covers(there, task.needs)

    def can_do_at(self, task: TaskFact, place: Place) -> bool:
        """Say whether all robots could do a task if it were at some place."""
        return self.can_do(range(self.robots), replace(task, x=place[0], y=place[1]))

    def in_units(self, counts: Sequence[float]) -> tuple[int, ...]:
        """Return counts in the mission's units, rounded up."""
        named = dict(zip(self.source.capabilities, counts, strict=True))
        return tuple(self.source.in_units(named).values())

    def truth(self, seed: int) -> Mission:
        """Return the mission as it really is: the same one where nothing about it is uncertain."""
        return draw_truth(self.source, seed)

    def facts_of(self, mission: Mission) -> tuple[TaskFact, ...]:
        """Return the tasks of this mission, or of its truth."""
        return tuple(self._facts(mission))

    def _facts(self, mission: Mission) -> Iterable[TaskFact]:
        for key, task in enumerate(mission.tasks):
            needs = row_of(task.needs, self.source.capabilities)
            x, y = believed_place(self.source.world, task)
            duration, appears = task.duration * self.step, task.appears * self.step
            to = None if task.to is None else (float(task.to[0]), float(task.to[1]))
            unload = task.unload * self.step
            yield TaskFact(
                key=key,
                name=task.name,
                x=float(x),
                y=float(y),
                needs=needs,
                duration=duration,
                appears=appears,
                to=to,
                unload=unload,
            )


def _opens(task: Task, is_in_steps: bool) -> float:
    """Return when the window of a task begins, in steps or in units of time."""
    if is_in_steps:
        return window_opens(task)
    return task.between[0] if task.between else 0.0


def _length_across(world: World) -> float:
    """Return a length that a walk across the map has at most, or hardly more."""
    return world.longest_way if isinstance(world, Roads) else world.width + world.height


def place_in(world: World, at: Place) -> Place:
    """Return a place as missions have it; on roads the one that a robot comes to next."""
    if isinstance(world, Roads):
        return int(at[0]), 0
    return (int(at[0]), int(at[1])) if isinstance(world, Grid) else at


def places_to_look(mission: Mission, task: Task) -> tuple[Place, ...]:
    """Return places from which all are seen that a task may be in, nearest first; often none.

    Who is at one of them may be off by the radius within which places are the same.
    """
    world, tour = mission.world, list[Place]()
    off = world.arrival_radius if isinstance(world, Plane) else 0.0
    for place in possible_places(world, task.at, task.within) if task.within else ():
        radius = mission.finding_radius - off
        if not any(sight_of(world, place, seen) <= radius for seen in tour):
            tour.append(place)
    return tuple(tour)


def row_of(counts: Counts, capabilities: tuple[str, ...]) -> Row:
    """Return how much there is of each capability."""
    return tuple(exact(counts.get(name, 0)) for name in capabilities)
