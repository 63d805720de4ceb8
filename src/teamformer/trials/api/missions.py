"""Missions from files, by name and at random."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from teamformer.base.errors import TeamformerError
from teamformer.files.drawn.generate import Spec
from teamformer.files.drawn.generate import generate as draw
from teamformer.files.drawn.named_settings import world_of
from teamformer.files.mission_files import read_mission, write_mission
from teamformer.mission.model import Mission
from teamformer.trials.api.arguments import PathOrName, refuse_no_mission, whole_seed


def load(path: PathOrName) -> Mission:
    """Return the mission of a file (docs/reference/mission.md).

    Raises `TeamformerError` if the file is wrong; its text lists every problem with its line.

    >>> tf.load("examples/warehouse.yaml").name
    'warehouse morning'
    """
    return read_mission(Path(path))


def save(mission: Mission, path: PathOrName) -> None:
    """Write a mission to a file: as JSON if the name ends in `.json`, else as YAML.

    >>> tf.save(tf.setting("4N4T-C4"), "mission.yaml")
    >>> tf.load("mission.yaml") == tf.setting("4N4T-C4")
    True
    """
    refuse_no_mission(mission, "save")
    write_mission(mission, Path(path))


def setting(name: str, seed: int = 0) -> Mission:
    """Return a random mission of a named setting (docs/reference/random-missions.md).

    The same name and seed give the same mission on every machine. Raises `TeamformerError` if there
    is no setting of this name.

    >>> len(tf.setting("20N100T-C4", seed=3).tasks)
    100
    """
    return world_of(name, whole_seed(seed))


def generate(seed: int = 0, **spec: Any) -> Mission:
    """Return a random mission with the paper's distributions.

    `spec` takes the fields of `teamformer.files.drawn.generate.Spec`: `robots`, `tasks`,
    `capabilities`, `requirements`, `world`, `late_tasks` and others. Raises `TeamformerError` for
    an unknown field or an impossible value.

    >>> mission = tf.generate(seed=1, robots=6, tasks=10, world=tf.Grid(12, 12))
    >>> len(mission.robots), len(mission.tasks)
    (6, 10)
    """
    unknown = sorted(set(spec) - set(Spec.__dataclass_fields__))
    if unknown:
        hint = f"use {', '.join(Spec.__dataclass_fields__)}"
        raise TeamformerError(f"generate knows no '{unknown[0]}'", hint)
    plain = {key: one.item() if isinstance(one, np.generic) else one for key, one in spec.items()}
    return draw(Spec(**plain), np.random.default_rng(whole_seed(seed)))
