"""Tasks that appear at random: what they may be, and those of one truth."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from teamformer.base.errors import TeamformerError
from teamformer.mission.model import Mission, Task, as_believed
from teamformer.mission.parts.capabilities import covers, total
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.places import busiest_part
from teamformer.mission.parts.plane import Plane
from teamformer.mission.parts.reach import can_reach, totals_by_region
from teamformer.mission.parts.roads import Roads

MOST_DRAWS = 1000
"""So often a task is drawn again that nobody can do with a full battery."""

MILLIMETRES = 1000
"""In a metre: places on a plane are drawn to one of them, as random missions have them."""


def draw_arrivals(mission: Mission, rng: np.random.Generator) -> tuple[Task, ...]:
    """Return the tasks that appear by the arrivals of a mission, in the order in which they do.

    None if it has none, or if it holds them already. All lie in the connected part of the map in
    which most robots start, and need only what robots that start there bring.
    """
    arrivals = mission.arrivals
    if arrivals is None or any(task.has_arrived for task in mission.tasks):
        return ()
    part = busiest_part(mission)
    caps, names = capabilities_in(mission, part), _free_names(mission)
    drawn = []
    for step in range(1, arrivals.until + 1):
        if rng.random() < arrivals.rate:
            task = _draw_task(mission, caps, part, rng)
            if step > arrivals.since:  # those before are drawn, so that the others stay the same
                drawn.append(replace(task, name=next(names), appears=step))
    return tuple(drawn)


def _draw_task(mission: Mission, caps: list[str], part: int, rng: np.random.Generator) -> Task:
    """Return a task that appears; where robots have batteries, one that they can do from full."""
    arrivals = mission.arrivals
    assert arrivals is not None, "tasks appear"
    for _ in range(MOST_DRAWS):
        place = _draw_place(mission, part, rng)
        most = min(arrivals.most_needs or len(caps), len(caps))
        chosen = rng.permutation(len(caps))[: rng.integers(1, most + 1)]
        needs = {caps[cap]: 1 for cap in sorted(chosen.tolist())}
        task = Task("", place, needs, arrivals.duration, has_arrived=True)
        if _is_in_reach(mission, task):
            return task
    raise TeamformerError(
        f"{mission.name}: hardly anywhere tasks can appear that robots can do with full batteries",
        "put chargers nearer to one another, or give batteries that last longer",
    )


def _is_in_reach(mission: Mission, task: Task) -> bool:
    """Say whether those with batteries that are able for a task bring what it needs.

    In steps, where teams walk as one, whether all are that get there.
    """
    charging = as_believed(mission, tasks=(task,)).charging
    if charging is None:
        return True
    robots = range(len(mission.robots))
    if mission.time == "steps":
        there = (r for r in robots if can_reach(mission.world, mission.robots[r], task.at))
        return all(charging.is_able(robot, 0) for robot in there)
    able = charging.able(robots, 0)
    return covers(total(mission.robots[robot].can for robot in able), task.needs)


def once_appeared(mission: Mission, truth: Mission, steps: float) -> Mission:
    """Return a mission in which what has appeared by a truth is known, as tasks like others.

    More appear as they would have.
    """
    if mission.arrivals is None:
        return mission
    arrived = truth.tasks[len(mission.tasks) :]
    known = tuple(replace(task, has_arrived=False) for task in arrived if task.appears <= steps)
    arrivals = replace(mission.arrivals, since=max(mission.arrivals.since, int(steps)))
    return replace(mission, arrivals=arrivals, tasks=(*mission.tasks, *known))


def with_arrivals(mission: Mission, truth: Mission) -> Mission:
    """Return a mission with the tasks that appear in it by a truth, as tasks that are late."""
    if mission.arrivals is None or len(mission.tasks) == len(truth.tasks):
        return mission
    return replace(mission, tasks=(*mission.tasks, *truth.tasks[len(mission.tasks) :]))


def without_arrivals(mission: Mission) -> Mission:
    """Return a mission as its file has it, without the tasks that appear in it by a truth."""
    if mission.arrivals is None:
        return mission
    return replace(mission, tasks=tuple(t for t in mission.tasks if not t.has_arrived))


def capabilities_in(mission: Mission, part: int) -> list[str]:
    """Return what the robots that start in a part of the map bring, at least one of it."""
    have = totals_by_region(mission.world, mission.robots)[part]
    return [cap for cap in mission.capabilities if have.get(cap, 0) >= 1]


def most_tasks(mission: Mission) -> int:
    """Return how many tasks there may be in the end."""
    arrivals = mission.arrivals
    return len(mission.tasks) + (max(0, arrivals.until - arrivals.since) if arrivals else 0)


def _free_names(mission: Mission) -> Iterator[str]:
    taken = {task.name for task in mission.tasks}
    names = (f"call-{number}" for number in itertools.count(1))
    return (name for name in names if name not in taken)


def _draw_place(mission: Mission, part: int, rng: np.random.Generator) -> Place:
    """Return any free place of a part of the map, each as likely as any other."""
    world = mission.world
    if isinstance(world, Plane):
        x, y = (np.floor(rng.uniform(0, world.corner) * MILLIMETRES) / MILLIMETRES).tolist()
        return x, y
    if isinstance(world, Roads):
        return float(rng.choice(_places_for_all(mission, world))), 0
    while True:
        x, y = rng.integers(0, (world.width, world.height)).tolist()
        if world.is_free((x, y)) and world.region((x, y)) == part:
            return x, y


def _places_for_all(mission: Mission, world: Roads) -> list[int]:
    """Return the places that all robots get to; all places if there are none."""
    every, robots = range(len(world.places)), mission.robots
    return [n for n in every if all(can_reach(world, r, (n, 0)) for r in robots)] or [*every]
