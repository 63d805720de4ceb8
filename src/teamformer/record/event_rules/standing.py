"""How robots and tasks stand by the events so far, and what is to come from outside."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

from teamformer.mission.checks.windows import release_of
from teamformer.mission.keys.mission_keys import HOME
from teamformer.mission.model import Mission
from teamformer.mission.parts.capabilities import covers, total
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.places import possible_places, sight_of
from teamformer.mission.parts.plane import Plane
from teamformer.mission.parts.shifts import fits_now, rotas_of
from teamformer.mission.parts.zones import AtWork, ZoneRoom, may_enter, may_unload, rooms_of
from teamformer.mission.precedence import keep_precedence, tasks_before
from teamformer.record.event_rules.lengths import Lengths, is_near
from teamformer.record.event_rules.names import BrokenRuleError, InWords, need
from teamformer.record.event_rules.outside import what_is_to_come
from teamformer.record.record import Record
from teamformer.world.continuous.events import Event, Passed, PlanMade
from teamformer.world.rules.constants import NOBODY

SEEN = 1e-9
"""By such a share a place may be farther away than the radius: it is rounded."""

FORMS, SERVES, CARRIES, UNLOADS, QUEUES = range(5)


@dataclass
class RobotNow:
    """A robot: its way, which begins where it is or was last, and what it is about."""

    way: tuple[Passed, ...]
    came_from: Place
    task: int = NOBODY
    work: int = NOBODY
    is_lost: bool = False
    walk: int = NOBODY  # the event with which it set out
    rest: float = 0.0  # of a lost one: how far in time from its next place
    walked: float = 0.0  # and from the place before
    since: int = NOBODY  # the latest event of it

    @property
    def is_walking(self) -> bool:
        """Say whether it is on its way."""
        return len(self.way) > 1


@dataclass
class WorkNow:
    """A team that forms or serves: since when, and when its part ends and all is done."""

    robots: tuple[int, ...]
    part: int
    begun: float
    ends: float
    event: int  # with which the part began
    way: tuple[Passed, ...] = ()
    overdue: float | None = None  # when it is overdue, if it will be
    came: float = math.inf  # since when it waits for room to unload


@dataclass
class Standing:
    """All of a mission at a time; `to_come` is what is still to come from outside, in order."""

    record: Record
    mission: Mission = field(init=False)
    truth: Mission = field(init=False)

    def __post_init__(self) -> None:
        """Begin at the start."""
        is_central = self.record.method == "central"  # who is told what the mission really is
        self.truth = self.record.true_mission
        self.mission = self.truth if is_central else self.record.mission
        self.now = 0.0
        self.lengths = Lengths(self.truth)
        self.is_plane = isinstance(self.truth.world, Plane)
        self.robots = [RobotNow((Passed(0.0, it.at),), it.at) for it in self.truth.robots]
        self.works: dict[int, WorkNow] = {}
        # who plans in advance is told all, and heeds nothing that he hears later, but for `central`
        is_told = is_central or not self.record.heeds
        tasks = enumerate(self.truth.tasks)
        self.appeared = {number for number, task in tasks if is_told or task.appears == 0}
        self.over: dict[int, float] = {}
        self.done: set[int] = set()
        self.missed: set[int] = set()
        self.started: dict[int, float] = {}
        self.lies: dict[int, Place] = {}
        self.unseen = {n for n, it in enumerate(self.mission.tasks) if it.may_need}
        self.maybe = {
            number: possible_places(self.mission.world, task.at, task.within)
            for number, task in enumerate(self.mission.tasks)
            if task.within
        }  # where tasks may be that nobody has found
        self.believed = {task: places[0] for task, places in self.maybe.items()}
        self.before = tasks_before(self.mission.tasks)
        self.travel = 0.0
        self.plan: PlanMade | None = None
        self.coalitions: dict[int, tuple[int, ...]] = {}
        self.order: list[int] = []
        self.linked = _linked(self.mission)
        self.has_rooms = bool(rooms_of(self.mission))
        self.events, self.count = self.record.events, 0  # how many of them have been taken in
        self.names = InWords(self.truth)
        self.to_come = what_is_to_come(self.truth)
        self.rotas = rotas_of(self.truth.robots)  # by robot; empty where all always work
        self.borders = [rota.next_border(0.0) for rota in self.rotas]  # of shifts, by robot
        self.news: dict[str, None] = {"start": None}  # of this moment, since the latest plan
        self.plans = 0  # made at this moment
        self.planned = NOBODY  # the latest event of a plan
        self.opened: dict[int, list[int]] = {}  # events of this moment that let tasks begin
        self.over_by: dict[int, int] = {}  # the event with which each task was over
        self.breaks: dict[int, int] = {}  # tasks whose service breaks off now, and by which event
        self.charges: object = None  # what is left in batteries, if there are any
        self.dry: set[int] = set()  # robots that have run dry
        self.at_chargers: dict[int, int] = {}  # robots that go to a charger, or are there for it

    def place_of(self, task: int) -> Place:
        """Return where a task is believed to be, or its load lies."""
        if task in self.maybe:
            return self.believed[task]
        return self.lies.get(task, self.truth.tasks[task].at)

    def is_open(self, task: int) -> bool:
        """Say whether a task is known, not over, and nobody serves it."""
        if task not in self.appeared or task in self.over:
            return False
        return task not in self.works or self.works[task].part == FORMS

    def go_by(self, plan: PlanMade) -> None:
        """Go by a plan: its tasks are behind those that they come after."""
        self.plan = plan
        self.coalitions = {row.task: row.robots for row in plan.tasks}
        planned = [row.task for row in plan.tasks if row.robots]
        waiting = [row.task for row in plan.tasks if not row.robots]
        kept = keep_precedence([*planned, *waiting], self.before)
        self.order = [task for task in kept if self.coalitions[task]]

    def next_task(self, robot: int) -> int:
        """Return the first open task that the plan has a robot do, NOBODY if there is none."""
        mine = (task for task in self.order if robot in self.coalitions[task])
        return next((task for task in mine if self.is_open(task)), NOBODY)

    def home_of(self, robot: int) -> Place | None:
        """Return where a robot goes without a task; None where it may stay."""
        ends = self.mission.ends
        home = self.mission.robots[robot].at if ends == HOME else ends
        assert not isinstance(home, str)
        return home

    def is_home(self, robot: int) -> bool:
        """Say whether a robot is where it has to be when the mission is over."""
        home = self.home_of(robot)
        return home is None or self.robots[robot].is_lost or self.is_at(robot, home)

    def is_at(self, robot: int, place: Place) -> bool:
        """Say whether a robot stands at a place, and is neither lost nor at work."""
        it = self.robots[robot]
        is_free = not it.is_lost and it.work == NOBODY and robot not in self.at_chargers
        return is_free and not it.is_walking and it.way[0].place == place

    def team_of(self, task: int) -> tuple[int, ...]:
        """Return the robots of a task's coalition that are not lost."""
        return tuple(r for r in self.coalitions.get(task, ()) if not self.robots[r].is_lost)

    def sees(self, robot: int, place: Place) -> bool:
        """Say whether a robot is near enough to a place to see what is there."""
        away = sight_of(self.mission.world, self.turns_at(robot)[0].place, place)
        radius = self.mission.finding_radius
        return away <= radius or (away < math.inf and away <= radius + SEEN * max(1.0, away))

    def brings(self, robots: tuple[int, ...], task: int) -> bool:
        """Say whether robots bring what a task really needs."""
        have = total(self.truth.robots[robot].can for robot in robots)
        return covers(have, self.truth.tasks[task].needs)

    def is_released(self, task: int) -> bool:
        """Say whether a task may begin, but for links of its start."""
        is_time = release_of(self.truth.tasks[task]) <= self.now
        return is_time and all(other in self.over for other in self.before.get(task, ()))

    def enters(self, task: int) -> bool:
        """Say whether a task may begin by the zones that it is in."""
        waiting = [other for other in self.order if self.is_open(other) and self.team_of(other)]
        return may_enter(self.rooms, waiting, self.at_work, task)

    def may_unload(self, task: int) -> bool:
        """Say whether a load that has been brought may be unloaded by the zones that it is in."""
        work = self.at_work
        queue = work.queue if task in work.queue else [*work.queue, task]
        return may_unload(self.rooms, work._replace(queue=queue), task)

    @property
    def rooms(self) -> list[ZoneRoom]:
        """Return the room of zones, with loads in it where they lie."""
        return rooms_of(self.mission, self.lies) if self.has_rooms else []

    @property
    def at_work(self) -> AtWork:
        """Return what takes room in zones, or waits for it with a load."""
        doing = {part: [k for k, work in self.works.items() if work.part == part]
                 for part in (SERVES, UNLOADS, QUEUES)}  # fmt: skip
        came = {task: (self.works[task].came, task) for task in doing[QUEUES]}
        return AtWork(doing[SERVES], doing[UNLOADS], sorted(came, key=came.__getitem__))

    @property
    def is_quiet(self) -> bool:
        """Say whether nobody is at work, forms or is on the way."""
        return not self.works and not any(it.is_walking and not it.is_lost for it in self.robots)

    def fits(self, robots: Sequence[int], takes: float) -> bool:
        """Say whether something that begins now fits into a shift of each of some robots."""
        if not self.rotas:
            return True
        return fits_now([self.rotas[robot] for robot in robots], self.now, takes)

    def believed_time(self, task: int, robots: tuple[int, ...]) -> float:
        """Return how long robots are believed to take for all of a task."""
        wanted = self.mission.tasks[task]
        return wanted.duration + self.carried(task, robots) + wanted.unload

    def all_done(self, task: int) -> float:
        """Return when a task is done that somebody is at work on, if nothing holds them up."""
        work, real = self.works[task], self.truth.tasks[task]
        if work.part in (FORMS, UNLOADS, QUEUES) or real.to is None:
            return work.ends
        carried = self.carried(task, work.robots) if work.part == SERVES else 0.0
        return work.ends + carried + real.unload

    def carried(self, task: int, robots: tuple[int, ...]) -> float:
        """Return how long robots carry a load from where it lies, by the slowest of them."""
        goal, here = self.truth.tasks[task].to, self.place_of(task)
        return 0.0 if goal is None else max(self.takes(robot, here, goal) for robot in robots)

    def takes(self, robot: int, here: Place, goal: Place) -> float:
        """Return how long a robot takes for a way, if nothing holds it up."""
        return self.lengths.between(here, goal, robot) / self.truth.robots[robot].speed

    def never_gets(self, robot: int, goal: Place) -> bool:
        """Say whether no way leads a robot to a place, or none before its last shift is over."""
        start = self.turns_at(robot)[-1]
        takes = self.takes(robot, start.place, goal)
        return math.isinf(takes) or math.isinf(self.lengths.when((robot,), start.at, takes))

    def turns_at(self, robot: int) -> tuple[Passed, ...]:
        """Return what a new way of a robot begins with."""
        return turning(self.robots[robot].way, self.now, self.is_plane)


def turning(way: tuple[Passed, ...], now: float, is_plane: bool) -> tuple[Passed, ...]:
    """Return where one is that goes a way, or between places the one before and the one after.

    In a plane one can turn anywhere, elsewhere at the next place.
    """
    after = next((n for n, passed in enumerate(way) if passed.at >= now), len(way))
    if len(way) == 1 or after == len(way):
        return (Passed(now, way[-1].place),)
    if after == 0 or way[after].at == now:
        return (Passed(now, way[after].place),)
    one, other = way[after - 1], way[after]
    if is_near(one.at, now):
        return (Passed(now, one.place),)
    if not is_plane and one.place != other.place:  # else it pauses there
        return one, other
    part = (now - one.at) / (other.at - one.at)
    x, y = (a + part * (b - a) for a, b in zip(one.place, other.place, strict=True))
    return (Passed(now, (x, y)),)


def _linked(mission: Mission) -> set[int]:
    """Return the tasks whose starts are linked."""
    number_of = {task.name: number for number, task in enumerate(mission.tasks)}
    pairs = (
        (number, number_of[name]) for number, it in enumerate(mission.tasks) for name in it.starts
    )
    return {task for pair in pairs for task in pair}


def has_to_form(now: Standing, team: Sequence[int]) -> bool:
    """Say whether a team has to form: if forming takes time and not all come from one place."""
    came_from = {now.robots[robot].came_from for robot in team}
    return now.mission.forming > 0 and len(came_from) > 1


def is_too_late(now: Standing, task: int, team: tuple[int, ...]) -> bool:
    """Say whether a task could not end in time if a team that stands there began now."""
    wanted, until = now.mission.tasks[task], now.mission.until
    begins = now.now + now.mission.forming * has_to_form(now, team)
    end = begins + wanted.duration + now.carried(task, team) + wanted.unload
    return until is not None and end > until and not is_near(end, until)


def work_on(now: Standing, event: Event) -> WorkNow:
    """Return the work on the task of an event."""
    work = now.works.get(event.task)
    if work is None:
        raise BrokenRuleError(f"nobody is at work on {now.names.task(event.task)}")
    return work


def expect(event: Event, until: float) -> None:
    """Check that an event says when it is to end."""
    is_so = event.until is not None and is_near(event.until, until)
    need(is_so, f"{event.kind} is to end at {until:.9g}, and the record says {event.until}")


def is_due(now: Standing, kind: str, which: int) -> bool:
    """Say whether what is to come from outside still is."""
    if kind in ("lost", "back"):
        return which not in now.dry
    return kind not in ("cancel", "opens") or which not in now.over


def one(event: Event) -> int:
    """Return the one robot of an event."""
    if len(event.robots) != 1:
        raise BrokenRuleError(f"{event.kind} is of one robot, not of {len(event.robots)}")
    return event.robots[0]
