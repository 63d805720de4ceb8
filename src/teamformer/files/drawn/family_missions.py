"""Random missions of a family: its world, robots and tasks, and what may happen in them."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from teamformer.base.errors import MissionError
from teamformer.files.drawn.families import Amounts, Family
from teamformer.files.drawn.generate import random_places, spawn_places
from teamformer.files.drawn.surprises import SURPRISES, make_uncertain
from teamformer.mission.checks.windows import find_hopeless_windows
from teamformer.mission.model import Absence, Mission, Robot, Task, World
from teamformer.mission.parts.capabilities import exact, total
from teamformer.mission.parts.charging import Battery, Charger
from teamformer.mission.parts.grid import BLOCKED, FREE, Grid, Place
from teamformer.mission.parts.roads import AIR, GROUND
from teamformer.mission.parts.shifts import Shift
from teamformer.mission.parts.zones import Zone

SHELF = (4, 2)
"""Cells that a shelf of a warehouse takes; aisles two cells wide lie between shelves."""

AISLE = 2

INCIDENT_STEPS = (5, 60)
"""In which steps tasks appear, both included; a robot is lost in the first of them or later."""

TO_THE_NEXT = 0.75
"""Cells to the next task, by the root of the free cells that there are for each task."""

DUE = (0.4, 3.0)
"""When tasks are due, in steps that the mission would take if robots never waited
(`about_half_of`)."""

WEIGHTS = (1, 1, 1, 3, 5)
"""Of tasks, each as likely as any other, where there are due dates."""

ARRIVING = 5
"""A fifth of the tasks appear later."""

BEHIND, MOST_BEHIND, AMONG = 0.4, 2, 8
"""In an ordered mission this share of the tasks comes after others, each after `MOST_BEHIND` at
most. These are among the `AMONG` tasks that were drawn just before it."""


ROTAS: tuple[tuple[Shift, ...], ...] = (
    ((0, 34), (40, 74)),
    ((26, 54), (60, 94)),
    ((0, 94),),
    (),
)
"""The shifts of a robot: early, late, without a break, always."""

EVERY = 100
"""After how many steps shifts come again."""

WITH_BATTERY, BATTERY_LASTS, FILLS_IN, SERVING_SPENDS = 0.8, (40, 80), 0.2, 0.3
"""The share of robots with a battery, how long one lasts, in which share of that it fills, and what
serving takes. Where a task is too far from all chargers, all last longer."""

CHARGERS, CHARGER_ROOM = (3, 6), (1, 1, 2)
"""How many there are, ends included, and the room of one."""

ROOM = (1, 2, 3)
"""How many services go on in an area at once."""


def draw_mission(
    family: Family, rng: np.random.Generator, name: str, incident: str | None = None
) -> Mission:
    """Return a random mission; fleets in which nobody can be spared are drawn again.

    With `incident` "lost" one robot that the others can do without is lost at a random step, in the
    first half of the mission; with "arrivals" a fifth of the tasks appear at random steps; with
    "ordered" tasks come after others; with "shifts" most robots work in shifts; with
    "charging" most have batteries; with "zones" few services go on at once in an area; with one of
    `SURPRISES` not everything is known. The mission itself is the same.
    """
    spare: list[int] = []
    while not spare:
        mission, spare = _draw(family, rng, name)
    if incident is None:
        return mission
    if incident == "lost":
        return _lose_one(mission, spare, rng)
    if incident in SURPRISES:
        return make_uncertain(mission, incident, rng)
    return CHANGES[incident](mission, rng)


def _draw(family: Family, rng: np.random.Generator, name: str) -> tuple[Mission, list[int]]:
    """Return a mission and the robots that can be spared in it."""
    world = _draw_world(family, rng)
    robots = _draw_robots(family, world, rng)
    have = total(robot.can for robot in robots)
    tasks = _draw_tasks(family, world, have, rng)
    most = {cap: max(task.needs.get(cap, 0) for task in tasks) for cap in family.capabilities}
    spare = [
        number
        for number, robot in enumerate(robots)
        if all(have[cap] - amount >= most[cap] for cap, amount in robot.can.items())
    ]
    mission = Mission(
        name=name,
        world=world,
        capabilities=family.capabilities,
        robots=robots,
        tasks=tasks,
        sensing_radius=family.sensing_radius,
        cost=family.cost,
    )
    return (_with_due_dates(mission, family.due, rng) if family.due else mission), spare


def _with_due_dates(mission: Mission, share: float, rng: np.random.Generator) -> Mission:
    """Return a mission in which a share of the tasks is due, and tasks have weights."""
    steps, tasks = about_half_of(mission), []
    for task in mission.tasks:
        is_due, at = rng.random() < share, rng.uniform(*DUE)
        between = (0.0, float(task.duration + math.ceil(at * steps))) if is_due else None
        weight = float(rng.choice(WEIGHTS))
        tasks.append(replace(task, between=between, weight=weight))
    return replace(mission, tasks=tuple(tasks))


def _draw_world(family: Family, rng: np.random.Generator) -> Grid:
    """Return an empty grid, one with scattered blocked cells, or one with rows of shelves."""
    width = int(rng.integers(family.width[0], family.width[1] + 1))
    height = int(rng.integers(family.height[0], family.height[1] + 1))
    has_shelves = family.has_shelves and not (family.yards and rng.random() < family.yards)
    if not has_shelves and family.blocked == 0:
        return Grid(width, height)
    is_blocked = rng.random((height, width)) < family.blocked  # (height, width)
    if has_shelves:
        is_blocked |= _shelves(width, height)
    if family.walls[1] > 0:
        _build_walls(is_blocked, family, rng)
    return Grid(width, height, tuple("".join(np.where(row, BLOCKED, FREE)) for row in is_blocked))


def _shelves(width: int, height: int) -> NDArray[np.bool_]:
    """Return where shelves stand, (height, width): in rows, with aisles around each."""
    x = (np.arange(width) - AISLE) % (SHELF[0] + AISLE)
    y = (np.arange(height) - AISLE) % (SHELF[1] + AISLE)
    in_column = (x < SHELF[0]) & (np.arange(width) >= AISLE) & (np.arange(width) < width - AISLE)
    in_row = (y < SHELF[1]) & (np.arange(height) >= AISLE) & (np.arange(height) < height - AISLE)
    return in_row[:, None] & in_column[None, :]


def _build_walls(is_blocked: NDArray[np.bool_], family: Family, rng: np.random.Generator) -> None:
    """Build walls across the map, up or along, each with a gap that a later one may close."""
    height, width = is_blocked.shape
    for _ in range(int(rng.integers(family.walls[0], family.walls[1] + 1))):
        is_up = rng.random() < 0.5
        across, along = (width, height) if is_up else (height, width)
        place, gap = int(rng.integers(2, across - 2)), int(rng.integers(along))
        wall = is_blocked[:, place] if is_up else is_blocked[place]
        wall[:] = True
        wall[gap] = False


def _draw_robots(family: Family, world: Grid, rng: np.random.Generator) -> tuple[Robot, ...]:
    """Return robots near one another; first every capability is dealt out once, then again."""
    number = int(rng.integers(family.robots[0], family.robots[1] + 1))
    places = spawn_places(world, number, rng)
    deck: list[str] = []
    robots = []
    for robot, at in enumerate(places):
        size = 1 + int(rng.choice(len(family.abilities), p=family.abilities))
        can: list[str] = []
        while len(can) < size:
            if not deck:
                deck = rng.permutation(family.capabilities).tolist()
            cap = deck.pop()
            if cap not in can:
                can.append(cap)
        speed = 0.5 if rng.random() < family.slow else 1.0
        in_order = {cap: _brought(family, cap, rng) for cap in family.capabilities if cap in can}
        flies = not set(family.airborne).isdisjoint(can)
        robots.append(Robot(f"r{robot}", at, in_order, speed, moves=AIR if flies else GROUND))
    return tuple(robots)


def _draw_tasks(
    family: Family,
    world: Grid,
    have: Mapping[str, float],
    rng: np.random.Generator,
) -> tuple[Task, ...]:
    """Return tasks that need capabilities of which the fleet has enough."""
    present = [cap for cap in family.capabilities if cap in have]
    number = int(rng.integers(family.tasks[0], family.tasks[1] + 1))
    tasks = []
    docks = random_places(world, family.docks, rng) if family.docks else []
    for task, at in enumerate(random_places(world, number, rng)):
        size = min(1 + int(rng.choice(len(family.needs), p=family.needs)), len(present))
        chosen = rng.permutation(present)[:size].tolist()
        needs = {
            cap: _needed(family, cap, have[cap], rng)
            for cap in family.capabilities
            if cap in chosen
        }
        if family.airborne and needs.keys() <= set(family.airborne):
            at = _any_free_cell(world, rng)
        takes_time = rng.random() < family.serving
        duration = int(rng.integers(family.duration[0], family.duration[1] + 1))
        plain = Task(f"t{task}", at, needs, duration if takes_time else 0)
        tasks.append(_with_load(family, plain, docks, rng) if docks else plain)
    return tuple(tasks)


def _with_load(
    family: Family, task: Task, docks: Sequence[Place], rng: np.random.Generator
) -> Task:
    """Return a task as it is, or one of which a load is brought to some dock."""
    if rng.random() >= family.carried or not family.amounts.keys() & task.needs.keys():
        return task
    dock = docks[int(rng.integers(len(docks)))]
    return replace(task, to=dock, unload=int(rng.integers(family.unload[0], family.unload[1] + 1)))


def _any_free_cell(world: Grid, rng: np.random.Generator) -> Place:
    """Return a free cell, be it one that no way on the ground leads to."""
    while True:
        x, y = rng.integers((world.width, world.height)).tolist()
        if world.is_free((x, y)):
            return x, y


def _brought(family: Family, cap: str, rng: np.random.Generator) -> float:
    """Return how much of a capability a robot brings that has it."""
    amounts = family.amounts.get(cap)
    if amounts is None:
        return 1
    return _in_steps(rng.uniform(*amounts.brought), amounts)


def _needed(family: Family, cap: str, have: float, rng: np.random.Generator) -> float:
    """Return how much of a capability a task needs, at most what the fleet has."""
    amounts = family.amounts.get(cap)
    if amounts is None:
        return 2 if have > 1 and rng.random() < family.twice else 1
    least, most = np.log(amounts.needed)
    return min(have, _in_steps(np.exp(rng.uniform(least, most)), amounts))


def _in_steps(amount: float, amounts: Amounts) -> float:
    return exact(round(amount / amounts.step) * amounts.step)


def _lose_one(mission: Mission, spare: list[int], rng: np.random.Generator) -> Mission:
    number = int(rng.choice(spare))
    robots = list(mission.robots)
    step = int(rng.integers(INCIDENT_STEPS[0], about_half_of(mission) + 1))
    robots[number] = replace(robots[number], absences=(Absence(step),))
    return replace(mission, robots=tuple(robots))


def about_half_of(mission: Mission) -> int:
    """Return a step in the first half of a mission, without a plan of it.

    It is the steps in which the robots that are wanted most would walk to their tasks and do them,
    if they never waited and all were as fast. In worlds 0 to 11 of each family these are 21% to 55%
    of the steps that the shared plan takes, and robots are lost after at most 44% of them.
    """
    assert isinstance(mission.world, Grid)
    rows, cells = mission.world.rows, mission.world.width * mission.world.height
    free = sum(row.count(FREE) for row in rows) if rows else cells
    way = TO_THE_NEXT * math.sqrt(free / len(mission.tasks))
    have = total(robot.can for robot in mission.robots)
    steps = [
        sum(task.needs.get(cap, 0) * (way + _takes(task)) for task in mission.tasks) / have[cap]
        for cap in have
    ]
    return max(INCIDENT_STEPS[0], int(max(steps)))


def _takes(task: Task) -> float:
    """Return the steps of a task, carried straight on."""
    if task.to is None:
        return task.duration
    (x, y), (to_x, to_y) = task.at, task.to
    return task.duration + abs(to_x - x) + abs(to_y - y) + task.unload


def _let_arrive(mission: Mission, rng: np.random.Generator) -> Mission:
    tasks = list(mission.tasks)
    for number in rng.permutation(len(tasks))[: len(tasks) // ARRIVING].tolist():
        tasks[number] = replace(tasks[number], appears=_draw_step(rng))
    return replace(mission, tasks=tuple(tasks))


def _put_in_order(mission: Mission, rng: np.random.Generator) -> Mission:
    """Let tasks come after others; they are drawn again if one cannot keep its window then."""
    names = [task.name for task in mission.tasks]
    while True:
        tasks, order = list(mission.tasks), rng.permutation(len(names)).tolist()
        for place, number in enumerate(order):
            if rng.random() >= BEHIND:
                continue
            among = order[max(0, place - AMONG) : place]
            most = min(len(among), int(rng.integers(1, MOST_BEHIND + 1)))
            before = sorted(rng.choice(among, most, replace=False).tolist()) if most else []
            tasks[number] = replace(tasks[number], after=tuple(names[k] for k in before))
        ordered = replace(mission, tasks=tuple(tasks))
        if not any(find_hopeless_windows(ordered)):
            return ordered


def _work_in_shifts(mission: Mission, rng: np.random.Generator) -> Mission:
    """Let robots work in shifts; they are drawn again if a task fits into none in common."""
    while True:
        drawn = rng.integers(len(ROTAS), size=len(mission.robots)).tolist()
        robots = tuple(
            replace(robot, shifts=ROTAS[rota], every=EVERY if ROTAS[rota] else 0)
            for robot, rota in zip(mission.robots, drawn, strict=True)
        )
        with suppress(MissionError):
            return replace(mission, robots=robots, step_limit=0)


def _give_batteries(mission: Mission, rng: np.random.Generator) -> Mission:
    """Put up chargers, and give most robots that walk batteries that suffice for all tasks."""
    places = [mission.tasks[k].at for k in rng.permutation(len(mission.tasks))]
    most = int(rng.integers(CHARGERS[0], CHARGERS[1] + 1))
    chargers = tuple(Charger(at, int(rng.choice(CHARGER_ROOM))) for at in places[:most])
    lasts = float(rng.integers(BATTERY_LASTS[0], BATTERY_LASTS[1] + 1))
    has_battery = rng.random(len(mission.robots)) < WITH_BATTERY
    while True:
        battery = Battery(lasts, fills=round(FILLS_IN * lasts), serving=SERVING_SPENDS)
        robots = tuple(
            replace(robot, battery=battery if has_one and not robot.flies else None)
            for robot, has_one in zip(mission.robots, has_battery, strict=True)
        )
        with suppress(MissionError):
            return replace(mission, robots=robots, chargers=chargers, step_limit=0)
        lasts += BATTERY_LASTS[0] / 4


def _share_zones(mission: Mission, rng: np.random.Generator) -> Mission:
    """Let few services go on at once in an area and, in half of the missions, of some tasks.

    Where there are loads, which are in no zone yet, tasks by name take the place of the area.
    """
    names = [task.name for task in mission.tasks if task.to is None]
    drawn: list[str] = rng.permutation(names).tolist()
    quarter = max(1, len(names) // 4)
    yard = Zone("yard", tasks=tuple(drawn[quarter : 3 * quarter]), room=int(rng.choice(ROOM)))
    tool = Zone("tool", tasks=tuple(drawn[:quarter]))
    has_both, has_loads = rng.random() < 0.5, len(names) < len(mission.tasks)
    while True:
        if not has_loads:
            yard = replace(yard, tasks=(), area=_area(mission.world, rng))
        zones = (tool, yard) if has_both else (yard,)
        with suppress(MissionError):
            return replace(mission, zones=zones, step_limit=0)


def _area(world: World, rng: np.random.Generator) -> tuple[Place, Place]:
    """Return two corners of an area a third to two thirds as wide and as high as a grid."""
    assert isinstance(world, Grid)
    ends = []
    for whole in (world.width, world.height):
        side = math.ceil(whole * rng.uniform(1 / 3, 2 / 3))
        begin = int(rng.integers(whole - side + 1))
        ends.append((begin, begin + side - 1))
    (left, right), (low, high) = ends
    return (left, low), (right, high)


def _draw_step(rng: np.random.Generator) -> int:
    return int(rng.integers(INCIDENT_STEPS[0], INCIDENT_STEPS[1] + 1))


CHANGES: Mapping[str, Callable[[Mission, np.random.Generator], Mission]] = {
    "arrivals": _let_arrive,
    "ordered": _put_in_order,
    "shifts": _work_in_shifts,
    "charging": _give_batteries,
    "zones": _share_zones,
}
"""What makes another mission of one, by ending of a setting's name."""
