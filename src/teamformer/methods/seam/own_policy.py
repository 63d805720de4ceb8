"""A user's own policy: what goes wrong in it is told by file and line, as a user's mistake is."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from teamformer.base.errors import TeamformerError
from teamformer.base.own_code import telling_where
from teamformer.methods.seam.protocol import Planner, Policy
from teamformer.mission.model import Mission
from teamformer.world.env import Decision, read_decision
from teamformer.world.view import View

if TYPE_CHECKING:
    from teamformer.methods.central.plays import CentralPlan

HINT = "see docs/reference/policies.md for what a decision is"


def watch_own(policy: Policy, name: str) -> OwnPolicy:
    """Return a policy that a user wrote as one that tells where it fails.

    One that plans stays one.
    """
    return OwnPlanner(policy, name) if isinstance(policy, Planner) else OwnPolicy(policy, name)


class OwnPolicy:
    """Asks a policy that a user wrote, and refuses what is no decision for the view."""

    def __init__(self, policy: Policy, name: str) -> None:
        self._policy, self._what = policy, f"policy '{name}'"
        self.needs_everything = policy.needs_everything

    def begin(self, everything: Sequence[Mission] | None, rng: np.random.Generator) -> None:
        """Have it begin; raises `TeamformerError` where it fails."""
        with telling_where(f"{self._what} failed"):
            self._policy.begin(everything, rng)

    def decide(self, view: View) -> Decision:
        """Return its decision; raises `TeamformerError` where it fails or returns none."""
        with telling_where(f"{self._what} failed"):
            decision = self._policy.decide(view)
        try:
            wanted, task = read_decision(decision, *view.counts.shape)
        except AttributeError:
            what = f"decide() returned {type(decision).__name__}, not a Decision"
            raise TeamformerError(f"{self._what}: {what}", HINT) from None
        except ValueError as error:
            raise TeamformerError(f"{self._what}: decide(): {error}", HINT) from None
        return Decision(wanted, task)


class OwnPlanner(OwnPolicy):
    """Asks a planner that a user wrote."""

    def __init__(self, planner: Planner, name: str) -> None:
        super().__init__(planner, name)
        self._planner, self._name = planner, name

    @property
    def time_limit(self) -> float:
        """Return how long it may plan, in seconds for each mission."""
        return self._planner.time_limit

    @property
    def plans(self) -> Sequence[CentralPlan]:
        """Return what it has found."""
        return self._planner.plans

    def within(self, time_limit: float | None, workers: int | None) -> OwnPlanner:
        """Return one that may take so long, with so many threads."""
        with telling_where(f"{self._what} failed"):
            return OwnPlanner(self._planner.within(time_limit, workers), self._name)

    def plan(
        self,
        everything: Sequence[Mission],
        believed: Sequence[Mission],
        rng: np.random.Generator,
    ) -> None:
        """Have it plan; raises `TeamformerError` where it fails."""
        with telling_where(f"{self._what} failed"):
            self._planner.plan(everything, believed, rng)
