"""The vector environment as Stable Baselines3 wants it, masks for MaskablePPO included."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.errors import TeamformerError
from teamformer.base.extras import how_to_install
from teamformer.world.multi_agent.observing import Observation
from teamformer.world.multi_agent.vector_env import TeamFormationVector

try:
    from stable_baselines3.common.vec_env import VecEnv
except ImportError as error:
    hint = how_to_install("sb3")
    raise TeamformerError("Stable Baselines3 is not installed", hint) from error


class TeamFormationSB3(VecEnv):
    """A `TeamFormationVector` for Stable Baselines3, which starts ended worlds again at once.

    `infos` of robots in an ended world have `terminal_observation`, and `TimeLimit.truncated` says
    whether the step limit ended it.
    """

    def __init__(self, vector: TeamFormationVector) -> None:
        self._vector = vector
        self._actions = np.zeros(0)
        self.render_mode = None
        super().__init__(
            vector.num_envs, vector.single_observation_space, vector.single_action_space
        )

    def reset(self) -> Observation:
        """Start all worlds again."""
        seed = self._seeds[0] if self._seeds else None
        observations, _ = self._vector.reset(seed=seed)
        self._reset_seeds()
        return _copies(observations)

    def step_async(self, actions: Array) -> None:
        """Keep the actions of the next step."""
        self._actions = actions

    def step_wait(self) -> tuple[Observation, Array, Array, list[dict[str, Any]]]:
        """Make the step."""
        seen, rewards, is_ended, is_cut, _ = self._vector.step(self._actions)
        is_over, infos = is_ended | is_cut, [dict[str, Any]() for _ in range(self.num_envs)]
        for robot in np.flatnonzero(is_over).tolist():
            last = {name: array[robot].copy() for name, array in seen.items()}
            infos[robot] = {
                "terminal_observation": last,
                "TimeLimit.truncated": bool(is_cut[robot]),
            }
        if is_over.any():
            seen = self._vector.restart_ended()
        return _copies(seen), rewards.astype(np.float32), is_over, infos

    def close(self) -> None:
        """End the threads of the worlds."""
        self._vector.close()

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """Return an attribute of the vector, once for each robot asked about."""
        return [getattr(self._vector, attr_name) for _ in self._numbers(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Set an attribute of the vector."""
        setattr(self._vector, attr_name, value)

    def env_method(
        self, method_name: str, *method_args: Any, indices: Any = None, **method_kwargs: Any
    ) -> list[Any]:
        """Return the rows of what a method of the vector returns, as `action_masks` does."""
        rows = getattr(self._vector, method_name)(*method_args, **method_kwargs)
        return [rows[robot] for robot in self._numbers(indices)]

    def env_is_wrapped(self, wrapper_class: type, indices: Any = None) -> list[bool]:
        """Say that nothing is wrapped."""
        return [False for _ in self._numbers(indices)]

    def _numbers(self, indices: Any) -> Sequence[int]:
        if indices is None:
            return range(self.num_envs)
        return [indices] if isinstance(indices, int) else list(indices)


def _copies(observations: Observation) -> Observation:
    """Return arrays that the next step leaves alone."""
    return {name: array.copy() for name, array in observations.items()}
