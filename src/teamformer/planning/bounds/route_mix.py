"""The best mix of known routes, and what it would pay for each need: a linear programme."""

from __future__ import annotations

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.import_apart import import_apart

MOST = 4.0
"""The share is bounded, so that there is a best mix before any route is known."""


class RouteMix:
    """Which share of robots' time goes to which of their routes, to bring most of all needs.

    Robots are in groups of so many that are alike; each need takes an amount.
    """

    def __init__(self, amount: Array, sizes: Array) -> None:
        import_apart("ortools.math_opt.python.mathopt")
        from ortools.math_opt.python import mathopt

        self._amount = amount  # (needs,)
        model = self._model = mathopt.Model()
        share = model.add_variable(lb=0.0, ub=MOST)
        model.maximize(share)
        self._brought = [model.add_linear_constraint(lb=0.0) for _ in amount]
        for constraint, needed in zip(self._brought, amount.tolist(), strict=True):
            constraint.set_coefficient(share, -float(needed))
        self._taken = [model.add_linear_constraint(ub=float(size)) for size in sizes]
        self._solver = mathopt.IncrementalSolver(model, mathopt.SolverType.HIGHS)
        self._known: set[tuple[int, bytes]] = set()

    def add(self, group: int, brought: Array) -> None:
        """Let the robots of a group take one more route, which brings so much to each need."""
        route = (group, brought.tobytes())
        if route in self._known:
            return
        self._known.add(route)
        taken = self._model.add_variable(lb=0.0)
        self._taken[group].set_coefficient(taken, 1.0)
        for need in np.flatnonzero(brought).tolist():
            self._brought[need].set_coefficient(taken, float(brought[need]))

    def prices(self) -> Array | None:
        """Return what the best mix pays for each need; None if it brings all that is needed.

        Prices times amounts add up to 1. A solver that gets nowhere returns None too.
        """
        from ortools.math_opt.python import mathopt

        result = self._solver.solve()
        is_solved = result.termination.reason == mathopt.TerminationReason.OPTIMAL
        if not is_solved or result.objective_value() >= 1:
            return None
        duals = np.abs([result.dual_values(constraint) for constraint in self._brought])
        total = float((duals * self._amount).sum())
        return duals / total if total > 0 else None
