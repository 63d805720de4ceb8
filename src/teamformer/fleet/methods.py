"""Methods for agents, by name: a coordinator's plans, or a policy for each robot."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

from teamformer.base.errors import TeamformerError
from teamformer.fleet.planner import CoordinatedPlanner

if TYPE_CHECKING:
    from teamformer.methods.by_name import Method
    from teamformer.methods.seam.protocol import Policy

PLAN = "plan"
"""The shared plan: the default, and what robots fall back to whose policy gets nowhere."""


def planner_of(method: str) -> CoordinatedPlanner:
    """Return what makes the plans of a fleet: the method's coordinator, else the shared plan.

    Raises what `policy_of` raises.
    """
    if method == PLAN:
        return CoordinatedPlanner()  # loaded when it first plans
    return CoordinatedPlanner(_load(method).coordinator)


@lru_cache(maxsize=1024)
def policy_of(method: str, robot: int) -> Policy | None:
    """Return the policy of a robot; None where robots go by plans. Each robot has one of its own.

    An agent that begins to use it calls `begin`. Raises `TeamformerError` for what is no method,
    and for one that has to know everything.
    """
    return None if method == PLAN else _load(method).policy


def _load(method: str) -> Method:
    from teamformer.methods.by_name import load_method

    loaded = load_method(method)
    if loaded.needs_everything:
        raise TeamformerError(
            f"method '{method}' needs to know everything, and no robot does",
            "use one that decides as the mission goes; `teamformer methods` lists them",
        )
    return loaded
