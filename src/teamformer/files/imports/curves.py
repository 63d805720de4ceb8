"""The length of a way that is a curve: a NURBS, as VDA5050 and LIF write trajectories."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from teamformer.base.array_types import Floats
from teamformer.files.imports.trees import TreePart
from teamformer.mission.parts.grid import Place

PIECES = 200
"""Straight pieces that stand for a curve between two of its knots."""


def length_of(part: TreePart | None, begin: Place, end: Place) -> float:
    """Return how long a trajectory is; without one, how long the straight way is.

    What is no curve is refused with its place in the file.
    """
    if part is None or not part.value:
        return math.dist(begin, end)
    points = [(one["x"].number(), one["y"].number()) for _, one in part["controlPoints"].parts()]
    weights = [
        one["weight"].number(1e-9) if "weight" in one.value else 1.0
        for _, one in part["controlPoints"].parts()
    ]
    degree = part["degree"].whole(1) if "degree" in part.value else 1
    knots = part["knotVector"].numbers(0)
    if len(knots) != len(points) + degree + 1 or sorted(knots) != knots:
        given = f"{len(knots)} numbers; with {len(points)} control points and degree {degree}"
        part["knotVector"].refuse(f"has {given} it needs {len(points) + degree + 1}, ascending")
    curve = points_of_curve(np.array(points), np.array(weights), knots, degree)
    return float(np.linalg.norm(np.diff(curve, axis=0), axis=1).sum())


def points_of_curve(points: Floats, weights: Floats, knots: Sequence[float], degree: int) -> Floats:
    """Return points along a NURBS, (places, 2), by the recursion of de Boor and Cox."""
    inner = sorted(set(knots[degree : len(points) + 1]))
    places = np.concatenate(
        [np.linspace(a, b, PIECES, endpoint=False) for a, b in pairwise(inner)]
        + [np.array([np.nextafter(inner[-1], inner[0])])]
    )
    basis = np.array(
        [(lo <= places) & (places < hi) for lo, hi in pairwise(knots)], float
    )  # (spans, places)
    for order in range(1, degree + 1):
        basis = np.array(
            [
                _share(places, knots[k], knots[k + order]) * basis[k]
                + (1 - _share(places, knots[k + 1], knots[k + order + 1])) * basis[k + 1]
                for k in range(len(basis) - 1)
            ]
        )
    weighted = basis * weights[:, None]  # (points, places)
    curve: Floats = (weighted / weighted.sum(axis=0)).T @ points
    return curve


def _share(places: Floats, lo: float, hi: float) -> Floats:
    """Return which part of the way between two knots is behind; none where they are one."""
    return np.zeros_like(places) if hi == lo else (places - lo) / (hi - lo)
