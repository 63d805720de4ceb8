"""Missions that a policy learns to give out the tasks of, and those that it is selected on.

Those of the families that people have, of all sizes, the paper's, and missions in continuous time
as HeteroMRTA and SADCHER have them. Seeds of training, selection and test never meet.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from teamformer.files.drawn.families import FAMILIES, sized
from teamformer.files.drawn.family_missions import draw_mission
from teamformer.files.drawn.generate import Spec, generate
from teamformer.learning.training_worlds import SELECTION, TRAINING
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Grid, Place
from teamformer.mission.parts.plane import Plane

LEARNED_FROM = ("real", "sparse", "warehouse", "carry", "air-ground", "moving")
"""Families whose missions are judged by the makespan."""

SIZES = (0.35, 1.4)
"""Robots and tasks are drawn times a number in this range, alike in its logarithm."""

PAPERS, CONTINUOUS = 0.05, 0.15
"""Share of the paper's missions, and of those in continuous time; the others are of families."""


def task_worlds(count: int, seed: tuple[int, ...]) -> list[Mission]:
    """Return the missions that a seed stands for."""
    rng = np.random.default_rng([TRAINING, *seed])
    return [_draw(rng) for _ in range(count)]


def task_selection(count: int) -> list[list[Mission]]:
    """Return so many missions of each kind, to select checkpoints on."""
    rng = np.random.default_rng([SELECTION, 1])
    families = [[_of_family(name, 1.0, rng) for _ in range(count)] for name in LEARNED_FROM[:5]]
    shapes = ((3, 3, 8), (15, 5, 40))
    return families + [[draw_continuous(*shape, rng) for _ in range(count)] for shape in shapes]


def _draw(rng: np.random.Generator) -> Mission:
    kind, size = rng.random(), float(np.exp(rng.uniform(*np.log(SIZES))))
    if kind < PAPERS:
        return _papers(rng)
    if kind < PAPERS + CONTINUOUS:
        robots, skills = int(rng.integers(3, 16)), int(rng.integers(2, 7))
        return draw_continuous(robots, skills, int(rng.integers(6, 41)), rng)
    return _of_family(str(rng.choice(LEARNED_FROM)), size, rng)


def _of_family(name: str, size: float, rng: np.random.Generator) -> Mission:
    family = FAMILIES[name]
    smaller = replace(sized(family, size), width=family.width, height=family.height)
    return draw_mission(smaller, rng, name)


def _papers(rng: np.random.Generator) -> Mission:
    caps = int(rng.integers(2, 9))
    spec = Spec(
        robots=int(rng.integers(caps, 3 * caps + 1)),
        tasks=int(rng.integers(6, 41)),
        capabilities=caps,
        requirements=int(rng.integers(1, min(caps, 4) + 1)),
        world=Grid(10, 10) if rng.random() < 0.5 else Grid(20, 20),
    )
    return generate(spec, rng, "training")


def draw_continuous(robots: int, skills: int, tasks: int, rng: np.random.Generator) -> Mission:
    """Return a mission in continuous time whose tasks need robots of one or several skills.

    A unit square, speed 0.2, and tasks of up to 5, as HeteroMRTA has it; robots start together or
    not, have one skill or several, and some tasks come after one before.
    """
    names = tuple(f"skill-{number}" for number in range(skills))
    has_several, together = rng.random() < 0.5, rng.random() < 0.5
    depot = _place(rng)
    fleet = []
    for number in range(robots):
        has = {names[number % skills]}
        if has_several:
            has |= {name for name in names if rng.random() < 0.4}
        at = depot if together else _place(rng)
        fleet.append(Robot(f"r{number}", at, dict.fromkeys(sorted(has), 1), 0.2))
    there = [name for name in names if any(name in robot.can for robot in fleet)]
    most = 1 + int(rng.integers(min(3, len(there))))
    ordered = 0.3 * rng.random() if rng.random() < 0.5 else 0.0
    wanted = []
    for number in range(tasks):
        chosen = rng.choice(there, 1 + int(rng.integers(most)), replace=False)
        is_after = number > 0 and rng.random() < ordered
        after = (f"t{int(rng.integers(number))}",) if is_after else ()
        needs = dict.fromkeys(sorted(str(name) for name in chosen), 1)
        duration = float(5 * rng.random())
        wanted.append(Task(f"t{number}", _place(rng), needs, duration, after=after))
    return Mission(
        name="training",
        world=Plane(1.0, 1.0),
        capabilities=tuple(there),
        robots=tuple(fleet),
        tasks=tuple(wanted),
        time="continuous",
        ends="home",
    )


def _place(rng: np.random.Generator) -> Place:
    return float(rng.random()), float(rng.random())
