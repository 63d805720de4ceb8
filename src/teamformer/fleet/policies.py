"""Policies for agents, by name: one for each robot, made once a process."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

from teamformer.errors import TeamformerError

if TYPE_CHECKING:
    from teamformer.policies.protocol import Policy


@lru_cache(maxsize=1024)
def policy_of(name: str, robot: int) -> Policy:
    """Return the policy of a robot; an agent that begins to use it calls `begin`.

    Raises `TeamformerError` for what is no policy, and for one that has to know everything.
    """
    from teamformer.policies import POLICIES
    from teamformer.trials.registry import load_policy

    policy = load_policy(name, POLICIES)
    if policy.needs_everything:
        raise TeamformerError(
            f"policy '{name}' needs to know everything, and no robot does",
            "use one that decides by its view; `teamformer policies` lists them",
        )
    return policy
