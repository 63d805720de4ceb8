"""Random worlds with everything in them, and random legal decisions."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from teamformer.base.errors import MissionError
from teamformer.mission.checks.windows import earliest_ends
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
from teamformer.mission.parts.capabilities import Counts
from teamformer.mission.parts.charging import Battery, Charger
from teamformer.mission.parts.grid import BLOCKED, FREE, Grid, Place
from teamformer.mission.parts.places import busiest_part
from teamformer.mission.parts.plane import Plane
from teamformer.mission.parts.reach import totals_by_region
from teamformer.mission.parts.zones import Zone
from teamformer.world.env import Decision
from teamformer.world.view import View


def random_world(
    rng: np.random.Generator,
    with_losses: bool = True,
    with_arrivals: bool = True,
    is_plane: bool = False,
) -> Mission:
    """Return a small possible world with walls, counts, durations, radii, late tasks, losses.

    On a plane some places are hardly more than the arrival radius apart, and some on its edges.
    """
    while True:
        try:
            return _draw(rng, with_losses, with_arrivals, is_plane)
        except MissionError:  # an island, or a task too hard: draw another
            continue


def with_fractions(mission: Mission, rng: np.random.Generator) -> Mission:
    """Return a mission in which counts are fractions, of robots, and of tasks finer ones still."""
    caps = mission.capabilities
    scale = {cap: int(rng.choice([500, 125, 2500, 333, 20_250])) for cap in caps}  # thousandths
    grain = {cap: int(rng.choice([0, 1, 50])) for cap in caps}

    def can(counts: Counts) -> Counts:
        return {
            cap: (int(count) * scale[cap] + grain[cap] * int(rng.integers(3))) / 1000
            for cap, count in counts.items()
        }

    def needs(counts: Counts) -> Counts:
        return {
            cap: (int(count) * scale[cap] - int(rng.integers(scale[cap]))) / 1000
            for cap, count in counts.items()
        }

    robots = tuple(replace(robot, can=can(robot.can)) for robot in mission.robots)
    tasks = tuple(replace(task, needs=needs(task.needs)) for task in mission.tasks)
    return replace(mission, robots=robots, tasks=tasks)


def with_surprises(mission: Mission, rng: np.random.Generator) -> Mission:
    """Return a mission of which not everything is known: durations, needs, breakdowns."""
    near = totals_by_region(mission.world, mission.robots)
    tasks: list[Task] = []
    for task in mission.tasks:
        lasts = None
        if rng.random() < 0.5:
            least = int(rng.integers(0, 4))
            lasts = (least, least + int(rng.integers(0, 7)))
        have, may = near[mission.world.region(task.at)], {}
        for cap in mission.capabilities:
            if rng.random() < 0.4 and have.get(cap, 0) >= task.needs.get(cap, 0) + 1:
                may[cap] = float(rng.choice([0.0, 0.3, 0.7, 1.0]))
        unit = mission.world.unit if isinstance(mission.world, Plane) else 1.0
        within = float(rng.choice([0.0, 0.0, 1.0, 2.5, 4.0])) * unit
        tasks.append(replace(task, lasts=lasts, may_need=may, within=within))
    robots = tuple(
        robot
        if robot.absences or rng.random() < 0.6
        else replace(robot, breaks=Breakdown(0.03, (1, 9) if rng.random() < 0.7 else None))
        for robot in mission.robots
    )
    delayed = rng.random(len(robots)) < 0.3
    robots = tuple(
        replace(robot, delays=Delays(float(rng.choice([0.1, 0.5])))) if is_delayed else robot
        for robot, is_delayed in zip(robots, delayed, strict=True)
    )
    arrivals = Arrivals(0.1, 20, duration=int(rng.integers(3)))
    can_appear = any(count >= 1 for count in near[busiest_part(mission)].values())
    rules = {
        "finding_radius": float(rng.choice([0.0, 0.2, 1.0, 1.5, np.inf])),
        "step_limit": 0,
        "arrivals": arrivals if rng.random() < 0.3 and can_appear else None,
    }
    return replace(mission, tasks=tuple(tasks), robots=robots, **rules)


def with_loads(mission: Mission, rng: np.random.Generator) -> Mission:
    """Return a mission in which most tasks are carried to where another thing is, or begins."""
    world, tasks = mission.world, list[Task]()
    places = [thing.at for thing in (*mission.tasks, *mission.robots)]
    for task in mission.tasks:
        near = [place for place in places if world.region(place) == world.region(task.at)]
        to = near[rng.integers(len(near))] if rng.random() < 0.7 else None
        unload = int(rng.choice([0, 0, 1, 3])) if to is not None else 0
        tasks.append(replace(task, to=to, unload=unload))
    return replace(mission, tasks=tuple(tasks), step_limit=0)


def with_precedence_and_windows(
    mission: Mission, rng: np.random.Generator, windows: float = 0.4
) -> Mission:
    """Return a mission in which some tasks come after others, and a share have windows."""
    tasks: list[Task] = []
    for task in mission.tasks:
        after = tuple(other.name for other in tasks if rng.random() < 0.3)
        begin, length = (int(n) for n in rng.integers(0, 25, size=2))
        between = (begin, begin + task.duration + length + 1) if rng.random() < windows else None
        tasks.append(replace(task, after=after, between=between))
    turned = rng.permutation(len(tasks))  # so that tasks come after later ones in the file, too
    return replace(mission, tasks=tuple(tasks[k] for k in turned), step_limit=0)


def with_optional(mission: Mission, rng: np.random.Generator) -> Mission:
    """Return a mission that is over at a time, in which about half of the tasks may be left out.

    What comes after such a task may be left out, too.
    """
    optional = {task.name for task in mission.tasks if rng.random() < 0.5}
    for _ in mission.tasks:
        optional |= {t.name for t in mission.tasks if not optional.isdisjoint(t.after)}
    tasks = tuple(
        replace(task, optional=task.name in optional, weight=float(rng.choice([1.0, 2.0, 0.5])))
        for task in mission.tasks
    )
    ends = earliest_ends(mission)
    least = max([0.0, *(end for name, end in ends.items() if name not in optional)])
    until = max(math.ceil(least), math.ceil(min(ends.values()))) + int(rng.integers(12))
    cost = {"makespan": 1.0, "missed": 20.0} if optional and rng.random() < 0.3 else None
    return replace(mission, tasks=tasks, until=until, cost=cost)


def with_batteries(mission: Mission, rng: np.random.Generator) -> Mission:
    """Return a mission whose robots have batteries that just do, most of them, and chargers."""
    world, places = mission.world, [thing.at for thing in (*mission.tasks, *mission.robots)]
    chargers = [
        Charger(places[k], int(rng.choice([1, 1, 2]))) for k in rng.permutation(len(places))
    ]
    parts = {world.region(robot.at) for robot in mission.robots}
    chargers = [c for c in chargers if world.region(c.at) in parts][: int(rng.integers(1, 4))]
    lasts = 2.0
    while True:
        own = tuple(
            replace(robot, battery=_battery(rng, lasts) if rng.random() < 0.8 else None)
            for robot in mission.robots
        )
        try:
            return replace(mission, robots=own, chargers=tuple(chargers), step_limit=0)
        except MissionError:
            lasts *= 1.3
            if lasts > 1e4:  # a part of the map has no charger
                raise


def _battery(rng: np.random.Generator, lasts: float) -> Battery:
    fills = float(rng.choice([0.0, 0.1, 0.37])) * lasts
    spends = float(rng.choice([0.0, 0.3])), float(rng.choice([0.0, 0.0, 0.2]))
    return Battery(lasts, fills, float(rng.choice([1.0, 0.6])), *spends)


def with_zones(mission: Mission, rng: np.random.Generator) -> Mission:
    """Return a mission with one or two zones, with room for one or two services each."""
    zones = []
    for name in ("dock", "gate")[: int(rng.integers(1, 3))]:
        tasks = tuple(task.name for task in mission.tasks if rng.random() < 0.7)
        if tasks:
            zones.append(Zone(name, tasks=tasks, room=int(rng.choice([1, 1, 2]))))
    return replace(mission, zones=tuple(zones))


def with_docks(mission: Mission, rng: np.random.Generator) -> Mission:
    """Return a mission with zones, some by area or place, to which loads are often brought."""
    mission = with_zones(mission, rng)
    goals = [task.to for task in mission.tasks if task.to is not None]
    goals += [task.at for task in mission.tasks]
    x, y = goals[0]
    reach = 1 + int(rng.integers(4))
    low, high = ((round(x + d, 3), round(y + d, 3)) for d in (-reach, reach))
    area = (low, high)
    places = tuple(goals[1 : 1 + int(rng.integers(1, 4))]) or (goals[0],)
    zones = [*mission.zones, Zone("hall", area=area, room=int(rng.choice([1, 2])))]
    zones.append(Zone("bay", places=tuple(dict.fromkeys(places))))
    return replace(mission, zones=tuple(sorted(zones, key=lambda zone: zone.name)))


def _absences(robot: int, lost: int | None, back: int | None) -> tuple[Absence, ...]:
    """Return when a robot is absent: every other one that is back is lost once more."""
    if lost is None:
        return ()
    if back is None or robot % 2 == 0:
        return (Absence(lost, back),)
    again = back + 1 + lost % 4
    return (Absence(lost, back), Absence(again, again + 1 + robot if lost % 3 else None))


def _draw(
    rng: np.random.Generator, with_losses: bool, with_arrivals: bool, is_plane: bool
) -> Mission:
    world: World = _plane(rng) if is_plane else _grid(rng)
    free = _points(world, rng) if isinstance(world, Plane) else _free_cells(world)
    caps = tuple(f"c{i}" for i in range(rng.integers(1, 5)))

    def counts() -> dict[str, int]:
        chosen = rng.choice(caps, rng.integers(1, min(3, len(caps)) + 1), replace=False)
        return {str(c): int(rng.choice([1, 1, 1, 2])) for c in chosen}

    def place() -> Place:
        return free[rng.integers(len(free))]

    home, robots = place(), []
    together = rng.random() < 0.6
    for r in range(rng.integers(1, 8)):
        lost = int(rng.integers(1, 30)) if with_losses and rng.random() < 0.1 else None
        back = None if lost is None or lost % 5 > 1 else lost + 1 + 5 * r % 11
        speed = float(rng.choice([1.0, 1.0, 1.0, 0.5, 0.3, 1.7]))
        robots.append(
            Robot(f"r{r}", home if together else place(), counts(), speed, _absences(r, lost, back))
        )
    tasks = []
    for k in range(rng.integers(1, 8)):
        appears = int(rng.integers(0, 20)) if with_arrivals and rng.random() < 0.3 else 0
        tasks.append(Task(f"t{k}", place(), counts(), int(rng.choice([0, 0, 0, 1, 3])), appears))
    sensing = float(rng.choice([0, 1, 1, 2.5, np.inf]))
    return Mission(
        "random",
        world,
        caps,
        tuple(robots),
        tuple(tasks),
        teams=_teams(rng, len(robots)) if together else (),
        sensing_radius=sensing,
        join_radius=float(min(sensing, rng.choice([0, 0, 1, 2.5]))),
        forming_steps=int(rng.integers(0, 2)),
    )


def _free_cells(grid: Grid) -> list[Place]:
    cells = ((x, y) for y in range(grid.height) for x in range(grid.width))
    return [cell for cell in cells if grid.is_free(cell)]


def _plane(rng: np.random.Generator) -> Plane:
    width, height = (float(side) for side in rng.uniform(0.3, 6.0, size=2).round(2))
    return Plane(
        width,
        height,
        step=float(rng.choice([1.0, 0.5, 0.2])),
        arrival_radius=float(rng.choice([0.05, 0.05, 0.2, 0.0])),
    )


def _points(plane: Plane, rng: np.random.Generator) -> list[Place]:
    """Return points anywhere, beside half of them one that is nearly in the same place, corners."""
    points = rng.uniform((0, 0), plane.corner, size=(8, 2))
    beside = points[:4] + rng.uniform(-1.2, 1.2, size=(4, 2)) * plane.arrival_radius
    inside = np.clip(np.concatenate([points, beside]), 0, plane.corner).round(3)
    inside[4:6, 0] = plane.width
    inside[5:7, 1] = plane.height
    return [(float(x), float(y)) for x, y in inside]


def _grid(rng: np.random.Generator) -> Grid:
    width, height = (int(n) for n in rng.integers(1, 8, size=2))
    if rng.random() < 0.5:
        return Grid(width, height)
    is_blocked = rng.random((height, width)) < 0.25
    is_blocked[rng.integers(height), rng.integers(width)] = False
    rows = tuple("".join(BLOCKED if cell else FREE for cell in row) for row in is_blocked)
    return Grid(width, height, rows)


def _teams(rng: np.random.Generator, robots: int) -> tuple[tuple[int, ...], ...]:
    labels = rng.integers(0, robots, size=robots)
    return tuple(tuple(np.flatnonzero(labels == label).tolist()) for label in set(labels.tolist()))


def random_decision(view: View, rng: np.random.Generator, eagerness: float = 0.3) -> Decision:
    """Return a random legal decision for each team: mostly maintain, else a split or a join."""
    wanted = view.counts.copy()
    for row in range(len(wanted)):
        if view.is_serving[row] or rng.random() > eagerness:
            continue
        joinable = np.flatnonzero(view.can_join[row])
        members = slice(view.first_member[row], view.first_member[row + 1])
        if len(joinable) and rng.random() < 0.6:
            wanted[row] += view.seen_counts[row, rng.choice(joinable)]
        elif view.size[row] > 1:
            stay = rng.random(view.size[row]) < 0.5
            stay[rng.integers(view.size[row])] = True
            if not stay.all():
                wanted[row] = view.member_counts[members][stay].sum(axis=0)
    return Decision(wanted)


def with_shifts(mission: Mission, rng: np.random.Generator) -> Mission:
    """Return a mission in which most robots work in one of two rotas, some with shifts that touch.

    Each shift has room for the longest task; a third of the rotas do not come again. Raises
    `MissionError` if robots that a task needs have no shift in common that is long enough.
    """
    longest = max(int(task.duration + task.unload) for task in mission.tasks) + 1
    rotas = []
    for _ in range(2):
        lasts = rng.integers(longest, longest + 9, size=2)
        begin, rest, after = (int(n) for n in rng.choice([0, 0, 1, 3, 7], size=3))
        shifts = ((begin, begin + int(lasts[0])),)
        if rng.random() < 0.6:
            again = shifts[0][1] + rest
            shifts = (*shifts, (again, again + int(lasts[1])))
        every = 0 if rng.random() < 0.33 else shifts[-1][1] - begin + after
        rotas.append((shifts, every))
    robots = []
    for robot in mission.robots:
        shifts, every = rotas[rng.integers(2)] if rng.random() < 0.8 else ((), 0)
        robots.append(replace(robot, shifts=shifts, every=every))
    return replace(mission, robots=tuple(robots), step_limit=0)
