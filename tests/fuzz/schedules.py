"""What befalls a rehearsed fleet: its network, its robots, its operators."""

from __future__ import annotations

from collections.abc import Iterator

from hypothesis import strategies as st

from drawing import now_and_then, pick
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.messages import TaskFact
from teamformer.fleet.rehearsal.faults import (
    Crash,
    Cut,
    Faults,
    Order,
    Spell,
    Withdrawal,
    losses_of,
)

MOMENTS = (0.0, 1.0, 3.7, 10.0, 25.0)
LENGTHS = (5.0, 0.5, 12.0, 35.0)


@st.composite
def schedules(draw: st.DrawFn, mission: FleetMission) -> Faults:
    """Return a schedule of faults: every kind of them, none in the simplest case."""
    robots = mission.robots
    across = mission.across

    def share(*values: float) -> float:
        return pick(draw, values) if now_and_then(draw, 3) else 0.0

    def of_each(*values: float) -> tuple[float, ...]:
        is_so = now_and_then(draw, 3)
        return tuple(pick(draw, values) for _ in range(robots)) if is_so else ()

    delay = share(0.3, 3.0)
    return Faults(
        seed=pick(draw, range(20)),
        loss=share(0.1, 0.5, 0.9),
        twice=share(0.1, 0.5),
        delay=delay,
        late=share(0.1, 0.6) if delay else 0.0,
        radio=across * 0.4 if now_and_then(draw, 6) else None,
        junk=share(0.5, 3.0),
        skew=of_each(0.0, 1000.0, -500.0),
        drift=of_each(0.0, 0.02, -0.02),
        lag=of_each(0.0, 0.3, 1.4),
        stutter=share(0.1, 0.3),
        cuts=tuple(_cuts(draw, robots)),
        crashes=tuple(_crashes(draw, mission)),
        pauses=tuple(_spells(draw, robots, can_last=False)),
        stuck=tuple(_spells(draw, robots, can_last=True)),
        orders=tuple(_orders(draw, mission)),
        withdrawals=tuple(_withdrawals(draw, mission)),
    )


def _cuts(draw: st.DrawFn, robots: int) -> Iterator[Cut]:
    while now_and_then(draw):
        begin = pick(draw, MOMENTS)
        senders = frozenset({pick(draw, range(robots))})
        others = frozenset(range(robots)) - senders if now_and_then(draw, 2) else senders
        yield Cut(senders, others, begin, begin + pick(draw, LENGTHS))


def _crashes(draw: st.DrawFn, mission: FleetMission) -> Iterator[Crash]:
    """Return the losses that the file says, and others."""
    yield from losses_of(mission)
    for number, robot in enumerate(mission.source.robots):
        if not robot.absences and now_and_then(draw):
            at = pick(draw, MOMENTS)
            back = at + pick(draw, LENGTHS) if now_and_then(draw, 2) else None
            yield Crash(number, at, back, keeps_facts=now_and_then(draw, 2))


def _spells(draw: st.DrawFn, robots: int, can_last: bool) -> Iterator[Spell]:
    for robot in range(robots):
        if now_and_then(draw, 6):
            begin = pick(draw, MOMENTS)
            is_over = not can_last or not now_and_then(draw)
            yield Spell(robot, begin, begin + pick(draw, LENGTHS) if is_over else None)


def _withdrawals(draw: st.DrawFn, mission: FleetMission) -> Iterator[Withdrawal]:
    """Return which tasks of the mission operators call off, and when."""
    for key in range(len(mission.tasks)):
        if now_and_then(draw, 8):
            yield Withdrawal(pick(draw, MOMENTS[1:]), key)  # a task that begins called off is none


def _orders(draw: st.DrawFn, mission: FleetMission) -> Iterator[Order]:
    """Return tasks that operators add, each like one of the mission's."""
    for key in range(1, 1 + pick(draw, (0, 0, 0, 1, 2, 3))):
        like, lasts = pick(draw, mission.tasks), pick(draw, (0.0, 2.0))
        task = TaskFact(key << 24, f"order-{key}", like.x, like.y, like.needs, lasts)
        yield Order(pick(draw, MOMENTS), task)
