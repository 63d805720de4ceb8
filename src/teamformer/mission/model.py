"""The words of the project: robot, task and mission, checked when built."""

from __future__ import annotations

import copy
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

from teamformer.base.errors import MissionError
from teamformer.mission.checks.checks import find_problems
from teamformer.mission.checks.windows import opening_step
from teamformer.mission.keys.kinds import LARGEST_NUMBER
from teamformer.mission.keys.robot_keys import SLOWEST
from teamformer.mission.parts.capabilities import Counts, in_units, out_of_units, total, units_of
from teamformer.mission.parts.charging import Battery, Charger, Charging, has_batteries
from teamformer.mission.parts.grid import FREE, Grid, Place
from teamformer.mission.parts.places import possible_places
from teamformer.mission.parts.plane import Plane
from teamformer.mission.parts.regions import flood
from teamformer.mission.parts.roads import AIR, GROUND, Roads
from teamformer.mission.parts.shifts import Rota, Shift
from teamformer.mission.parts.zones import Zone

MOST_WALKING = 10**6
MOST_FORMING = 10**7
MOST_WAITING = 10**9 - MOST_WALKING - MOST_FORMING  # a file's step limit is a billion at most
"""What walks, forming and waits add to a step limit at most; steps are counted in 32 bits."""


MORE_ARRIVALS = 20
"""So many tasks beyond twice their mean appear at most, by step limits."""

LEAST_WALKED = 0.01
"""The share of its steps that a team walks in at least, by step limits, whatever happens to it."""

World = Grid | Plane | Roads


@dataclass(frozen=True)
class Breakdown:
    """How a robot may break down: with probability `rate` in each step.

    After a random number of steps it is back where it stood. `repair` has the least and the most;
    every whole number between them is equally likely. None means that it never comes back. In
    continuous time `rate` is how often it breaks down in a unit of time, at any moment, and every
    time between those of `repair` is equally likely.
    """

    rate: float
    repair: tuple[float, float] | None = None


@dataclass(frozen=True)
class Absence:
    """A robot is lost from step `lost` on; the first step of a trial is step 1.

    From step `back` on it is there again, alone and where it was lost; None means never. In
    continuous time both are times.
    """

    lost: float
    back: float | None = None


@dataclass(frozen=True)
class Delays:
    """How often a robot is delayed: it stands still in a step with probability `chance`.

    `seed` decides in which steps; with None they are drawn for each trial.
    """

    chance: float
    seed: int | None = None


@dataclass(frozen=True)
class Robot:
    """A robot: where it starts, what it can do, how fast it is, and when it is absent.

    Obstacles do not stop a robot that `moves` by air; a team flies if all its robots do. `speed` is
    in cells per step, on a plane in metres per second. `breaks` are random breakdowns. `delays`
    says how often it stands still; a team walks only in steps in which none of its robots stands
    still. On roads, `moves` says which table of ways the robot uses, and times are divided by
    `speed`. A robot with `shifts` works in these only; after `every` they
    come again, unless that is 0.
    """

    name: str
    at: Place
    can: Counts
    speed: float = 1.0
    absences: tuple[Absence, ...] = ()  # in the order of time
    breaks: Breakdown | None = None
    delays: Delays | None = None
    moves: str = GROUND
    note: str = ""  # for people
    shifts: tuple[Shift, ...] = ()  # in the order of time
    every: float = 0.0
    battery: Battery | None = None

    @cached_property
    def rota(self) -> Rota:
        """Return when it works."""
        return Rota(self.shifts, self.every)

    @property
    def flies(self) -> bool:
        """Say whether it moves by air."""
        return self.moves == AIR

    @property
    def has_surprises(self) -> bool:
        """Say whether it may break down or be delayed at steps that are not known beforehand."""
        return self.breaks is not None or (self.delays is not None and self.delays.seed is None)

    @property
    def expected_speed(self) -> float:
        """Return its average speed, alone."""
        return max(SLOWEST, self.speed * (1 - self.delays.chance)) if self.delays else self.speed

    @property
    def as_expected(self) -> Robot:
        """Return it as one that never breaks down, and walks as fast as it does on average.

        Its battery lasts as far as before: a robot that is held up spends nothing.
        """
        battery, longer = self.battery, self.speed / self.expected_speed
        if battery is not None and longer != 1.0:
            battery = battery.in_longer_units(longer)
        speed = self.expected_speed
        return replace(self, breaks=None, delays=None, speed=speed, battery=battery)

    @property
    def lost_for_good(self) -> float | None:
        """Return the step from which it is lost and never back; None if there is none."""
        last = self.absences[-1] if self.absences else None
        return last.lost if last is not None and last.back is None else None

    def is_due(self, now: float) -> bool:
        """Say whether it will be back after a moment; in steps, after so many that are made."""
        return any(away.back is not None and away.back > now for away in self.absences)


@dataclass(frozen=True)
class Arrivals:
    """Tasks that appear at random: after each of the first `until` steps, with probability `rate`.

    None appears in the first `since` of them; what did is a task like others. Each is in any free
    place, and takes `duration` steps. It needs one each of 1 to `most_needs` capabilities (0: of 1
    to all) of the robots that can get there.
    """

    rate: float
    until: int
    most_needs: int = 0
    duration: int = 0
    since: int = 0


@dataclass(frozen=True)
class Task:
    """A task: where it is and which capabilities one team must bring there together.

    `duration` is how many steps the team must stay. All spans and moments are in steps, whole
    numbers; in continuous time they are in the mission's unit and may be fractions. `appears` is
    how many steps have been made when everybody learns of the task; 0 means that it is known from
    the start. In step `cancelled` the task is called off if it is not done by then; nobody knows
    this before. The tasks named in `after` must be over, done or called off, before this one
    begins. `between` is the earliest time at which it may begin, and the time after which its end
    is late. In continuous time `starts` links tasks: `starts[other]` is the least and the most time
    that this task starts after `other` starts; other robots do it.

    A task with `to` has a load. The team takes it up at `at`, which takes `duration` steps, carries
    it to `to`, and stays `unload` steps; then the task is done.

    Some values may be uncertain. `lasts` has the least and the most that the task may take; every
    whole number of steps between them is equally likely, in continuous time every time. `duration`
    is then their mean, rounded up if both are whole. `may_need` has the probabilities with which
    one more of a capability is needed. `within` is how far from `at` the task may be, in cells or
    metres; with 0 it is at `at`. `has_arrived` marks a task that comes from the mission's
    `Arrivals`.
    """

    name: str
    at: Place
    needs: Counts
    duration: float = 0
    appears: float = 0
    cancelled: float | None = None
    after: tuple[str, ...] = ()
    between: tuple[float, float] | None = None
    starts: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    to: Place | None = None
    unload: float = 0
    lasts: tuple[float, float] | None = None
    may_need: Mapping[str, float] = field(default_factory=dict)
    within: float = 0.0
    weight: float = 1.0  # of its lateness, its end and of missing it in the cost
    has_arrived: bool = field(default=False, compare=False)
    note: str = ""  # for people
    optional: bool = False  # it may be left out

    def __post_init__(self) -> None:
        if self.lasts is not None:
            object.__setattr__(self, "duration", expected_steps(*self.lasts))

    def once_known(self, at: Place, needs: Counts, duration: float) -> Task:
        """Return the task with every uncertainty resolved to these values."""
        return replace(
            self, at=at, needs=needs, duration=duration, lasts=None, may_need={}, within=0.0
        )

    @property
    def ends_at(self) -> Place:
        """Return where its robots are once they have done it."""
        return self.at if self.to is None else self.to

    @property
    def longest(self) -> float:
        """Return the largest number of steps that it may take."""
        return self.duration if self.lasts is None else self.lasts[1]

    @property
    def worst_needs(self) -> dict[str, float]:
        """Return its needs if everything that may be needed is needed."""
        return total([self.needs, {cap: 1 for cap, p in self.may_need.items() if p > 0}])


def expected_steps(least: float, most: float) -> float:
    """Return the mean of a number that is anything between two bounds.

    It is rounded up if both are whole, as they are in steps.
    """
    both = least + most
    return -(-both // 2) if isinstance(both, int) else both / 2


@dataclass(frozen=True)
class Mission:
    """A world with its robots, tasks and rules: what a mission file holds.

    `teams` are the starting teams, as robot numbers; robots named in none start alone.
    Distances (`sensing_radius`, `join_radius`) are Euclidean, in cells or, on a plane, in metres.
    However small these are, teams in the same place sense each other and may join. Building an
    impossible mission raises `MissionError` with every problem found.

    `time` is `steps` or `continuous`. In continuous time a task starts when its last robot is
    there, and a coalition whose robots do not come from one place takes `forming` more. A mission
    `ends` with its last task (None), when all robots are back where they started (`home`), or when
    all are at a place. Plans are judged by their makespan, or by a `cost` that weighs quantities.

    A task with `within` is found once a team is within `finding_radius` of it. `arrivals` are tasks
    that appear at random. At `until` the mission is over, whatever is left.
    """

    name: str
    world: World
    capabilities: tuple[str, ...]
    robots: tuple[Robot, ...]
    tasks: tuple[Task, ...]
    teams: tuple[tuple[int, ...], ...] = ()
    sensing_radius: float = 1.0
    join_radius: float = 0.0
    forming_steps: int = 1
    step_limit: int = 0  # 0: a generous limit, see default_step_limit
    time: str = "steps"
    ends: Place | str | None = None
    forming: float = 0.0
    cost: Mapping[str, float] | None = None
    finding_radius: float = 1.0
    arrivals: Arrivals | None = None
    until: float | None = None
    chargers: tuple[Charger, ...] = ()
    zones: tuple[Zone, ...] = ()

    def __post_init__(self) -> None:
        problems = list(find_problems(self))
        if problems:
            raise MissionError(problems)
        if self.step_limit == 0:
            object.__setattr__(self, "step_limit", default_step_limit(self))

    @property
    def seconds_a_step(self) -> float:
        """Return how long a step takes: on a plane what it says, on a grid one second.

        A unit of continuous time counts as one second.
        """
        is_in_steps = self.time == "steps"
        return self.world.step if is_in_steps and isinstance(self.world, Plane) else 1.0

    @property
    def starting_teams(self) -> tuple[tuple[int, ...], ...]:
        """Return every starting team, lone robots included, by lowest robot number."""
        together = {robot for team in self.teams for robot in team}
        alone = ((robot,) for robot in range(len(self.robots)) if robot not in together)
        return tuple(sorted((*(tuple(sorted(team)) for team in self.teams), *alone)))

    @cached_property
    def has_surprises(self) -> bool:
        """Say whether something of the mission is only known while it runs."""
        return (
            self.arrivals is not None
            or any(task.lasts is not None or task.may_need or task.within for task in self.tasks)
            or any(robot.has_surprises for robot in self.robots)
        )

    @cached_property
    def charging(self) -> Charging | None:
        """Return which tasks robots can do with their batteries; None if none has one."""
        return Charging(self) if has_batteries(self.robots) else None

    @cached_property
    def units(self) -> Mapping[str, int]:
        """Return the unit of each capability that robots bring, in thousandths."""
        return units_of(robot.can for robot in self.robots)

    def in_units(self, counts: Counts) -> dict[str, int]:
        """Return counts as arrays hold them: in whole units, rounded up."""
        return in_units(counts, self.units)

    def out_of_units(self, counts: Mapping[str, int]) -> dict[str, float]:
        """Return counts that arrays hold as they are written; needs as they were rounded up."""
        return out_of_units(counts, self.units)


def as_believed(mission: Mission, **changes: object) -> Mission:
    """Return a mission with changes, without checks.

    What is believed at a moment may be impossible: robots that are needed are lost, say.
    """
    changed = copy.copy(mission)
    for name in ("units", "has_surprises", "charging"):
        changed.__dict__.pop(name, None)  # worked out of what is changed
    for name, value in changes.items():
        object.__setattr__(changed, name, value)
    return changed


def default_step_limit(mission: Mission) -> int:
    """Return a limit that no sensible policy reaches: four walks across the map for each task.

    Four more are added for each load. They are walked by the slowest robot, in a team of all where
    robots are delayed, and as rarely as the one is there that breaks down most. A step for each
    robot and walk, for forming, every duration, every repair and the latest arrival are added;
    where a task is to be looked for, a walk to every place that it may be in; with batteries, as
    much again, and that all robots charge before each walk.
    """
    slowest = min(mission.world.pace(robot.speed) for robot in mission.robots)
    chances = (robot.delays.chance for robot in mission.robots if robot.delays)
    mends = ((r.breaks.rate, r.breaks.repair) for r in mission.robots if r.breaks)
    is_there = (1 / (1 + rate * repair[1]) for rate, repair in mends if repair)
    slowest *= max(LEAST_WALKED, math.prod(1 - c for c in chances) * min(is_there, default=1))
    looks = sum(
        len(possible_places(mission.world, task.at, task.within))
        for task in mission.tasks
        if task.within
    )
    count, latest = len(mission.tasks), max(opening_step(task) for task in mission.tasks)
    if mission.arrivals is not None:
        mean, until = mission.arrivals.rate * mission.arrivals.until, mission.arrivals.until
        count += min(until, math.ceil(2 * mean) + MORE_ARRIVALS)
        latest = max(latest, until)
    loads = sum(task.to is not None for task in mission.tasks)
    walks = (4 * (count + loads + 1) + looks) * _longest_walk(mission)
    waits = sum(task.longest + task.unload for task in mission.tasks)
    waits += sum(r.breaks.repair[1] for r in mission.robots if r.breaks and r.breaks.repair)
    if mission.arrivals is not None:
        waits += (count - len(mission.tasks)) * mission.arrivals.duration
    forming = 4 * (count + 1) * len(mission.robots)
    steps = min(math.ceil(walks / slowest), MOST_WALKING) + min(forming, MOST_FORMING)
    limit = steps + min(math.ceil(waits + latest), MOST_WAITING)
    fills = math.ceil(sum(1 + robot.battery.fills for robot in mission.robots if robot.battery))
    limit += min(steps + 4 * (count + 1) * fills, MOST_WAITING) if fills else 0
    rotas = [robot.rota for robot in mission.robots if robot.shifts]
    return limit if not rotas else min(_limit_in_shifts(rotas, limit, count), LARGEST_NUMBER)


def _limit_in_shifts(rotas: Sequence[Rota], limit: float, tasks: int) -> int:
    """Return a limit where robots work in shifts only, from one where they always do.

    All takes as much longer as the robot that works least, and each task waits for ten turns.
    """
    share = min(rota.share for rota in rotas)
    turns = 10 * (tasks + 1) * max(rota.every for rota in rotas)
    return math.ceil(limit / share + turns + max(rota.shifts[-1][1] for rota in rotas))


def _longest_walk(mission: Mission) -> float:
    """Return a length that suffices between any two places that a robot can walk between."""
    world = mission.world
    if isinstance(world, Roads):
        return world.longest_way
    across = world.width + world.height
    if not world.rows:
        return across
    begins = {world.region(r.at): (int(r.at[0]), int(r.at[1])) for r in mission.robots}
    return 2 * max(across, flood(world.rows, FREE, begins.values()))  # there and back
