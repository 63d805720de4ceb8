"""How a plan goes on if nothing happens: from when on linked tasks may begin."""

from __future__ import annotations

import math
from collections.abc import Hashable, Mapping, Sequence

from teamformer.mission.coordination import Known
from teamformer.mission.parts.charging import has_batteries
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.shifts import rotas_of
from teamformer.mission.parts.zones import has_loads_at_zones
from teamformer.world.continuous.ways import Ways
from teamformer.world.rules.charging.standing import charge_rules, stand_charged
from teamformer.world.rules.charging.times import time_charged
from teamformer.world.rules.starts import FIRST, LoadTimes, StartRules, Timed, time_tasks
from teamformer.world.rules.waits import waits_at


def foresee(
    known: Known, ways: Ways, order: Sequence[int], robots_of: Mapping[int, Sequence[int]]
) -> Timed:
    """Return when open tasks start if they are done in an order by their robots.

    Tasks before which robots wait for one another for ever start at no time (infinite).
    """
    tasks, robots = known.mission.tasks, known.mission.robots
    waits = waits_at(known, order)

    def place_after(robot: int, before: int) -> Place:
        if before == FIRST:
            return known.places[robot]
        to = tasks[before].to
        return tasks[before].at if to is None else to

    def way(robot: int, before: int, task: int) -> float:
        mover = robots[robot]
        return ways.length(place_after(robot, before), tasks[task].at, mover.moves) / mover.speed

    def site(robot: int, before: int) -> Place:
        return known.came_from[robot] if before == FIRST else place_after(robot, before)

    def takes(task: int, who: Sequence[int]) -> float:
        return tasks[task].duration + carried(task, who) + tasks[task].unload

    def carried(task: int, who: Sequence[int]) -> float:
        at, to, movers = tasks[task].at, tasks[task].to, [robots[robot] for robot in who]
        if to is None:
            return 0.0
        return max((ways.length(at, to, m.moves) / m.speed for m in movers), default=0.0)

    forming, rotas = known.mission.forming, rotas_of(robots)
    loads = [task for task in order if tasks[task].to is not None]
    rules = StartRules(
        way, site, takes, known.free_at, waits.release, waits.before, waits.gaps, forming, rotas,
        waits.rooms,
        LoadTimes(
            {task: tasks[task].duration for task in loads},
            {task: tasks[task].unload for task in loads},
            carried,
        ),
    )  # fmt: skip
    if not has_batteries(robots) and not has_loads_at_zones(known.mission):
        return time_tasks(rules, order, robots_of)

    def way_between(robot: int, here: Hashable, there: Hashable) -> float:
        assert isinstance(here, tuple), "places are pairs"
        assert isinstance(there, tuple), "places are pairs"
        return ways.length(here, there, robots[robot].moves) / robots[robot].speed

    standing = stand_charged(known, range(len(robots)), range(len(tasks)))
    charging = charge_rules(known.mission, way_between)
    return time_charged(rules, charging, standing, order, robots_of).timed


def holds_of(known: Known, timed: Timed) -> dict[int, float]:
    """Return from when on tasks may begin whose starts are linked; none where nothing settles."""
    tasks = known.mission.tasks
    linked = {task.name for task in tasks if task.starts}
    linked |= {name for task in tasks for name in task.starts}
    starts = timed.start.items()
    return {k: at for k, at in starts if tasks[k].name in linked and math.isfinite(at)}
