"""Methods for agents, by name: the shared plan, or a policy for each robot, made once a process."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

from teamformer.errors import TeamformerError

if TYPE_CHECKING:
    from teamformer.policies.protocol import Policy

PLAN = "plan"
"""The method by which robots follow their shared plan; by any other a policy forms teams."""


@lru_cache(maxsize=1024)
def policy_of(method: str, robot: int) -> Policy | None:
    """Return the policy of a robot; None for `plan`. An agent that begins to use it calls `begin`.

    Raises `TeamformerError` for what is no method, for one that has to know everything, and for
    crews, which agents do not plan.
    """
    from teamformer.trials.methods import load_method

    if method == PLAN:
        return None
    loaded = load_method(method)
    if loaded.policy.needs_everything:
        raise TeamformerError(
            f"method '{method}' needs to know everything, and no robot does",
            "use one that decides by its view; `teamformer methods` lists them",
        )
    if loaded.allocation != "paper":
        hint = f"use {PLAN}, or a policy such as heuristic"
        raise TeamformerError(f"agents do not plan by the method '{method}'", hint)
    return loaded.policy
