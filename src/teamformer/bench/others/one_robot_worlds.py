"""Worlds whose tasks need one robot each: solvers of vehicle routing can be asked these, too.

They are like HeteroMRTA's: places in the unit square, a speed of 0.2, tasks that take up to 5, all
home in the end. A robot has one or two of three skills, and a task needs one of them.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from teamformer.base.errors import TeamformerError
from teamformer.bench.others.instances import Instance
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.plane import Plane

SKILLS, SPEED, LONGEST = 3, 0.2, 5.0

SETTING = re.compile(r"one-robot-([1-9]\d{0,3})-([1-9]\d{0,3})")


def draw_instances(settings: Sequence[str], worlds: int, first_seed: int) -> list[Instance]:
    """Return worlds of settings such as `one-robot-10-50`: ten robots and fifty tasks.

    Raises `TeamformerError` for any other setting.
    """
    drawn = []
    for setting in settings:
        sizes = SETTING.fullmatch(setting)
        if sizes is None:
            hint = "write one-robot-ROBOTS-TASKS, such as one-robot-10-50"
            raise TeamformerError(f"`others` draws no setting '{setting}'", hint)
        for seed in range(first_seed, first_seed + worlds):
            world = draw_world(int(sizes[1]), int(sizes[2]), seed)
            drawn.append(Instance(setting, world, {}))
    return drawn


def draw_world(robots: int, tasks: int, seed: int) -> Mission:
    """Return a world; the same seed gives the same one."""
    rng = np.random.default_rng([seed, robots, tasks])
    names = [f"skill-{number}" for number in range(SKILLS)]
    placed_robots, placed_tasks = [], []
    for number in range(robots):
        has = {names[number % SKILLS], names[rng.integers(SKILLS)]}
        can = dict.fromkeys(sorted(has), 1)
        placed_robots.append(Robot(f"r{number}", _place(rng), can, SPEED))
    for number in range(tasks):
        needs = {names[rng.integers(min(SKILLS, robots))]: 1}
        duration = float(LONGEST * rng.random())
        placed_tasks.append(Task(f"t{number}", _place(rng), needs, duration))
    return Mission(
        name=f"env_{seed}",
        world=Plane(1.0, 1.0),
        capabilities=tuple(names),
        robots=tuple(placed_robots),
        tasks=tuple(placed_tasks),
        time="continuous",
        ends="home",
    )


def _place(rng: np.random.Generator) -> Place:
    return float(rng.random()), float(rng.random())
