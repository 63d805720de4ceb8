"""The seam between the environment and whatever decides."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from teamformer.model import Scenario
from teamformer.sim.env import Decision
from teamformer.sim.view import View


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
