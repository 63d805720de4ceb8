"""Views from the middle of random trials, and networks that have not learned to be careful."""

from __future__ import annotations

import numpy as np
import torch

from random_worlds import random_decision, random_world
from teamformer.base.array_types import Array
from teamformer.learning.nets.teamformer import Teamformer, TeamformerSettings
from teamformer.methods.learned.token_features import TASK_FEATURES, TEAM_FEATURES
from teamformer.world.env import TeamFormation
from teamformer.world.view import View

CAPS = 4
SPELLINGS = ["edit", "full"]


def wild_network(spelling: str, bias: float = 1.0) -> Teamformer:
    """Return a network with large random weights, so that nothing is likely by default."""
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(0)
        settings = TeamformerSettings(
            CAPS, TEAM_FEATURES, TASK_FEATURES, spelling, maintain_bias=bias
        )
        network = Teamformer(settings).eval()
        for weights in network.parameters():
            if weights.ndim > 1:
                torch.nn.init.normal_(weights, std=0.2)
    return network


def tensors(tokens: tuple[Array, ...]) -> tuple[torch.Tensor, ...]:
    return tuple(torch.from_numpy(np.asarray(part)) for part in tokens)


def random_views(count: int, seed: int, worlds: int = 4) -> list[tuple[View, TeamFormation]]:
    """Return views of batches of random worlds, some steps into their trials.

    Robots have up to three capabilities there, some twice; counts, radii and services vary.
    """
    rng, views = np.random.default_rng(seed), []
    while len(views) < count:
        env = TeamFormation([random_world(rng) for _ in range(worlds)])
        for _ in range(int(rng.integers(0, 8))):
            env.step(random_decision(env.view(), rng, 0.8))
        if len(env.view().slot):
            views.append((env.view(), env))
    return views


def illegal_decisions(env: TeamFormation) -> int:
    return int(env.worlds.count["illegal"].sum())
