"""What open tasks in continuous time wait for at a moment, whoever is there."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from teamformer.mission.checks.windows import release_of
from teamformer.mission.coordination import Known
from teamformer.mission.parts.zones import ZoneRoom, rooms_of
from teamformer.mission.precedence import tasks_before
from teamformer.world.rules.starts import Gap, RoomLeft


class Waits(NamedTuple):
    """What some tasks wait for, by number; times are counted from the mission's start."""

    release: dict[int, float]  # none starts before
    latest: dict[int, float]  # by when they are to start that are linked with tasks that have begun
    before: dict[int, list[int]]  # those of the tasks that must have ended before each, if any
    gaps: list[Gap]  # between the starts of two of them
    rooms: list[RoomLeft]  # of zones that some of them are in


def waits_at(known: Known, chosen: Sequence[int]) -> Waits:
    """Return what some open tasks wait for; what is neither of them nor begun is not waited for."""
    tasks, begun, ends = known.mission.tasks, known.started, dict(known.under_way)
    number_of = {task.name: number for number, task in enumerate(tasks)}
    among = set(chosen)
    waits = Waits(dict.fromkeys(chosen, 0.0), dict.fromkeys(chosen, math.inf), {}, [], [])
    for task in chosen:
        wanted = tasks[task]
        after = (ends.get(number_of[name], 0.0) for name in wanted.after)
        waits.release[task] = max(known.now, release_of(wanted), *after)
    for task in {*chosen, *begun}:
        for name, (least, most) in tasks[task].starts.items():
            other = number_of[name]
            if task in among and other in among:
                waits.gaps.append(Gap(task, other, least, most))
            elif task in among and other in begun:
                _keep(waits, task, begun[other] + least, begun[other] + most)
            elif task in begun and other in among:
                _keep(waits, other, begun[task] - most, begun[task] - least)
    for task, others in tasks_before(tasks).items():
        if task in among and (left := [other for other in others if other in among]):
            waits.before[task] = left
    for room in rooms_of(known.mission):
        inside, loads = room.tasks & among, room.loads & among
        if inside or loads:
            waits.rooms.append(RoomLeft(inside, room.room, room_taken(known, room), loads))
    return waits


def room_taken(known: Known, room: ZoneRoom) -> tuple[float, ...]:
    """Return until when there is less room in a zone by what is under way there, once for each."""
    until = {task: known.loading.get(task, end) for task, end in known.under_way}
    is_load = {task for task in until if known.mission.tasks[task].to is not None}
    served = room.tasks & until.keys() - (is_load - known.loading.keys())
    return tuple(until[task] for task in sorted(served | room.loads & known.unloading))


def _keep(waits: Waits, task: int, least: float, most: float) -> None:
    """Let a task start between two moments because of one that has begun."""
    waits.release[task] = max(waits.release[task], least)
    waits.latest[task] = min(waits.latest[task], most)
