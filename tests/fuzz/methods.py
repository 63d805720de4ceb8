"""Who does what by which method: keys of the file, names of policies, and a trial under one.

All that is known here of `order`, `new_tasks`, `allocation`, `foresight` and of policies.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

from hypothesis import strategies as st

from teamformer.model import Scenario
from teamformer.policies import POLICIES
from teamformer.policies.protocol import Policy
from teamformer.trials.registry import load_policy
from teamformer.trials.suiting import suited
from teamformer.trials.trial import Trial, run_trial

FILE_KEYS: dict[str, tuple[Any, ...]] = {
    "order": ("tsp", "schedule"),
    "new_tasks": ("resolve", "nearest"),
    "allocation": ("plan", "crews", "paper", "nearest"),
    "foresight": ("scouting", "needed", "absent"),
}

DEFAULT = "teamformer"
SCRIPTED = ("join-all", "heuristic", "join-fitting", "join-crew", "follow-plan")
LEARNED = ("teamformer-c4", "teamformer-c8", "teamformer-c4-ppo", "deepset-c4", "gnn-c4")
"""Networks for up to so many capabilities; missions have no more than four."""

METHODS = st.sampled_from([DEFAULT, DEFAULT, DEFAULT, *SCRIPTED, *LEARNED])
"""Names of policies, the default above all."""

policy_of = cache(lambda method: load_policy(method, POLICIES))
"""Returns a policy by its name."""


def as_played(scenario: Scenario, method: str) -> Scenario:
    """Return a mission as a method plays it."""
    return suited(scenario, policy_of(method))


def without_plan(scenario: Scenario) -> Scenario:
    """Return a mission in which decisions say who does what, and nothing is planned."""
    return replace(scenario, allocation="paper", order="tsp")


def play(scenario: Scenario, method: str, seed: int, bound: int | None = None) -> Trial:
    """Run a trial as `teamformer run` does."""
    policy: Policy = policy_of(method)
    return run_trial(as_played(scenario, method), policy, method, seed, bound)
