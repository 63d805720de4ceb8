"""Advantages and returns of streams of rewards, and of the decisions credited with them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor

from teamformer.base.array_types import Array
from teamformer.learning.algorithms.rollout import Rollout
from teamformer.learning.nets.critic import Critic


@dataclass(frozen=True)
class Credit:
    """What a rollout teaches."""

    gain: Tensor  # (decisions,) advantages
    target: Tensor  # (states, streams) returns that the critic should have said
    is_there: Tensor  # (states, streams) False for padding and lost robots


def credit(rollout: Rollout, critic: Critic, discount: float, decay: float) -> Credit:
    """Return the advantage of each decision: that of its streams, weighted by their shares."""
    with torch.no_grad():
        said = stream_values(critic(*rollout.global_state), rollout.value_of)  # (states, streams)
        at_last = stream_values(critic(*rollout.last_global_state), rollout.last_value_of)
    is_running = rollout.is_running  # (steps, worlds)
    steps, worlds = is_running.shape
    values = np.zeros((steps + 1, worlds, said.shape[1]), dtype=np.float32)
    values[:-1][is_running] = said.cpu().numpy()  # both in step and world order
    values[-1] = np.where(rollout.has_ended[:, None], 0.0, at_last.cpu().numpy())
    of_streams = advantages(rollout.rewards, values, is_running, discount, decay)[is_running]
    gains = torch.from_numpy(of_streams)  # (states, streams)
    return Credit(
        gain=(gains[rollout.state] * rollout.share).sum(dim=1),
        target=gains + said.cpu(),
        is_there=rollout.value_of >= 0,
    )


def stream_values(values: Tensor, value_of: Tensor) -> Tensor:
    """Return each stream's value, zero where it has none, from the critic's.

    `values` is (states, values), `value_of` (states, streams) with -1 for none.
    """
    picked = values.gather(1, value_of.to(values.device).clamp(min=0))  # (states, streams)
    return torch.where(value_of.to(values.device) >= 0, picked, 0.0)


def advantages(
    rewards: Array, values: Array, is_running: Array, discount: float, decay: float
) -> Array:
    """Return generalised advantage estimates (Schulman et al. 2016, eq. 16).

    `rewards` is (steps, worlds, streams) and so is the result, `is_running` (steps, worlds);
    `values` is (steps + 1, worlds, streams), zero where a world has ended; its last row stands for
    what a trial that was cut off would still have given.
    """
    result = np.zeros_like(rewards)
    ahead = np.zeros_like(rewards[0])
    for step in range(len(rewards) - 1, -1, -1):
        surprise = rewards[step] + discount * values[step + 1] - values[step]
        goes_on = is_running[step][:, None]
        ahead = np.where(goes_on, surprise + discount * decay * ahead, 0.0)
        result[step] = ahead
    return result
