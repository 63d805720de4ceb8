"""Quadratic programmes: daqp here, cvxopt on the testbed."""

from __future__ import annotations

from typing import Any

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.errors import TeamformerError
from teamformer.base.extras import how_to_install
from teamformer.robotarium.control.barrier import Solver

OPTIMAL = 1  # daqp's exit flag


def with_daqp() -> Solver:
    """Return a solver that uses daqp; raises `TeamformerError` if that is not installed."""
    try:
        import daqp
    except ImportError:
        hint = how_to_install("robotarium")
        raise TeamformerError("the safety filter needs daqp", hint) from None

    def solve(wanted: Array, rows: Array, bounds: Array) -> Array | None:
        """Minimise |x - wanted|."""
        none = np.full(len(bounds), -1e30)
        kinds = np.zeros(len(bounds), dtype=np.int32)
        x, _, flag, _ = daqp.solve(np.eye(len(wanted)), -wanted, rows, bounds, none, kinds)
        found: Array = np.asarray(x)
        return found if flag == OPTIMAL else None

    return solve


def with_cvxopt() -> Solver:
    """Return a solver that uses cvxopt, an interior point method that is exact to a micron."""
    import cvxopt

    settings = {"show_progress": False, "abstol": 1e-9, "reltol": 1e-8, "feastol": 1e-8}

    def solve(wanted: Array, rows: Array, bounds: Array) -> Array | None:
        """Minimise |x - wanted|."""
        matrix: Any = cvxopt.matrix
        try:
            found = cvxopt.solvers.qp(
                matrix(np.eye(len(wanted))),
                matrix(-wanted),
                matrix(rows),
                matrix(bounds),
                options=settings,
            )
        except (ValueError, ArithmeticError):
            return None
        return np.array(found["x"]).ravel() if found["status"] == "optimal" else None

    return solve
