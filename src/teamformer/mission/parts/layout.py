"""Roads laid out on a plane, so that they can be drawn: they have times, and no coordinates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from teamformer.base.array_types import Floats
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.roads import Roads

NEAR = 2.0
"""Cells that lie between a place and its nearest one, in the middle of all places."""

LEAST_SIDE, LARGEST_SIDE = 6.0, 90.0
MARGIN = 1.5
"""Cells on each side of all places."""

SWEEPS = 60
"""How often places are moved to where their ways are as long as they take, or nearly so."""

DIGITS = 3


@dataclass(frozen=True)
class Layout:
    """Where places of roads are drawn, in cells, and between which of them a road is."""

    names: tuple[str, ...]
    width: float
    height: float
    places: tuple[Place, ...]
    roads: tuple[tuple[int, int], ...]


def places_of(ways: Floats) -> Floats:
    """Return points of a plane with distances as near to these as there are, (places, 2).

    This is classical scaling.
    """
    count = len(ways)
    centre = np.eye(count) - 1 / count
    products = -0.5 * centre @ (ways**2) @ centre
    values, vectors = np.linalg.eigh(products)
    scale = np.sqrt(np.maximum(values[-2:], 0.0))
    places: Floats = vectors[:, -2:] * scale
    return places


def layout_of(world: Roads) -> Layout:
    """Return where the places of roads are drawn: near ones near to one another."""
    ways = _lengths(world)
    if len(ways) == 1:
        return Layout(world.places, LEAST_SIDE, LEAST_SIDE, ((LEAST_SIDE / 2, LEAST_SIDE / 2),), ())
    places = _spread(places_of(ways) if len(ways) > 2 else np.array([[0, 0], [0, 1.0]]), ways)
    places = _in_cells(places[:, ::-1])  # the longer side is across
    width, height = np.maximum(places.max(axis=0) + MARGIN, LEAST_SIDE)
    where = tuple((round(float(x), DIGITS), round(float(y), DIGITS)) for x, y in places)
    size = round(float(width), DIGITS), round(float(height), DIGITS)
    return Layout(world.places, *size, where, _roads(world))


def _lengths(world: Roads) -> Floats:
    """Return how far places are from one another, (places, places), by whatever moves there.

    It is the mean of there and back; where no way leads it is far.
    """
    tables = np.array([np.array(rows) for rows in world.ways.values()])
    shortest = tables.min(axis=0)
    both = (shortest + shortest.T) / 2
    known = both[np.isfinite(both)]
    far = 1.5 * (known.max() if known.size and known.max() > 0 else 1.0)
    lengths: Floats = np.where(np.isfinite(both), both, far)
    np.fill_diagonal(lengths, 0)
    return lengths


def _spread(places: Floats, ways: Floats) -> Floats:
    """Move places so that no two are in one, and ways are nearly as long as they take.

    This is scaling by majorization: each sweep makes the sum of squared differences smaller, each
    counted by how short its way is.
    """
    count = len(ways)
    least = max(ways[ways > 0].min(initial=1.0), ways.max() / 20)
    wanted = np.maximum(ways, least)
    weight = 1 / wanted**2
    np.fill_diagonal(weight, 0)
    turn = np.arange(count)[:, None] * 2.399963  # of places that lie in one
    places = places + 1e-3 * least * np.hstack([np.cos(turn), np.sin(turn)])
    laplace = np.diag(weight.sum(axis=1)) - weight
    inverse = np.linalg.pinv(laplace)
    for _ in range(SWEEPS):
        away = np.linalg.norm(places[:, None] - places[None], axis=2)
        ratio = -weight * wanted / np.maximum(away, 1e-9)
        np.fill_diagonal(ratio, 0)
        np.fill_diagonal(ratio, -ratio.sum(axis=1))
        places = inverse @ (ratio @ places)
    return places


def _in_cells(places: Floats) -> Floats:
    """Return places as they lie on a map: in cells, from the lower left corner."""
    away = np.linalg.norm(places[:, None] - places[None], axis=2)
    np.fill_diagonal(away, np.inf)
    size = np.ptp(places, axis=0).max()
    cells = NEAR / max(float(np.median(away.min(axis=1))), 1e-9)
    cells = min(cells, (LARGEST_SIDE - 2 * MARGIN) / max(size, 1e-9))
    signs = np.where(places[np.abs(places).argmax(axis=0), (0, 1)] < 0, -1, 1)
    drawn = places * signs * cells
    low = drawn.min(axis=0)
    room = np.maximum(LEAST_SIDE - np.ptp(drawn, axis=0) - 2 * MARGIN, 0) / 2
    placed: Floats = drawn - low + MARGIN + room
    return placed


def _roads(world: Roads) -> tuple[tuple[int, int], ...]:
    """Return the pairs of places with a direct way, but for ways by a place that lies nearer."""
    ways, count = _lengths(world), len(world.places)
    direct = np.isfinite(np.array([np.array(rows) for rows in world.times.values()]).min(axis=0))
    is_road = direct | direct.T
    pairs = []
    for one in range(count):
        for other in range(one + 1, count):
            by = np.maximum(ways[one], ways[other])
            by[[one, other]] = np.inf
            if is_road[one, other] and not (by < ways[one, other] * (1 - 1e-9)).any():
                pairs.append((one, other))
    return tuple(pairs)
