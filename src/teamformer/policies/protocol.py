"""The seams between the environment and whatever decides."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Protocol, runtime_checkable

import numpy as np

from teamformer.model import Scenario
from teamformer.sim.env import Decision
from teamformer.sim.view import View

if TYPE_CHECKING:
    from teamformer.policies.central.plays import CentralPlan


class Policy(Protocol):
    """Turns the views of teams into their decisions.

    A decentralised policy has `needs_everything = False`. It is not given any scenario, so it can
    know nothing but the views.
    """

    needs_everything: bool

    def begin(self, everything: Sequence[Scenario] | None, rng: np.random.Generator) -> None:
        """Prepare for a new batch of trials.

        `everything` has the scenarios of the batch; it is None if `needs_everything` is False.
        `rng` is the only source of random numbers that the policy may use.
        """

    def decide(self, view: View) -> Decision:
        """Return the decision: one row for each row of the view."""


@runtime_checkable
class Planner(Policy, Protocol):
    """A policy that plans every scenario of a batch in `begin`, for as long as it is given.

    `time_limit` is in seconds for each scenario, `workers` the threads that it may use. `believed`
    is what robots know of each scenario that is planned, set before `begin`. `plans` holds what was
    found, a plan for each scenario.
    """

    time_limit: float
    workers: int
    believed: Sequence[Scenario]
    plans: list[CentralPlan]


@runtime_checkable
class Guarded(Policy, Protocol):
    """A policy with a deadlock guard, which can be switched off.

    `overdue` counts the decisions that the guard has taken since `begin`.
    """

    is_guarded: bool
    overdue: int
