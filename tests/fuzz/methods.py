"""Methods by name, and a trial by one as `teamformer run` makes it."""

from __future__ import annotations

from functools import cache

from hypothesis import strategies as st

from teamformer.methods.by_name import load_method
from teamformer.mission.model import Mission
from teamformer.trials.trial import PlayedTrial, run_trial

DEFAULT = "plan"
SCRIPTED = ("crews", "soonest", "reactive", "join-all", "heuristic", "join-fitting", "teamformer")
LEARNED = ("teamformer-c4", "teamformer-c8", "teamformer-c4-ppo", "deepset-c4", "gnn-c4")
"""Networks for up to so many capabilities; missions have no more than four."""

METHODS = st.sampled_from([DEFAULT, DEFAULT, DEFAULT, *SCRIPTED, *LEARNED])
"""Names of methods, the default above all."""

method_of = cache(load_method)
"""Returns a method by its name."""


def play(mission: Mission, method: str, seed: int, bound: int | None = None) -> PlayedTrial:
    """Run a trial as `teamformer run` does."""
    return run_trial(mission, method_of(method), seed, bound)
