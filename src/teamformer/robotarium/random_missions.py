"""Random missions for Robotarium: robots anywhere, tasks where a ring of robots has room."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.plane import Plane
from teamformer.robotarium.control.ring_slots import FROM_WALLS, ring_radius
from teamformer.robotarium.mission_checks import LEAST_APART, apart_needed
from teamformer.robotarium.robots.arena import HEIGHT, TICK, WIDTH

START_APART = LEAST_APART + 0.05  # metres
AISLE = 0.20  # metres between rings, more than needed
TRIES = 1000  # for a place, before all are drawn again

Point = tuple[float, float]


def random_mission(robots: int, tasks: int, capabilities: int, rng: np.random.Generator) -> Mission:
    """Return a mission with so many robots, each with one of the capabilities, dealt out evenly.

    Each task needs 2 to 5 different ones (fewer if there are fewer), the last one all that no
    other needs, as far as 5 go.
    """
    caps = tuple(f"c{number}" for number in range(1, capabilities + 1))
    dealt = rng.permutation([caps[r % capabilities] for r in range(robots)]).tolist()
    needs = [sorted(_draw_needs(caps[:robots], rng)) for _ in range(tasks)]
    starts, places = _draw_places(robots, [len(n) for n in needs], rng)
    return Mission(
        name=f"random, {robots} robots",
        world=Plane(WIDTH, HEIGHT, step=30 * TICK),
        capabilities=caps,
        robots=tuple(
            Robot(f"r{r + 1}", at, {dealt[r]: 1}, speed=0.13) for r, at in enumerate(starts)
        ),
        tasks=tuple(
            Task(f"t{k + 1}", at, dict.fromkeys(needs[k], 1)) for k, at in enumerate(places)
        ),
        sensing_radius=0.6,
        join_radius=0.4,
    )


def _draw_needs(caps: tuple[str, ...], rng: np.random.Generator) -> list[str]:
    count = int(rng.integers(min(2, len(caps)), min(5, len(caps)) + 1))
    return [str(name) for name in rng.choice(caps, count, replace=False)]


def _draw_places(
    robots: int, needed: list[int], rng: np.random.Generator
) -> tuple[list[Point], list[Point]]:
    """Return where robots start and where tasks are; draws again until all have room."""
    while True:
        tasks: list[Point] = []
        starts: list[Point] = []
        for k, count in enumerate(needed):
            apart = [apart_needed(count, other) + AISLE for other in needed[:k]]
            _add(tasks, ring_radius(count) + FROM_WALLS + AISLE / 2, apart, rng)
        for r in range(robots):
            _add(starts, 2 * FROM_WALLS, [START_APART] * r, rng)
        if len(tasks) == len(needed) and len(starts) == robots:
            return starts, tasks


def _add(places: list[Point], margin: float, apart: list[float], rng: np.random.Generator) -> None:
    """Add a place that is so far from walls and earlier places, if one is found."""
    if len(places) < len(apart):
        return  # an earlier one was not found
    is_free: Callable[[Point], bool] = lambda at: all(  # noqa: E731
        np.hypot(at[0] - x, at[1] - y) >= needed
        for (x, y), needed in zip(places, apart, strict=True)
    )
    for _ in range(TRIES):
        x, y = rng.uniform((margin, margin), (WIDTH - margin, HEIGHT - margin))
        at = (round(float(x), 3), round(float(y), 3))
        if is_free(at):
            places.append(at)
            return
