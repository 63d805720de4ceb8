"""The seams between the environment and whatever decides."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Protocol, Self, runtime_checkable

import numpy as np

from teamformer.mission.model import Mission
from teamformer.world.env import Decision
from teamformer.world.view import View

if TYPE_CHECKING:
    from teamformer.methods.central.plays import CentralPlan


class Policy(Protocol):
    """Turns the views of teams into their decisions.

    A decentralised policy has `needs_everything = False`. It is not given any mission, so it can
    know nothing but the views.
    """

    needs_everything: bool

    def begin(self, everything: Sequence[Mission] | None, rng: np.random.Generator) -> None:
        """Prepare for a new batch of trials.

        `everything` has the missions of the batch; it is None if `needs_everything` is False.
        `rng` is the only source of random numbers that the policy may use.
        """

    def decide(self, view: View) -> Decision:
        """Return the decision: one row for each row of the view."""


@runtime_checkable
class Planner(Policy, Protocol):
    """A policy that plans every mission of a batch before it decides; it is told everything.

    `begin` is for those who know of no planners: it plans for robots that know everything, too.
    """

    @property
    def time_limit(self) -> float:
        """Return how long it may plan, in seconds for each mission."""

    @property
    def plans(self) -> Sequence[CentralPlan]:
        """Return what was found since it last began: a plan for each mission."""

    def within(self, time_limit: float | None, workers: int | None) -> Self:
        """Return one that may take so long for each mission, with so many threads.

        None leaves either as it is.
        """

    def plan(
        self,
        everything: Sequence[Mission],
        believed: Sequence[Mission],
        rng: np.random.Generator,
    ) -> None:
        """Begin with a plan for each mission; `believed` is what robots know of each."""


@runtime_checkable
class Guarded(Policy, Protocol):
    """A policy with a deadlock guard.

    `overdue` counts the decisions that the guard has taken since `begin`.
    """

    overdue: int

    def unguarded(self) -> Policy:
        """Return the same policy without the guard."""
