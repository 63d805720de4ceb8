"""Random worlds, some in a state that random decisions brought about, that a player cannot end."""

from __future__ import annotations

import numpy as np

from random_worlds import random_decision, random_world, with_loads
from teamformer.methods.by_name import Player, as_method
from teamformer.mission.model import Mission
from teamformer.trials.trial import decide
from teamformer.world.env import TeamFormation


def blocked_worlds(
    player: Player, count: int, seed: int, is_plane: bool = False, have_loads: bool = False
) -> list[Mission]:
    """Return the worlds, of many in which anything may have happened before, that do not end."""
    rng = np.random.default_rng(seed)
    method, blocked = as_method(player), []
    together = min(count, 500)
    for _ in range(count // together):
        worlds = [random_world(rng, is_plane=is_plane) for _ in range(together)]
        worlds = [with_loads(world, rng) for world in worlds] if have_loads else worlds
        env = TeamFormation(worlds, coordinator=method.coordinator)
        for _ in range(int(rng.integers(0, 25))):
            if env.is_running.any():
                env.step(random_decision(env.view(), rng))
        if method.policy is not None:
            method.policy.begin(None, rng)
        while env.is_running.any():
            env.step(decide(env, method, env.view()))
        assert env.worlds.count["illegal"].sum() == 0
        blocked += [s for w, s in enumerate(env.missions) if env.tally(w).status == "step limit"]
    return blocked
