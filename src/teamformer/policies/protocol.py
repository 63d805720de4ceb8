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
    """Turns the views of teams into their decisions, one row each.

    A decentralised policy has `needs_everything = False`: it is then given no scenario, so that
    it can know nothing but the views.
    """

    needs_everything: bool

    def begin(self, everything: Sequence[Scenario] | None, rng: np.random.Generator) -> None:
        """Get ready for a new batch of trials; `everything` is None unless it is needed."""

    def decide(self, view: View) -> Decision:
        """Return what each team of the view wants."""


@runtime_checkable
class Planner(Policy, Protocol):
    """A policy that plans every scenario of a batch in `begin`, for as long as it is given.

    `time_limit` is in seconds for each scenario, `workers` the threads that it may use; `plans`
    holds what it found, a plan for each scenario.
    """

    time_limit: float
    workers: int
    plans: list[CentralPlan]


@runtime_checkable
class InHindsight(Policy, Protocol):
    """A policy that is told everything, and may yet decide in a mission as the robots see it.

    Trials begin it by `begin_in` instead of `begin`: with what each mission really is and what the
    robots see of it. It returns the one of both, for each, that it is to decide in.
    """

    def begin_in(
        self, truths: Sequence[Scenario], seen: Sequence[Scenario], rng: np.random.Generator
    ) -> Sequence[Scenario]:
        """Get ready for a new batch of trials."""


@runtime_checkable
class MadeFor(Policy, Protocol):
    """A policy that was made for some allocations, the first of them above all.

    Under any other it only does as a scripted one.
    """

    allocations: tuple[str, ...]


@runtime_checkable
class Guarded(Policy, Protocol):
    """A policy with a deadlock guard, which can be switched off.

    `overdue` counts the decisions that the guard has taken since `begin`.
    """

    is_guarded: bool
    overdue: int
