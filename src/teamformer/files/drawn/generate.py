"""Random missions with the paper's distributions (Boehme and Hollinger, ICRA 2026, section V)."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from teamformer.base.errors import TeamformerError
from teamformer.mission.model import Mission, Robot, Task, World
from teamformer.mission.parts.grid import Grid, Place
from teamformer.mission.parts.plane import Plane

SPAWN_RADIUS = 3
"""Robots start within so many cells, on planes units, of the spawn point, along each axis."""

MILLIMETRES = 1000.0  # in a metre: places on planes are drawn in whole ones


@dataclass(frozen=True)
class Spec:
    """What to generate; the defaults are the paper's smallest test.

    Radii are in cells; on a plane in its units, of which robots walk one in a step.
    """

    robots: int = 4
    tasks: int = 4
    capabilities: int = 4
    requirements: int | None = None  # for each task; None: 1 to |C|, uniformly
    world: World = field(default_factory=lambda: Grid(10, 10))
    late_tasks: int = 0  # tasks besides, that appear together
    late_between: tuple[int, int] = (10, 25)  # the steps in which they may, both included
    step_limit: int = 0
    sensing_radius: float = 1.0
    join_radius: float = 0.0
    starts_in_teams: bool = False  # False: every robot starts alone

    def __post_init__(self) -> None:
        least = {"robots": 1, "tasks": 1, "capabilities": 1, "late_tasks": 0}
        for name, minimum in least.items():
            number = getattr(self, name)
            if not isinstance(number, int) or number < minimum:
                what = f"{name} is {number!r}; use a whole number, {minimum} or more"
                raise TeamformerError(what)
        if not isinstance(self.world, Grid | Plane):
            hint = "write tf.Grid(width, height) or tf.Plane(width, height)"
            raise TeamformerError(f"world is {self.world!r}", hint)
        present = min(self.robots, self.capabilities)
        if self.requirements is not None and not 1 <= self.requirements <= present:
            raise TeamformerError(
                f"requirements is {self.requirements}; "
                f"{self.robots} robots with {self.capabilities} capabilities allow 1 to {present}"
            )
        if not 0 <= self.late_between[0] <= self.late_between[1]:
            raise TeamformerError(f"late_between is {self.late_between}; use (first, last) step")


def generate(spec: Spec, rng: np.random.Generator, name: str = "generated") -> Mission:
    """Return a random mission; the same spec and generator state give the same one.

    Robots start around a random spawn point, capabilities are dealt out evenly, and task places
    are uniform; on maps all lie in the largest connected part.
    """
    world = spec.world
    unit, speed = (world.unit, world.unit / world.step) if isinstance(world, Plane) else (1.0, 1.0)
    caps = tuple(f"c{number}" for number in range(1, spec.capabilities + 1))
    dealt = _deal(spec, rng)
    labels = _draw_teams(spec, rng)
    places = spawn_places(spec.world, spec.robots, rng)
    robots = tuple(
        Robot(f"r{r + 1}", places[labels[r]], {caps[dealt[r]]: 1}, speed)
        for r in range(spec.robots)
    )
    return Mission(
        name=name,
        world=world,
        capabilities=caps,
        robots=robots,
        tasks=_draw_tasks(spec, [caps[c] for c in sorted(set(dealt))], rng),
        teams=_teams(labels),
        sensing_radius=spec.sensing_radius * unit,
        join_radius=spec.join_radius * unit,
        step_limit=spec.step_limit,
    )


def _deal(spec: Spec, rng: np.random.Generator) -> list[int]:
    """Return a capability for each robot, none more often than any other by more than one."""
    shuffled = rng.permutation(spec.capabilities)  # (caps,)
    dealt: list[int] = np.resize(shuffled, spec.robots).tolist()  # again from the start if short
    return dealt


def _draw_teams(spec: Spec, rng: np.random.Generator) -> list[int]:
    """Return a team's label for each robot, each robot's own unless they start in teams."""
    if not spec.starts_in_teams:
        return list(range(spec.robots))
    labels: list[int] = rng.integers(spec.robots, size=spec.robots).tolist()
    return labels


def _teams(labels: list[int]) -> tuple[tuple[int, ...], ...]:
    """Return the robots that share a label, without those that are alone."""
    members: dict[int, list[int]] = {}
    for robot, label in enumerate(labels):
        members.setdefault(label, []).append(robot)
    return tuple(tuple(team) for team in members.values() if len(team) > 1)


def spawn_places(world: World, robots: int, rng: np.random.Generator) -> list[Place]:
    """Return a place for each robot within `SPAWN_RADIUS` of a random point; on maps, of steps."""
    [(x, y)] = random_places(world, 1, rng)
    if isinstance(world, Plane):
        reach = SPAWN_RADIUS * world.unit
        return _random_points(
            (max(x - reach, 0.0), max(y - reach, 0.0)),
            (min(x + reach, world.width), min(y + reach, world.height)),
            robots,
            rng,
        )
    assert isinstance(world, Grid)
    if world.rows:
        near = _within_steps(world, (x, y), SPAWN_RADIUS)
        return [near[i] for i in rng.integers(len(near), size=robots).tolist()]
    low = np.maximum((x - SPAWN_RADIUS, y - SPAWN_RADIUS), 0)
    high = np.minimum((x + SPAWN_RADIUS + 1, y + SPAWN_RADIUS + 1), _size(world))
    return [(to_x, to_y) for to_x, to_y in rng.integers(low, high, (robots, 2)).tolist()]


def _random_points(low: Place, high: Place, count: int, rng: np.random.Generator) -> list[Place]:
    """Return uniformly random points between two corners, to a millimetre."""
    points = np.floor(rng.uniform(low, high, (count, 2)) * MILLIMETRES) / MILLIMETRES
    return [(x, y) for x, y in points.tolist()]


def random_places(world: World, count: int, rng: np.random.Generator) -> list[Place]:
    """Return uniformly random free places, all of them connected."""
    if isinstance(world, Plane):
        return _random_points((0.0, 0.0), world.corner, count, rng)
    assert isinstance(world, Grid)
    if not world.rows:
        return [(x, y) for x, y in rng.integers(0, _size(world), (count, 2)).tolist()]
    region = _largest_region(world)
    return [region[i] for i in rng.integers(len(region), size=count).tolist()]


def _size(world: Grid) -> tuple[int, int]:
    return world.width, world.height


@lru_cache(maxsize=8)
def _largest_region(world: Grid) -> tuple[Place, ...]:
    cells = tuple(world.regions.cells(world.regions.largest()))
    if not cells:
        raise TeamformerError("the map has no free cell", "use another map")
    return cells


def _within_steps(world: Grid, place: Place, steps: int) -> list[Place]:
    reached = {place}
    for _ in range(steps):
        reached |= {beside for cell in reached for beside in world.neighbours(cell)}
    return sorted(reached)


def _draw_tasks(spec: Spec, present: list[str], rng: np.random.Generator) -> tuple[Task, ...]:
    """Return the tasks, those that come late last; they need only capabilities present."""
    needs = _draw_needs(spec, len(present), rng)
    places = random_places(spec.world, len(needs), rng)
    first, last = spec.late_between
    late = int(rng.integers(first, last + 1)) if spec.late_tasks else 0
    return tuple(
        Task(
            f"t{k + 1}",
            places[k],
            {present[cap]: 1 for cap in sorted(needs[k])},
            appears=0 if k < spec.tasks else late,
        )
        for k in range(len(needs))
    )


def _draw_needs(spec: Spec, caps: int, rng: np.random.Generator) -> list[set[int]]:
    """Return the capabilities that each task requires.

    A fixed number of requirements is drawn from those that no earlier task requires, while there
    are such, as the authors' code does. What no other task known at the start requires, if
    anything, is what the last of them does.
    """
    count = spec.tasks + spec.late_tasks
    priority = rng.random((count, caps))  # (tasks, caps) the lowest are required
    if spec.requirements is None:
        sizes = rng.integers(1, caps + 1, count).tolist()
        drawn = [
            set(row[:size])
            for row, size in zip(priority.argsort(axis=1).tolist(), sizes, strict=True)
        ]
    else:
        drawn = []
        is_required = np.zeros(caps, dtype=np.bool_)
        for row in priority:
            chosen = (row + is_required).argsort()[: spec.requirements]
            is_required[chosen] = True
            drawn.append(set(chosen.tolist()))
    left_over = set(range(caps)).difference(*drawn[: spec.tasks - 1])
    if left_over:
        drawn[spec.tasks - 1] = left_over
    return drawn
