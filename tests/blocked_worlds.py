"""Random worlds, some in a state that random decisions brought about, that a policy cannot end."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from random_worlds import random_decision, random_world
from teamformer.model import Scenario
from teamformer.policies.protocol import Policy
from teamformer.sim.env import TeamFormation


def blocked_worlds(
    policy: Policy, allocation: str, count: int, seed: int, is_plane: bool = False
) -> list[Scenario]:
    """Return the worlds, of many in which anything may have happened before, that do not end."""
    rng = np.random.default_rng(seed)
    blocked = []
    together = min(count, 500)
    for _ in range(count // together):
        worlds = [random_world(rng, is_plane=is_plane) for _ in range(together)]
        env = TeamFormation([replace(w, allocation=allocation) for w in worlds])
        for _ in range(int(rng.integers(0, 25))):
            if env.is_running.any():
                env.step(random_decision(env.view(), rng))
        policy.begin(None, rng)
        while env.is_running.any():
            env.step(policy.decide(env.view()))
        assert env.worlds.count["illegal"].sum() == 0
        blocked += [s for w, s in enumerate(env.scenarios) if env.tally(w).status == "step limit"]
    return blocked
