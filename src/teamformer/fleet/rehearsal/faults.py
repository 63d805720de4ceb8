"""A schedule of faults: what a rehearsal does to network and robots, drawn from one seed."""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import dataclass, replace

from msgspec import structs

from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.messages import TaskFact
from teamformer.mission.model import Absence, Mission

FIRST_ARRIVAL = 1 << 31
"""The origin in the keys of tasks that appear at random: operators' draw lower ones."""

BREAKS_FOR = 2.0
"""For so many times as long as a mission takes undisturbed, robots break down by its file."""

HARD = 0.35
"""How often each kind of fault is in a schedule."""


@dataclass(frozen=True)
class Cut:
    """Messages from some robots to some others are lost from `begin` to `end`."""

    senders: frozenset[int]
    receivers: frozenset[int]
    begin: float
    end: float


@dataclass(frozen=True)
class Crash:
    """A robot breaks down; `back` is when it starts anew, with its facts file or without."""

    robot: int
    at: float
    back: float | None = None
    keeps_facts: bool = True


@dataclass(frozen=True)
class Spell:
    """Something is so for a robot from `begin` to `end` (None: for good)."""

    robot: int
    begin: float
    end: float | None


@dataclass(frozen=True)
class Drain:
    """The battery of a robot loses at once a share of what it has left."""

    robot: int
    at: float
    share: float


@dataclass(frozen=True)
class Order:
    """An operator adds a task; the word of it reaches the robots over the same bad network."""

    at: float
    task: TaskFact


@dataclass(frozen=True)
class Withdrawal:
    """An operator calls a task of the mission off, over the same bad network."""

    at: float
    task: int


@dataclass(frozen=True)
class Faults:
    """Everything that goes wrong in one rehearsal; `seed` is of the network's chances."""

    seed: int = 0
    loss: float = 0.0  # of messages
    twice: float = 0.0  # of messages that come a second time
    delay: float = 0.0  # seconds that a message is late at most
    late: float = 0.0  # of messages that are late
    radio: float | None = None  # how far messages get, in cells or metres
    junk: float = 0.0  # malformed and foreign messages a second
    skew: tuple[float, ...] = ()  # of each robot's clock, seconds
    drift: tuple[float, ...] = ()  # of each robot's clock, of a second
    lag: tuple[float, ...] = ()  # seconds that each body's reports are late
    stutter: float = 0.0  # of reports that are an older one again
    cuts: tuple[Cut, ...] = ()
    crashes: tuple[Crash, ...] = ()
    pauses: tuple[Spell, ...] = ()
    stuck: tuple[Spell, ...] = ()
    orders: tuple[Order, ...] = ()
    withdrawals: tuple[Withdrawal, ...] = ()
    drained: tuple[Drain, ...] = ()

    @property
    def over(self) -> float:
        """Return when the last fault that ends, or that happens once, is over."""
        times = [0.0]
        times += [cut.end for cut in self.cuts]
        times += [crash.at if crash.back is None else crash.back for crash in self.crashes]
        for spell in (*self.pauses, *self.stuck):
            times.append(spell.begin if spell.end is None else spell.end)
        times += [order.at for order in self.orders]
        times += [withdrawal.at for withdrawal in self.withdrawals]
        times += [drain.at for drain in self.drained]
        return max(times)

    def happenings(self) -> Iterator[tuple[float, str, int]]:
        """Yield when faults of robots begin and end, and what happens then.

        To which robot, or for crashes and drained batteries the number of the fault.
        """
        for number, crash in enumerate(self.crashes):
            yield crash.at, "crash", number
            if crash.back is not None:
                yield crash.back, "restart", number
        for begins, ends, spells in (
            ("pause", "resume", self.pauses),
            ("stuck", "free", self.stuck),
        ):
            for spell in spells:
                yield spell.begin, begins, spell.robot
                if spell.end is not None:
                    yield spell.end, ends, spell.robot
        for number, drain in enumerate(self.drained):
            yield drain.at, "drain", number

    @property
    def kinds(self) -> tuple[str, ...]:
        """Name what goes wrong."""
        values = {key: value for key, value in vars(self).items() if key not in ("seed", "late")}
        return tuple(
            key
            for key, value in values.items()
            if (any(value) if isinstance(value, tuple) else value is not None and value != 0.0)
        )

    def lines(self, mission: FleetMission) -> Iterator[str]:
        """Say for people what goes wrong, a line for each fault."""
        yield from self._lines_of_network()
        names = [robot.name for robot in mission.source.robots]
        for cut in self.cuts:
            if len(cut.senders | cut.receivers) == 1:
                continue  # who hears nothing from itself misses nothing
            ends = (
                ", ".join(names[robot] for robot in sorted(side))
                for side in (cut.senders, cut.receivers)
            )
            yield f"{cut.begin:.2f} to {cut.end:.2f} s: no word from {' to '.join(ends)}"
        for crash in self.crashes:
            back = "for good"
            if crash.back is not None:
                facts = "with" if crash.keeps_facts else "without"
                back = f"until {crash.back:.2f} s, back {facts} its facts"
            yield f"{crash.at:.2f} s: {names[crash.robot]} breaks down {back}"
        for what, spells in (("freezes", self.pauses), ("cannot move", self.stuck)):
            for spell in spells:
                end = "for good" if spell.end is None else f"until {spell.end:.2f} s"
                yield f"{spell.begin:.2f} s: {names[spell.robot]} {what} {end}"
        for robot, lag in enumerate(self.lag):
            if lag:
                yield f"the body of {names[robot]} reports {lag:.2f} s late"
        for drain in self.drained:
            lost = f"{100 * drain.share:.0f}% of what it has left"
            yield f"{drain.at:.2f} s: the battery of {names[drain.robot]} loses {lost}"
        for order in self.orders:
            yield f"{order.at:.2f} s: an operator adds task {order.task.name}"
        for off in self.withdrawals:
            name = mission.source.tasks[off.task].name
            yield f"{off.at:.2f} s: an operator calls task {name} off"

    def _lines_of_network(self) -> Iterator[str]:
        if self.loss:
            yield f"{100 * self.loss:.0f}% of messages are lost"
        if self.twice:
            yield f"{100 * self.twice:.0f}% of messages come twice"
        if self.late:
            yield f"{100 * self.late:.0f}% of messages are up to {self.delay:g} s late"
        if self.radio is not None:
            yield f"messages reach {self.radio:.1f} far"
        if self.junk:
            yield f"{self.junk:g} messages a second are malformed or foreign"
        if self.stutter:
            yield f"{100 * self.stutter:.0f}% of bodies' reports are older ones again"


def draw_faults(mission: FleetMission, seed: int, span: float) -> Faults:
    """Draw a schedule; `span` is about how long the mission takes undisturbed, in seconds.

    Breakdowns and tasks that appear at random, as the mission's file has them, are part of it.
    """
    rng = random.Random(seed)
    network = _draw_network(rng, mission)
    robots, truth = range(mission.robots), mission.truth(network.seed)
    broken = _breakdowns_of(mission, truth, BREAKS_FOR * span)
    return replace(
        network,
        skew=tuple(rng.uniform(-1000, 1000) for _ in robots),
        drift=tuple(rng.choice((0.0, rng.uniform(-0.02, 0.02))) for _ in robots),
        lag=tuple(rng.uniform(0, 1.5) if rng.random() < 0.15 else 0.0 for _ in robots),
        stutter=rng.uniform(0.02, 0.3) if rng.random() < 0.2 else 0.0,
        cuts=tuple(_draw_cuts(rng, mission.robots, span)) if rng.random() < 0.5 else (),
        crashes=(*_draw_crashes(rng, mission, span), *broken),
        pauses=tuple(_draw_spells(rng, mission.robots, span, (5, 30), 0.0, 0.35)),
        stuck=tuple(_draw_spells(rng, mission.robots, span, (5, 40), 0.3, 0.25)),
        orders=(
            *(_draw_orders(rng, mission, span) if rng.random() < 0.3 else ()),
            *_arrivals_of(mission, truth),
        ),
        withdrawals=tuple(_draw_withdrawals(rng, mission, span)) if rng.random() < 0.15 else (),
        drained=tuple(_draw_drains(rng, mission, span)),
    )


def _draw_network(rng: random.Random, mission: FleetMission) -> Faults:
    loss = rng.choice((0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 0.9)) if rng.random() < 0.6 else 0.0
    delay = rng.choice((0.1, 0.3, 1.0, 3.0)) if rng.random() < 0.4 else 0.0
    across = mission.across
    return Faults(
        seed=rng.getrandbits(32),
        loss=loss,
        twice=rng.choice((0.1, 0.5)) if rng.random() < HARD else 0.0,
        delay=delay,
        late=rng.uniform(0.05, 0.6) if delay else 0.0,
        radio=across * rng.uniform(0.15, 0.5) if rng.random() < 0.2 else None,
        junk=rng.choice((0.5, 3.0)) if rng.random() < HARD else 0.0,
    )


def _draw_cuts(rng: random.Random, robots: int, span: float) -> Iterator[Cut]:
    """Draw links that work one way only, and partitions: no word from one side to the other."""
    everybody = frozenset(range(robots))
    for _ in range(rng.randint(1, 3)):
        begin = rng.uniform(0, span)
        end = begin + rng.uniform(3, 40)
        if rng.random() < 0.5:
            one, other = frozenset({rng.randrange(robots)}), everybody
            if rng.random() < 0.5:
                other = frozenset({rng.randrange(robots)})
            yield Cut(*((one, other) if rng.random() < 0.5 else (other, one)), begin, end)
        else:
            side = frozenset(robot for robot in everybody if rng.random() < 0.5)
            yield Cut(side, everybody - side, begin, end)
            yield Cut(everybody - side, side, begin, end)


def losses_of(mission: FleetMission) -> tuple[Crash, ...]:
    """Return what befalls robots by the mission's file, where they are lost and back."""
    return tuple(
        _crash_of(mission, robot, away)
        for robot, at in enumerate(mission.source.robots)
        for away in at.absences
    )


def _crash_of(mission: FleetMission, robot: int, away: Absence) -> Crash:
    """Return that a robot is lost, and back with its facts file."""
    back = None if away.back is None else mission.begin_of(away.back)
    return Crash(robot, mission.begin_of(away.lost), back, keeps_facts=True)


def _breakdowns_of(mission: FleetMission, truth: Mission, until: float) -> Iterator[Crash]:
    """Yield the breakdowns of robots that have `breaks`, as the truth has them, until a time."""
    for robot, (at, real) in enumerate(zip(mission.source.robots, truth.robots, strict=True)):
        for away in real.absences if at.breaks else ():
            crash = _crash_of(mission, robot, away)
            if crash.at <= until:
                yield crash


def _arrivals_of(mission: FleetMission, truth: Mission) -> Iterator[Order]:
    """Yield the tasks that appear at random by the truth, as what an operator adds then."""
    facts = mission.facts_of(truth)[len(mission.tasks) :]
    for number, task in enumerate(facts):
        key = (FIRST_ARRIVAL + number) << 24
        if task.appears < mission.until:
            yield Order(task.appears, structs.replace(task, key=key, appears=0.0))


def _draw_crashes(rng: random.Random, mission: FleetMission, span: float) -> Iterator[Crash]:
    yield from losses_of(mission)
    known = enumerate(mission.source.robots)
    robots = [r for r, at in known if not (at.absences or at.breaks)]
    number = rng.randint(1, max(1, mission.robots // 2)) if rng.random() < 0.5 else 0
    for robot in rng.sample(robots, min(number, len(robots))):
        begin = rng.uniform(0, span)
        is_back = rng.random() < 0.6
        back = begin + rng.choice((rng.uniform(0.5, 9), rng.uniform(5, 40))) if is_back else None
        yield Crash(robot, begin, back, rng.random() < 0.5)


def _draw_spells(
    rng: random.Random,
    robots: int,
    span: float,
    seconds: tuple[float, float],
    for_good: float,
    part: float,
) -> Iterator[Spell]:
    if rng.random() >= part:
        return
    for robot in rng.sample(range(robots), rng.randint(1, min(2, robots))):
        begin = rng.uniform(0, span)
        end = begin + rng.uniform(*seconds)
        yield Spell(robot, begin, None if rng.random() < for_good else end)


def _draw_withdrawals(
    rng: random.Random, mission: FleetMission, span: float
) -> Iterator[Withdrawal]:
    keys = range(len(mission.tasks))
    for key in rng.sample(keys, rng.randint(1, min(2, len(keys)))):
        at = rng.uniform(0, span)
        if at < mission.until:
            yield Withdrawal(at, key)


def _draw_drains(rng: random.Random, mission: FleetMission, span: float) -> Iterator[Drain]:
    """Draw what happens to batteries; nothing is drawn where nobody has one."""
    charged = [number for number, robot in enumerate(mission.source.robots) if robot.battery]
    if charged and rng.random() < HARD:
        for robot in rng.sample(charged, rng.randint(1, min(2, len(charged)))):
            yield Drain(robot, rng.uniform(0, span), rng.choice((0.25, 0.5, 0.9)))


def _draw_orders(rng: random.Random, mission: FleetMission, span: float) -> Iterator[Order]:
    """Draw tasks that operators add: like one of the mission's, where another one is."""
    for number in range(rng.randint(1, 3)):
        like, beside = rng.choice(mission.tasks), rng.choice(mission.tasks)
        key = (1 + rng.getrandbits(30)) << 24 | number
        place = (beside.x, beside.y)
        place = place if mission.can_do_at(like, place) else (like.x, like.y)
        task = TaskFact(key, f"order-{number + 1}", *place, like.needs, like.duration)
        at = rng.uniform(0, span)
        if at < mission.until:
            yield Order(at, task)
