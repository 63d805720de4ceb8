"""Which worlds are trained on and which the checkpoint is selected on, by seeds kept apart."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from teamformer.files.drawn.generate import Spec, generate
from teamformer.mission.model import Mission
from teamformer.mission.parts.capabilities import Counts
from teamformer.mission.parts.grid import BLOCKED, FREE, Grid

TRAINING, SELECTION, FINAL = 0, 1, 2
"""First number of a seed: what is trained on, selected on and reported never meet."""


@dataclass(frozen=True)
class Mixture:
    """Where training worlds are drawn from; pairs are (least, most)."""

    robots: tuple[int, int] = (2, 14)
    capabilities: tuple[int, int] = (2, 8)
    tasks: tuple[int, int] = (1, 18)
    crowds: float = 0.05  # share of worlds with so many robots and few tasks instead:
    crowd_robots: tuple[int, int] = (16, 60)
    crowd_tasks: tuple[int, int] = (1, 6)
    grid: tuple[int, int] = (10, 20)
    more_robots: float = 0.6  # share of worlds with more robots than capabilities
    sparse: float = 0.5  # share of worlds whose tasks all require the same few capabilities:
    few: int = 3  # at most so many
    in_teams: float = 0.3  # share of worlds with random starting teams
    wide_sensing: float = 0.15  # share of worlds in which teams sense 5 cells instead of 1
    alike: float = 0.0  # share of worlds with half as many capabilities, robots being alike
    walls: float = 0.0  # share of worlds in which a fifth of the cells is blocked
    varied: float = 0.0  # share of worlds whose robots have speeds and whose tasks take time
    counted: float = 0.0  # share of worlds with robots that can do more and tasks that need more
    steps: int = 200  # a trial is cut off here

    @property
    def most_capabilities(self) -> int:
        """Return how many capabilities a world has at most; a crowd has up to one a robot."""
        return max(self.capabilities[1], self.crowd_robots[1] if self.crowds else 0)


def draw_world(mixture: Mixture, rng: np.random.Generator) -> Mission:
    """Return a random training world."""
    is_crowd = rng.random() < mixture.crowds
    robots, caps = _draw_crowd(mixture, rng) if is_crowd else _draw_fleet(mixture, rng)
    known = caps
    if rng.random() < mixture.alike:
        caps = max(1, min(robots, caps) // 2)
    grid = _draw_grid(mixture, rng)
    is_sparse = rng.random() < mixture.sparse
    spec = Spec(
        robots=robots,
        tasks=_between(mixture.crowd_tasks if is_crowd else mixture.tasks, rng),
        capabilities=caps,
        requirements=_between((1, min(mixture.few, robots, caps)), rng) if is_sparse else None,
        world=grid,
        step_limit=mixture.steps,
        sensing_radius=5.0 if rng.random() < mixture.wide_sensing else 1.0,
        starts_in_teams=bool(rng.random() < mixture.in_teams),
    )
    world = _among(known, generate(spec, rng, "training"), rng)
    if rng.random() < mixture.varied:
        world = _with_speeds_and_durations(world, rng)
    if rng.random() < mixture.counted:
        world = _with_counts(world, rng)
    return world


def _draw_grid(mixture: Mixture, rng: np.random.Generator) -> Grid:
    """Return an empty square, or one with a fifth of its cells blocked."""
    side = _between(mixture.grid, rng)
    if rng.random() >= mixture.walls:
        return Grid(side, side)
    is_blocked = rng.random((side, side)) < 0.2
    is_blocked[0, 0] &= not is_blocked.all()  # a map has a free cell
    return Grid(
        side, side, tuple("".join(BLOCKED if b else FREE for b in row) for row in is_blocked)
    )


def _with_speeds_and_durations(world: Mission, rng: np.random.Generator) -> Mission:
    """Return the world with some slower robots and some tasks that take up to four steps."""
    robots = tuple(replace(r, speed=float(rng.choice([1.0, 1.0, 0.8, 0.5]))) for r in world.robots)
    tasks = tuple(replace(t, duration=int(rng.choice([0, 0, 1, 2, 4]))) for t in world.tasks)
    return replace(world, robots=robots, tasks=tasks)


def _with_counts(world: Mission, rng: np.random.Generator) -> Mission:
    """Return the world with a second capability for some robots and some needs of two."""
    robots = tuple(
        replace(r, can={**r.can, str(rng.choice(world.capabilities)): 1})
        if rng.random() < 0.3
        else r
        for r in world.robots
    )
    have = {cap: sum(r.can.get(cap, 0) for r in robots) for cap in world.capabilities}

    def counted(needs: Counts) -> dict[str, float]:
        return {cap: 2 if have[cap] > 1 and rng.random() < 0.4 else 1 for cap in needs}

    tasks = tuple(replace(task, needs=counted(task.needs)) for task in world.tasks)
    return replace(world, robots=robots, tasks=tasks)


def _among(known: int, world: Mission, rng: np.random.Generator) -> Mission:
    """Return a world with its capabilities at random places among so many."""
    if known == len(world.capabilities):
        return world
    names = tuple(f"c{number}" for number in range(1, known + 1))
    places = sorted(rng.choice(known, len(world.capabilities), replace=False).tolist())
    name_of = {old: names[place] for old, place in zip(world.capabilities, places, strict=True)}

    def renamed(counts: Counts) -> dict[str, float]:
        return {name_of[name]: count for name, count in counts.items()}

    return replace(
        world,
        capabilities=names,
        robots=tuple(replace(robot, can=renamed(robot.can)) for robot in world.robots),
        tasks=tuple(replace(task, needs=renamed(task.needs)) for task in world.tasks),
    )


def _draw_fleet(mixture: Mixture, rng: np.random.Generator) -> tuple[int, int]:
    """Return how many robots and capabilities a world has."""
    caps = _between(mixture.capabilities, rng)
    least, most = mixture.robots
    if rng.random() < mixture.more_robots:
        least = min(caps + 1, most)
    return _between((least, most), rng), caps


def _draw_crowd(mixture: Mixture, rng: np.random.Generator) -> tuple[int, int]:
    """Return many robots, and half as many capabilities up to as many."""
    robots = _between(mixture.crowd_robots, rng)
    return robots, _between((max(1, robots // 2), robots), rng)


def training_worlds(mixture: Mixture, count: int, seed: tuple[int, ...]) -> list[Mission]:
    """Return the worlds that a seed stands for; they depend on nothing but the arguments."""
    rng = np.random.default_rng([TRAINING, *seed])
    return [draw_world(mixture, rng) for _ in range(count)]


ANY_MIXTURE = Mixture(
    robots=(2, 24), tasks=(1, 24), crowds=0.2, walls=0.15, varied=0.2, counted=0.3
)
"""What the policy for any fleet is trained on."""

ANY_SELECTION = (
    Spec(4, 4, 4, step_limit=600),
    Spec(4, 20, 4, step_limit=600),
    Spec(8, 20, 8, step_limit=600),
    Spec(16, 60, 4, world=Grid(20, 20), step_limit=600),
    Spec(24, 60, 8, world=Grid(20, 20), step_limit=600),
    Spec(50, 20, 50, requirements=5, world=Grid(20, 20), step_limit=600),
    Spec(60, 10, 60, requirements=30, world=Grid(20, 20), step_limit=600),
)


def paper_mixture(capabilities: int | None, robots: int = 4) -> Mixture:
    """Return the paper's training worlds: few robots and tasks on 10 x 10 cells, 128 steps.

    Unlike the paper's some have two robots alike, without which a network never learns what to do
    with fleets that have many.
    """
    assert capabilities is not None
    return Mixture(
        robots=(robots, robots),
        capabilities=(capabilities, capabilities),
        tasks=(1, 4),
        crowds=0.0,
        grid=(10, 10),
        more_robots=0.0,
        in_teams=0.5,
        wide_sensing=0.0,
        alike=0.25,
        steps=128,
    )


def imitation_mixture(capabilities: int | None) -> Mixture:
    """Return worlds for networks that learn from a script, which plays large ones at once, too.

    Up to a hundred robots, few or many to a task; some are alike.
    """
    assert capabilities is not None
    return Mixture(
        robots=(2, min(100, max(24, capabilities))),
        capabilities=(capabilities, capabilities),
        tasks=(1, 24),
        crowds=0.0,
        grid=(8, 20),
        more_robots=0.0,
        few=capabilities,
        alike=0.25,
        wide_sensing=0.0,
    )


def paper_selection(capabilities: int | None) -> tuple[Spec, ...]:
    """Return the settings that a network for so many capabilities is selected on."""
    assert capabilities is not None
    if capabilities > 16:
        return (
            Spec(4, 4, capabilities, step_limit=128),
            Spec(30, 10, capabilities, requirements=10, step_limit=600),
            Spec(60, 10, capabilities, requirements=30, world=Grid(20, 20), step_limit=600),
            Spec(100, 20, capabilities, requirements=10, world=Grid(20, 20), step_limit=600),
            Spec(100, 20, capabilities, requirements=90, world=Grid(20, 20), step_limit=600),
        )
    return (
        Spec(4, 4, capabilities, step_limit=128),
        Spec(capabilities, 20, capabilities, step_limit=600),
        Spec(2 * capabilities, 20, capabilities, step_limit=600),
        Spec(4 * capabilities, 40, capabilities, world=Grid(20, 20), step_limit=600),
    )


def selection_worlds(count: int, specs: Sequence[Spec] = ANY_SELECTION) -> list[list[Mission]]:
    """Return `count` worlds of each spec, to select checkpoints on.

    They are larger than those trained on.
    """
    rng = np.random.default_rng([SELECTION, 0])
    return [[generate(spec, rng, "selection") for _ in range(count)] for spec in specs]


def _between(least_most: tuple[int, int], rng: np.random.Generator) -> int:
    return int(rng.integers(least_most[0], least_most[1] + 1))
