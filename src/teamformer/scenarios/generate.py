"""Random scenarios with the paper's distributions (Boehme and Hollinger, ICRA 2026, section V)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from teamformer.errors import TeamformerError
from teamformer.model import Grid, Place, Robot, Scenario, Task

SPAWN_RADIUS = 3
"""Robots start within so many cells of the spawn point, along each axis."""


@dataclass(frozen=True)
class Spec:
    """What to generate; the defaults are the paper's smallest test."""

    robots: int = 4
    tasks: int = 4
    capabilities: int = 4
    requirements: int | None = None  # for each task; None: 1 to |C|, uniformly
    world: Grid = field(default_factory=lambda: Grid(10, 10))
    late_tasks: int = 0  # tasks besides, that appear together
    late_between: tuple[int, int] = (10, 25)  # the steps in which they may, both included
    step_limit: int = 0
    new_tasks: str = "resolve"

    def __post_init__(self) -> None:
        least = {"robots": 1, "tasks": 1, "capabilities": 1, "late_tasks": 0}
        for name, minimum in least.items():
            if getattr(self, name) < minimum:
                raise TeamformerError(f"{name} is {getattr(self, name)}; use {minimum} or more")
        present = min(self.robots, self.capabilities)
        if self.requirements is not None and not 1 <= self.requirements <= present:
            raise TeamformerError(
                f"requirements is {self.requirements}; "
                f"{self.robots} robots with {self.capabilities} capabilities allow 1 to {present}"
            )


def generate(spec: Spec, rng: np.random.Generator, name: str = "generated") -> Scenario:
    """Return a random scenario; the same spec and generator state give the same one.

    Robots start alone around a random spawn point, capabilities are dealt out evenly, and task
    places are uniform. Each task draws its requirements from the capabilities present; the last
    takes every capability that no other requires.
    """
    free = _free_places(spec.world)
    dealt = _deal(spec.capabilities, spec.robots, rng)
    robots = tuple(
        Robot(f"r{number}", place, {cap: 1})
        for number, (place, cap) in enumerate(
            zip(_spawn(spec.world, free, spec.robots, rng), dealt, strict=True), start=1
        )
    )
    needs = _draw_needs(spec, sorted(set(dealt), key=_number), rng)
    appears = int(rng.integers(spec.late_between[0], spec.late_between[1] + 1))
    places = rng.integers(len(free), size=len(needs))
    tasks = tuple(
        Task(f"t{k + 1}", free[places[k]], need, appears=0 if k < spec.tasks else appears)
        for k, need in enumerate(needs)
    )
    return Scenario(
        name=name,
        world=spec.world,
        capabilities=_capability_names(spec.capabilities),
        robots=robots,
        tasks=tasks,
        step_limit=spec.step_limit,
        new_tasks=spec.new_tasks,
    )


def training_scenario(capabilities: int, rng: np.random.Generator) -> Scenario:
    """Return one of the paper's training worlds.

    Four robots with distinct capabilities, in random starting teams that each share a place, and
    one to four tasks, on 10 x 10 cells and for 128 steps.
    """
    count = min(4, capabilities)
    spec = Spec(count, int(rng.integers(1, 5)), capabilities, step_limit=128)
    scenario = generate(spec, rng, "training")
    labels = rng.integers(count, size=count)
    teams = [np.flatnonzero(labels == label).tolist() for label in sorted(set(labels.tolist()))]
    together = {robot: scenario.robots[team[0]].at for team in teams for robot in team}
    caps = rng.choice(capabilities, count, replace=False)
    robots = tuple(
        Robot(robot.name, together[r], {_capability(int(caps[r])): 1})
        for r, robot in enumerate(scenario.robots)
    )
    present = [_capability(int(c)) for c in sorted(caps.tolist())]
    needs = _draw_needs(spec, present, rng)
    tasks = tuple(
        Task(task.name, task.at, need) for task, need in zip(scenario.tasks, needs, strict=True)
    )
    return Scenario(
        name="training",
        world=scenario.world,
        capabilities=scenario.capabilities,
        robots=robots,
        tasks=tasks,
        teams=tuple(tuple(team) for team in teams),
        step_limit=128,
    )


def _capability(number: int) -> str:
    return f"c{number + 1}"


def _number(name: str) -> int:
    return int(name[1:])


def _capability_names(count: int) -> tuple[str, ...]:
    return tuple(_capability(number) for number in range(count))


def _free_places(world: Grid) -> list[Place]:
    """Return the free cells of the largest connected part of a map."""
    if not world.rows:
        return [(x, y) for y in range(world.height) for x in range(world.width)]
    sizes = Counter(world.regions.values())
    if not sizes:
        raise TeamformerError("the map has no free cell")
    largest = max(sizes, key=lambda region: (sizes[region], -region))
    return sorted(place for place, region in world.regions.items() if region == largest)


def _deal(capabilities: int, robots: int, rng: np.random.Generator) -> list[str]:
    """Return a capability for each robot, none more often than any other by more than one."""
    shuffled = rng.permutation(capabilities)
    return [_capability(int(shuffled[robot % capabilities])) for robot in range(robots)]


def _spawn(
    world: Grid, free: Sequence[Place], robots: int, rng: np.random.Generator
) -> list[Place]:
    """Return places within `SPAWN_RADIUS` of a random point; on maps, within as many steps."""
    x, y = free[rng.integers(len(free))]
    if world.rows:
        near = _within_steps(world, (x, y), SPAWN_RADIUS)
    else:
        near = [
            (to_x, to_y)
            for to_y in range(max(0, y - SPAWN_RADIUS), min(world.height, y + SPAWN_RADIUS + 1))
            for to_x in range(max(0, x - SPAWN_RADIUS), min(world.width, x + SPAWN_RADIUS + 1))
        ]
    return [near[i] for i in rng.integers(len(near), size=robots).tolist()]


def _within_steps(world: Grid, place: Place, steps: int) -> list[Place]:
    reached = {place}
    for _ in range(steps):
        reached |= {beside for cell in reached for beside in world.neighbours(cell)}
    return sorted(reached)


def _draw_needs(
    spec: Spec, present: Sequence[str], rng: np.random.Generator
) -> list[dict[str, int]]:
    """Return each task's requirements; the last task known at the start takes what is left over."""
    needs = []
    for _ in range(spec.tasks + spec.late_tasks):
        count = spec.requirements or int(rng.integers(1, len(present) + 1))
        chosen = rng.choice(len(present), count, replace=False)
        needs.append({present[i]: 1 for i in sorted(chosen.tolist())})
    required = {name for need in needs[: spec.tasks - 1] for name in need}
    left_over = {name: 1 for name in present if name not in required}
    last = needs[spec.tasks - 1]
    needs[spec.tasks - 1] = {name: 1 for name in present if name in last or name in left_over}
    return needs
