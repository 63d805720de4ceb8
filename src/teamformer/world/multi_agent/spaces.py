"""The spaces of observations and actions, as Gymnasium describes them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from gymnasium import spaces

from teamformer.base.array_types import Array
from teamformer.files.drawn.generate import Spec
from teamformer.mission.arrivals import most_tasks
from teamformer.mission.checks.checks import LARGEST_COUNT
from teamformer.mission.model import Mission
from teamformer.world.env import TeamFormation
from teamformer.world.multi_agent.action_spaces import count_actions
from teamformer.world.rules.constants import NOBODY


def space_of_observations(observation: Mapping[str, Array], mission: Mission) -> spaces.Dict:
    """Return the space of observations that are like one of a mission."""
    boxes: dict[str, spaces.Space[Any]] = {}
    for name, array in observation.items():
        low, high = _bounds(name, array, mission)
        boxes[name] = spaces.Box(low, high, array.shape, array.dtype.type)
    return spaces.Dict(boxes)


def _bounds(name: str, array: Array, mission: Mission) -> tuple[float, float]:
    """Return the least and the largest value in an array of an observation."""
    if name.endswith("place"):
        return 0, max(mission.world.corner)
    if name.endswith("counts") or name in ("planned", "task_needs"):
        return 0, LARGEST_COUNT
    if array.dtype == np.int8 or name == "task_may_need":
        return 0, 1
    if name == "rest":
        is_carried = any(task.to is not None for task in mission.tasks)
        longest = int(max(task.longest for task in mission.tasks))
        return 0, mission.step_limit if is_carried else longest
    if array.dtype == np.float32:
        return 0, np.inf
    return NOBODY, max(len(mission.robots), most_tasks(mission))


def space_of_actions(
    env: TeamFormation, source: Mission | Spec, has_original_actions: bool
) -> spaces.Space[Any]:
    """Return the space of a robot's actions: counts wanted, or numbers of the original space."""
    brings = env.worlds.brings[0]  # (robots, caps)
    if has_original_actions:
        return spaces.Discrete(count_actions(brings.shape[1]))
    most = brings.sum(axis=0, dtype=np.int64)  # (caps,)
    if isinstance(source, Spec):
        most[:] = most.max()  # evenly dealt: which capabilities are the frequent ones differs
    return spaces.MultiDiscrete(most + 1)
