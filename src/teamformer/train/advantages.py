"""Returns and advantages of whole worlds, which all teams of a world share."""

from __future__ import annotations

import numpy as np

from teamformer.sim.arrays import Array


def advantages(
    rewards: Array, values: Array, is_running: Array, discount: float, decay: float
) -> Array:
    """Return generalised advantage estimates (Schulman et al. 2016, eq. 16) as (steps, worlds).

    `rewards` and `is_running` are (steps, worlds); `values` is (steps + 1, worlds), zero where a
    world has ended; its last row stands for what a trial that was cut off would still have given.
    """
    result = np.zeros_like(rewards)
    ahead = np.zeros(rewards.shape[1], dtype=rewards.dtype)
    for step in range(len(rewards) - 1, -1, -1):
        surprise = rewards[step] + discount * values[step + 1] - values[step]
        ahead = np.where(is_running[step], surprise + discount * decay * ahead, 0.0)
        result[step] = ahead
    return result
