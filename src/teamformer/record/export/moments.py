"""A record unrolled: where every robot is after a step or at a time, in which team, what it did."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from teamformer.mission.parts.grid import Place
from teamformer.record.events.standing import StandingAt
from teamformer.record.phases import IDLE
from teamformer.record.record import Record
from teamformer.record.telling.unrolled import Unrolled
from teamformer.record.telling.whole import told_of
from teamformer.world.rules.constants import NOBODY

BETWEEN = 300
"""Times between the start and the end of a record in continuous time at which places are told."""


@dataclass(frozen=True)
class Moment:
    """How everybody stands after a step, or at a time; every tuple has one entry a robot.

    `phase` says what the robot did in that step, or does from that time on; at the start, before
    step 1, it is idle. Places on roads are where they are drawn.
    """

    step: float
    team: tuple[int, ...]  # slot, or NOBODY once lost
    place: tuple[Place, ...]  # of a lost robot, where it was last
    task: tuple[int, ...]  # that its team heads for, or NOBODY
    pursued: tuple[int, ...]  # that its team was about in the step, or NOBODY
    phase: tuple[str, ...]
    task_at: tuple[Place, ...]  # one a task: where it is, a load that is carried with its team


def moments(record: Record) -> Iterator[Moment]:
    """Yield the moments of a record, the start first.

    Those in continuous time are the times at which something happened, and others between them.
    """
    if record.is_continuous:
        happened = {event.at for event in record.events}
        yield from moments_at(record, sorted(happened.union(evenly(record, BETWEEN))))
        return
    unrolled = Unrolled(record)
    yield _moment(unrolled)
    for _ in record.steps:
        unrolled.go_on(record)
        yield _moment(unrolled)


def evenly(record: Record, count: int) -> list[float]:
    """Return so many times and one more, from the start to the end of a record."""
    return [record.length * part / count for part in range(count)] + [record.length]


def moments_at(record: Record, times: Iterable[float]) -> Iterator[Moment]:
    """Yield how everybody stands at times of a record in continuous time."""
    standing = StandingAt(record, told_of(record).layout)
    for when in times:
        runs = standing.runs_at(when)
        about = tuple(run.task for run in runs)
        yield Moment(
            when,
            tuple(standing.teams_at(when)),
            tuple(standing.places_at(when)),
            about,
            about,
            tuple(run.phase or IDLE for run in runs),
            tuple(standing.task_places_at(when)),
        )


def _moment(now: Unrolled) -> Moment:
    teams = now.teams
    deeds = [now.phases.of(teams, robot) for robot in range(len(teams.slot))]
    return Moment(
        now.steps,
        tuple(teams.slot),
        tuple(teams.place(robot) for robot in range(len(teams.slot))),
        tuple(NOBODY if slot == NOBODY else teams.task[slot] for slot in teams.slot),
        tuple(task for _, task in deeds),
        tuple(phase for phase, _ in deeds),
        now.task_places(),
    )
