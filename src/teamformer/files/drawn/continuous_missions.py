"""Families of missions in continuous time: `roads`, `clock`, `shifts`, `optional`, `charging`,
`zones`.

All have order; those of `roads`, on the lanes of sites, and of `clock` have windows and loads, too.
Those of `clock` are on a plane and have linked starts, forming, ways home, tasks that appear and a
cost. Robots of `shifts` work in shifts with breaks. Most tasks of `optional` may be left out.
Robots of `charging` have batteries. Those of `zones` find little room in some places.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from teamformer.base.errors import MissionError, TeamformerError
from teamformer.files.drawn.continuous_incidents import INCIDENTS, robots_to_spare
from teamformer.files.drawn.site_graphs import CART, draw_hospital, draw_warehouse
from teamformer.mission.checks.optional import find_hopeless_until
from teamformer.mission.checks.windows import find_hopeless_windows, release_of
from teamformer.mission.model import Mission, Robot, Task, World
from teamformer.mission.parts.capabilities import covers, total
from teamformer.mission.parts.charging import Battery, Charger
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.plane import Plane
from teamformer.mission.parts.roads import GROUND
from teamformer.mission.parts.shifts import Shift
from teamformer.mission.parts.zones import Zone

ROUNDED = 0.05
"""By so much a time with one place after the point may be too short."""

CAPABILITIES = ("carry", "clean", "scan", "steer")
ROBOTS, TASKS = (6, 12), (15, 40)
"""How many there are, ends included."""

TWO_ABILITIES, TWO_NEEDS, TWICE = 0.4, 0.4, 0.2
"""Shares of robots that can two things, of tasks that need two, and of needs for two robots."""

SPEEDS = (1.0, 1.0, 0.5)
DURATION = (0.0, 30.0)

WIDTH, HEIGHT = 60.0, 40.0
"""Metres of the plane of `clock`."""

BEHIND, DUE, LINKED, LOADED, LATE = 0.25, 0.3, 0.15, 0.2, 0.15
"""Shares of the tasks: after others, with a window, linked, with a load, and that appear."""

OPENS, LASTS = (0.0, 90.0), (30.0, 300.0)
"""Seconds at which windows open, and for which they do besides the task itself."""


ROTAS: tuple[tuple[Shift, ...], ...] = (
    ((0, 100), (120, 220)),
    ((80, 160), (180, 280)),
    ((0, 280),),
    (),
)
"""The shifts of a robot: early, late, without a break, always."""

EVERY = 300.0
"""After how many seconds shifts come again."""


MUST, WEIGHTS, UNTIL = 2, (1.0, 1.0, 2.0, 3.0, 5.0), (80.0, 200.0)
"""Of `optional`: how many tasks must be done, what others weigh, and when the mission is over."""

LASTS_FOR, FILLS_IN, SERVING_SPENDS = (100.0, 200.0), (0.1, 0.3), (0.2, 0.5)
"""Metres that a battery lasts at speed 1, the share of that in which it fills, and what a second at
a task takes."""

WAITING_SPENDS, WITH_BATTERY = (0.0, 0.0, 0.05), 0.8
"""What a second of waiting takes, and the share of robots that have a battery."""

CHARGERS, CHARGER_ROOM = (3, 6), (1, 1, 2)
"""How many there are, ends included, and the room of one."""


ZONE_ROOM = (1, 1, 2, 3)
"""The room of an area."""


@dataclass(frozen=True)
class ContinuousFamily:
    """How missions of a family are drawn, and how large they are at most."""

    draw_any: Callable[[np.random.Generator, str], Mission]
    robots: int = ROBOTS[1]
    capabilities: int = len(CAPABILITIES)

    def draw(self, rng: np.random.Generator, name: str) -> Mission:
        """Return the first mission that can be done, without some robot too, and in its windows."""
        while True:
            try:
                mission = self.draw_any(rng, name)
            except MissionError:  # as where linked tasks want more robots than there are
                continue
            hopeless = (*find_hopeless_windows(mission), *find_hopeless_until(mission))
            if not hopeless and robots_to_spare(mission):
                return mission


def draw_on_roads(rng: np.random.Generator, name: str) -> Mission:
    """Return a mission of a hospital or of a warehouse; robots that carry may be carts."""
    graph = draw_hospital(rng) if rng.random() < 0.5 else draw_warehouse(rng)
    world = graph.roads()
    places = [world.at(place) for place in world.places]
    starts = [places[k] for k in rng.permutation(len(places))[:3].tolist()]
    robots = [
        replace(robot, moves=CART if "carry" in robot.can and rng.random() < 0.5 else GROUND)
        for robot in _draw_robots(rng, starts)
    ]
    tasks = _draw_tasks(rng, robots, places)
    tasks = [_with_load(rng, task, lambda: places[_below(rng, places)]) for task in tasks]
    tasks = _with_windows(rng, _in_order(rng, tasks))
    return _mission(name, world, robots, tasks)


def draw_by_the_clock(rng: np.random.Generator, name: str) -> Mission:
    """Return a mission with every key that plans in continuous time know."""
    world = Plane(WIDTH, HEIGHT)
    starts = [_spot(rng) for _ in range(2)]
    robots = _draw_robots(rng, starts)
    tasks = _draw_tasks(rng, robots, [_spot(rng) for _ in range(TASKS[1])])
    tasks = [_with_load(rng, task, lambda: _spot(rng)) for task in tasks]
    tasks = _linked(rng, tasks, total(robot.can for robot in robots))
    tasks = _with_windows(rng, _in_order(rng, tasks))
    tasks, more = _some_late(rng, tasks), _forming_and_ends(rng)
    cost = {"makespan": 1.0, "tardiness": 2.0, "travel": 0.05}
    more["cost"] = cost if rng.random() < 0.5 else None
    return _mission(name, world, robots, tasks, **more)


def draw_in_shifts(rng: np.random.Generator, name: str) -> Mission:
    """Return a mission of robots that work in shifts."""
    starts = [_spot(rng) for _ in range(2)]
    robots = [_in_a_shift(rng, robot) for robot in _draw_robots(rng, starts)]
    tasks = _draw_tasks(rng, robots, [_spot(rng) for _ in range(TASKS[1])])
    tasks = _with_windows(rng, _in_order(rng, tasks))
    ends = "home" if rng.random() < 0.5 else None
    mission = _mission(name, Plane(WIDTH, HEIGHT), robots, tasks)
    return replace(mission, forming=float(rng.integers(0, 5)), ends=ends)


def _in_a_shift(rng: np.random.Generator, robot: Robot) -> Robot:
    shifts = ROTAS[int(rng.integers(len(ROTAS)))]
    return replace(robot, shifts=shifts, every=EVERY if shifts else 0.0)


def draw_optional(rng: np.random.Generator, name: str) -> Mission:
    """Return a mission that is over before everything can be done; the first tasks must be."""
    starts = [_spot(rng) for _ in range(2)]
    robots = _draw_robots(rng, starts)
    tasks = _draw_tasks(rng, robots, [_spot(rng) for _ in range(TASKS[1])])
    weights = rng.choice(WEIGHTS, len(tasks)).tolist()
    tasks = [
        replace(task, optional=number >= MUST, weight=weights[number] if number >= MUST else 1)
        for number, task in enumerate(tasks)
    ]
    tasks = _with_windows(rng, _in_order(rng, tasks))
    until = max(float(rng.uniform(*UNTIL)), _when_done(robots, tasks[:MUST]))
    more: dict[str, Any] = {
        "until": round(until, 1),
        "ends": "home" if rng.random() < 0.5 else None,
        "cost": {"makespan": 1.0, "missed": 20.0} if rng.random() < 0.5 else None,
    }
    return _mission(name, Plane(WIDTH, HEIGHT), robots, tasks, **more)


def _when_done(robots: Sequence[Robot], tasks: Sequence[Task]) -> float:
    """Return when tasks of a plane are done at the earliest if their robots go there at once."""
    ends: dict[str, float] = {}
    for task in tasks:
        comes = sorted((math.dist(it.at, task.at) / it.speed, n) for n, it in enumerate(robots))
        there = next(
            at
            for number, (at, _) in enumerate(comes, start=1)
            if covers(total(robots[n].can for _, n in comes[:number]), task.needs)
        )
        begins = max([there, release_of(task), *(ends[name] for name in task.after)])
        ends[task.name] = begins + task.duration
    return max(ends.values()) + ROUNDED


def draw_charging(rng: np.random.Generator, name: str) -> Mission:
    """Return a mission of robots with batteries, and chargers; some tasks come after others."""
    starts = [_spot(rng) for _ in range(2)]
    robots = [_with_battery(rng, robot) for robot in _draw_robots(rng, starts)]
    tasks = _draw_tasks(rng, robots, [_spot(rng) for _ in range(TASKS[1])])
    tasks = _some_late(rng, _in_order(rng, tasks))
    number = int(rng.integers(CHARGERS[0], CHARGERS[1] + 1))
    chargers = tuple(Charger(_spot(rng), int(rng.choice(CHARGER_ROOM))) for _ in range(number))
    more = _forming_and_ends(rng) | {"chargers": chargers}
    return _mission(name, Plane(WIDTH, HEIGHT), robots, tasks, **more)


def draw_zones(rng: np.random.Generator, name: str) -> Mission:
    """Return a mission with an area in which few services go on at once, and some such tasks."""
    starts = [_spot(rng) for _ in range(2)]
    robots = _draw_robots(rng, starts)
    tasks = _draw_tasks(rng, robots, [_spot(rng) for _ in range(TASKS[1])])
    tasks = _with_windows(rng, _in_order(rng, tasks))
    drawn = rng.permutation(len(tasks))[: len(tasks) // 4].tolist()
    yard = Zone("yard", area=_area(rng), room=int(rng.choice(ZONE_ROOM)))
    tool = Zone("tool", tasks=tuple(tasks[k].name for k in sorted(drawn)))
    more = _forming_and_ends(rng)
    more["zones"] = (tool, yard) if rng.random() < 0.5 else (yard,)
    return _mission(name, Plane(WIDTH, HEIGHT), robots, tasks, **more)


def _area(rng: np.random.Generator) -> tuple[Place, Place]:
    """Return two corners of an area a third to two thirds as wide and as high as the plane."""
    sides = [round(side * float(rng.uniform(1 / 3, 2 / 3)), 1) for side in (WIDTH, HEIGHT)]
    x, y = (round(float(rng.uniform(0, whole - side)), 1)
            for whole, side in zip((WIDTH, HEIGHT), sides, strict=True))  # fmt: skip
    return (x, y), (round(x + sides[0], 1), round(y + sides[1], 1))


def _with_battery(rng: np.random.Generator, robot: Robot) -> Robot:
    if rng.random() >= WITH_BATTERY:
        return robot
    lasts = round(float(rng.uniform(*LASTS_FOR)) / robot.speed)
    battery = Battery(
        lasts=lasts,
        fills=round(lasts * float(rng.uniform(*FILLS_IN)), 1),
        starts=round(float(rng.uniform(0.5, 1)), 2),
        serving=round(float(rng.uniform(*SERVING_SPENDS)), 2),
        waiting=float(rng.choice(WAITING_SPENDS)),
    )
    return replace(robot, battery=battery)


CONTINUOUS_FAMILIES = {
    "roads": ContinuousFamily(draw_on_roads),
    "clock": ContinuousFamily(draw_by_the_clock),
    "shifts": ContinuousFamily(draw_in_shifts),
    "optional": ContinuousFamily(draw_optional),
    "charging": ContinuousFamily(draw_charging),
    "zones": ContinuousFamily(draw_zones),
}


def split_continuous(setting: str) -> tuple[str, str | None] | None:
    """Return the family and the incident that a setting such as `roads-lost` names, if it does."""
    name, _, incident = setting.partition("-")
    if name not in CONTINUOUS_FAMILIES:
        return None
    if incident and incident not in INCIDENTS:
        known = ", ".join([name, *(f"{name}-{one}" for one in INCIDENTS)])
        raise TeamformerError(f"'{setting}' is no setting", f"of this family there are {known}")
    return name, incident or None


def _mission(
    name: str, world: World, robots: Sequence[Robot], tasks: Sequence[Task], **more: Any
) -> Mission:
    made = (tuple(robots), tuple(tasks))
    return Mission(name, world, CAPABILITIES, *made, time="continuous", **more)


def _forming_and_ends(rng: np.random.Generator) -> dict[str, Any]:
    return {
        "forming": float(rng.integers(0, 5)),
        "ends": "home" if rng.random() < 0.5 else None,
    }


def _spot(rng: np.random.Generator) -> Place:
    return round(float(rng.uniform(0, WIDTH)), 1), round(float(rng.uniform(0, HEIGHT)), 1)


def _draw_robots(rng: np.random.Generator, starts: Sequence[Place]) -> list[Robot]:
    """Return robots; every capability is dealt out once before any is again."""
    robots, deck = [], list[str]()
    for number in range(int(rng.integers(ROBOTS[0], ROBOTS[1] + 1))):
        can: list[str] = []
        while len(can) < 1 + (rng.random() < TWO_ABILITIES):
            deck = deck or rng.permutation(CAPABILITIES).tolist()
            cap = deck.pop()
            can += [cap] if cap not in can else []
        at, speed = starts[int(rng.integers(len(starts)))], float(rng.choice(SPEEDS))
        robots.append(
            Robot(f"r{number}", at, {cap: 1 for cap in CAPABILITIES if cap in can}, speed)
        )
    return robots


def _draw_tasks(
    rng: np.random.Generator, robots: Sequence[Robot], places: Sequence[Place]
) -> list[Task]:
    have, tasks = total(robot.can for robot in robots), []
    for number in range(int(rng.integers(TASKS[0], TASKS[1] + 1))):
        chosen = rng.permutation(sorted(have))[: 1 + (rng.random() < TWO_NEEDS)].tolist()
        needs = {c: 2 if have[c] > 1 and rng.random() < TWICE else 1 for c in sorted(chosen)}
        at, takes = places[int(rng.integers(len(places)))], float(rng.uniform(*DURATION))
        tasks.append(Task(f"t{number}", at, needs, round(takes, 1)))
    return tasks


def _in_order(rng: np.random.Generator, tasks: Sequence[Task]) -> list[Task]:
    """Let some tasks come after an earlier one that they are not linked with."""
    ordered = list(tasks)
    for number in range(1, len(tasks)):
        other = tasks[int(rng.integers(number))]
        is_linked = tasks[number].starts or any(other.name in task.starts for task in tasks)
        if rng.random() < BEHIND and not is_linked and not other.starts:
            ordered[number] = replace(tasks[number], after=(other.name,))
    return ordered


def _some_late(rng: np.random.Generator, tasks: Sequence[Task]) -> list[Task]:
    """Let some tasks appear later."""
    late = [replace(task, appears=int(rng.integers(1, 90))) for task in tasks]
    return [late[n] if rng.random() < LATE else task for n, task in enumerate(tasks)]


def _with_windows(rng: np.random.Generator, tasks: Sequence[Task]) -> list[Task]:
    """Give some tasks that are neither linked nor after others a window."""
    changed = []
    for task in tasks:
        begin, length = round(float(rng.uniform(*OPENS)), 1), float(rng.uniform(*LASTS))
        is_due = rng.random() < DUE and not task.after
        between = (begin, round(begin + task.duration + task.unload + length, 1))
        changed.append(replace(task, between=between) if is_due else task)
    return changed


def _with_load(rng: np.random.Generator, task: Task, draw_place: Callable[[], Place]) -> Task:
    if "carry" not in task.needs or rng.random() >= LOADED / TWO_NEEDS:
        return task
    return replace(task, to=draw_place(), unload=round(float(rng.uniform(0, 10)), 1))


def _below(rng: np.random.Generator, choices: Sequence[object]) -> int:
    return int(rng.integers(len(choices)))


def _linked(
    rng: np.random.Generator, tasks: Sequence[Task], have: Mapping[str, float]
) -> list[Task]:
    """Let some tasks start so long after the one before them, where robots suffice for both."""
    linked = list(tasks)
    for number in range(1, len(tasks), 2):
        one, other = tasks[number], tasks[number - 1]
        both = total([one.needs, other.needs])
        if all(have[cap] >= n for cap, n in both.items()) and rng.random() < 2 * LINKED:
            least = round(float(rng.uniform(0, 10)), 1)
            gap = (least, round(least + float(rng.uniform(0, 20)), 1))
            linked[number] = replace(one, starts={other.name: gap})
    return linked
