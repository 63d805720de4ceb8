"""Random missions in continuous time, with everything that can befall them, and random plans."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from teamformer.base.errors import MissionError
from teamformer.mission.coordination import IDLE, UNFORESEEN, Known, Plan
from teamformer.mission.model import (
    Absence,
    Arrivals,
    Breakdown,
    Delays,
    Mission,
    Robot,
    Task,
    World,
)
from teamformer.mission.parts.capabilities import covers, total
from teamformer.mission.parts.grid import Grid, Place
from teamformer.mission.parts.plane import Plane
from teamformer.mission.parts.roads import Roads

CAPS = ("a", "b", "c")


def draw_mission(seed: int) -> Mission:
    """Return a mission with rules, losses and surprises at random; every draw can be done."""
    for number in range(100):
        try:
            return _draw(np.random.default_rng([seed, number]))
        except MissionError:
            continue
    raise AssertionError(f"no mission with seed {seed} can be done")


def _draw(rng: np.random.Generator) -> Mission:
    world = draw_world(rng)
    robots = [_draw_robot(rng, world, number) for number in range(int(rng.integers(2, 6)))]
    tasks = [_draw_task(rng, world, number) for number in range(int(rng.integers(1, 9)))]
    if isinstance(world, Grid) and any(task.to for task in tasks):  # nobody flies with a load
        robots = [replace(robot, moves="ground") for robot in robots]
    for number in range(1, len(tasks)):
        before = tasks[int(rng.integers(number))].name
        what = rng.random()
        if what < 0.2:
            tasks[number] = replace(tasks[number], after=(before,))
        elif what < 0.4:
            least = float(rng.choice([0.0, 0.0, 2.0]))
            most = least + float(rng.choice([0.0, 1.0, 5.0]))
            tasks[number] = replace(tasks[number], starts={before: (least, most)})
    ends: Place | str | None = None if rng.random() < 0.3 else "home"
    arrivals = Arrivals(0.1, 20, 1, 2) if rng.random() < 0.2 else None
    return Mission(
        "drawn",
        world,
        CAPS,
        tuple(robots),
        tuple(tasks),
        time="continuous",
        ends=ends,
        forming=float(rng.choice([0.0, 0.0, 1.5])),
        cost=None if rng.random() < 0.7 else {"travel": 1.0, "tardiness": 2.0},
        arrivals=arrivals,
        step_limit=5000,
    )


def draw_world(rng: np.random.Generator) -> World:
    """Return roads with ways that differ by direction and mover, a grid with walls, or a plane."""
    kind = rng.random()
    if kind < 0.4:
        places = int(rng.integers(4, 9))
        tables = {}
        for mover in ("ground", "cart"):
            times = np.round(rng.uniform(1, 9, (places, places)), 3)
            times[rng.random((places, places)) < 0.4] = math.inf
            around = np.roll(np.arange(places), -1)
            times[np.arange(places), around] = np.round(rng.uniform(1, 4, places), 3)
            np.fill_diagonal(times, 0.0)
            tables[mover] = tuple(map(tuple, times.tolist()))
        return Roads(tuple(f"p{n}" for n in range(places)), tables)
    if kind < 0.7:
        return Grid(7, 5, (".......", "...@...", ".@.@.@.", "...@...", "......."))
    return Plane(20.0, 15.0)


def _draw_place(rng: np.random.Generator, world: World) -> Place:
    if isinstance(world, Roads):
        return int(rng.integers(len(world.places))), 0
    if isinstance(world, Plane):
        return round(float(rng.uniform(0, 20)), 3), round(float(rng.uniform(0, 15)), 3)
    while True:
        place = int(rng.integers(7)), int(rng.integers(5))
        if world.is_free(place):
            return place


def _draw_robot(rng: np.random.Generator, world: World, number: int) -> Robot:
    movers = ("ground", "cart") if isinstance(world, Roads) else ("ground", "ground", "air")
    can = {cap: int(rng.integers(1, 3)) for cap in CAPS if rng.random() < 0.7}
    what = rng.random()
    lost = float(np.round(rng.uniform(1, 20), 2))
    back = lost + float(np.round(rng.uniform(1, 20), 2))
    return Robot(
        f"r{number}",
        _draw_place(rng, world),
        can or {"a": 1},
        speed=float(rng.choice([0.5, 1.0, 1.0, 1.7])),
        absences=(Absence(lost, back if rng.random() < 0.7 else None),) if what < 0.3 else (),
        breaks=Breakdown(0.02, (2.0, 9.0)) if 0.3 <= what < 0.4 else None,
        delays=Delays(0.2) if rng.random() < 0.2 else None,
        moves=str(rng.choice(movers)),
    )


def _draw_task(rng: np.random.Generator, world: World, number: int) -> Task:
    needs = {cap: 1 for cap in CAPS if rng.random() < 0.4}
    begin = float(np.round(rng.uniform(0, 15), 2))
    is_load = rng.random() < 0.25
    task = Task(
        f"t{number}",
        _draw_place(rng, world),
        needs or {"a": 1},
        duration=float(np.round(rng.uniform(0, 4), 2)) if rng.random() < 0.8 else 0.0,
        appears=begin if rng.random() < 0.2 else 0.0,
        cancelled=begin + 5.5 if rng.random() < 0.1 else None,
        between=(begin, begin + 30.0) if rng.random() < 0.2 else None,
        to=_draw_place(rng, world) if is_load else None,
        unload=1.25 if is_load and rng.random() < 0.5 else 0.0,
        lasts=(1.0, 6.5) if rng.random() < 0.2 else None,
        may_need={"b": 0.5} if rng.random() < 0.2 else {},
    )
    if not is_load and rng.random() < 0.1:
        return replace(task, within=3.0)
    return task


class RandomPlans:
    """Plans any order and any able coalitions, anew at each news; now and then some tasks wait."""

    heeds = (*UNFORESEEN, "task done")

    def __init__(self, seed: int) -> None:
        self._seed = seed

    def update(self, known: Known, plan: Plan | None) -> Plan:
        """Return a plan at random."""
        rng = np.random.default_rng([self._seed, int(1000 * known.now), len(known.news)])
        order = rng.permutation(known.possible_tasks).tolist()
        return Plan(tuple(order), tuple(self._crew(rng, known, task) for task in order))

    def _crew(self, rng: np.random.Generator, known: Known, task: int) -> tuple[int, ...]:
        mission, crew = known.mission, list[int]()
        if IDLE not in known.news and rng.random() < 0.1:
            return ()
        for robot in rng.permutation(known.robots).tolist():
            there = mission.robots[robot]
            if not _can_reach(mission, known.places[robot], there, mission.tasks[task]):
                continue
            crew.append(robot)
            if covers(total(mission.robots[r].can for r in crew), mission.tasks[task].needs):
                return tuple(crew)
        return ()


def _can_reach(mission: Mission, place: Place, robot: Robot, task: Task) -> bool:
    """Say whether a robot gets to a task, and on with its load."""
    world = mission.world
    if not isinstance(world, Roads):
        return True
    is_there = world.leads(robot.moves, place, task.at)
    return is_there and (task.to is None or world.leads(robot.moves, task.at, task.to))
