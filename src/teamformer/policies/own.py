"""A user's own policy: what goes wrong in it is told by file and line, as a user's mistake is."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np

from teamformer.errors import TeamformerError
from teamformer.model import Scenario
from teamformer.own_code import telling_where
from teamformer.policies.protocol import Policy
from teamformer.sim.env import Decision, read_decision
from teamformer.sim.view import View


def watch_own(policy: Policy, name: str) -> Policy:
    """Have a policy that a user wrote tell where it fails, and refuse what is no decision.

    From then on its `begin` and `decide` raise `TeamformerError` where they raised anything else
    or answered with anything else than a decision for the view. All else of it stays as it is.
    """
    watched: dict[str, Callable[..., Any]] = {
        "begin": partial(_begin, policy.begin, name),
        "decide": partial(_decide, policy.decide, name),
    }
    try:
        for method, call in watched.items():
            object.__setattr__(policy, method, call)
    except AttributeError:  # its class has slots: one below it that has none more
        kind = type(policy)
        methods: dict[str, Any] = {key: staticmethod(call) for key, call in watched.items()}
        policy.__class__ = type(kind.__name__, (kind,), {"__slots__": (), **methods})
    return policy


def _begin(
    begin: Callable[..., None],
    name: str,
    everything: Sequence[Scenario] | None,
    rng: np.random.Generator,
) -> None:
    with telling_where(f"policy '{name}' failed"):
        begin(everything, rng)


def _decide(decide: Callable[[View], Decision], name: str, view: View) -> Decision:
    with telling_where(f"policy '{name}' failed"):
        decision = decide(view)
    try:
        wanted, task = read_decision(decision, *view.counts.shape)
    except AttributeError:
        what = f"decide() returned {type(decision).__name__}, not a Decision"
        raise TeamformerError(f"policy '{name}': {what}", HINT) from None
    except ValueError as error:
        raise TeamformerError(f"policy '{name}': decide(): {error}", HINT) from None
    return Decision(wanted, task)


HINT = "see docs/reference/policies.md for what a decision is"
