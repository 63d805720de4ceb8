"""A record unrolled: where every robot is after each step, in which team, and what it did."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from teamformer.mission.parts.grid import Place
from teamformer.record.record import Record
from teamformer.record.telling.unrolled import Unrolled
from teamformer.world.rules.constants import NOBODY


@dataclass(frozen=True)
class Moment:
    """How everybody stands after a step; every tuple has one entry a robot.

    `phase` says what the robot did in that step; at the start, before step 1, it is idle.
    """

    step: int
    team: tuple[int, ...]  # slot, or NOBODY once lost
    place: tuple[Place, ...]  # of a lost robot, where it was last
    task: tuple[int, ...]  # that its team heads for, or NOBODY
    pursued: tuple[int, ...]  # that its team was about in the step, or NOBODY
    phase: tuple[str, ...]
    task_at: tuple[Place, ...]  # one a task: where it is, a load that is carried with its team


def moments(record: Record) -> Iterator[Moment]:
    """Yield the moments of a record, the start first."""
    unrolled = Unrolled(record)
    yield _moment(unrolled)
    for _ in record.steps:
        unrolled.go_on(record)
        yield _moment(unrolled)


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
