"""Graphs of sites: wards along a corridor, shelves along aisles that lead one way.

Every place can be got to from every other one, by whatever moves. Who moves as `CART` is slower,
and too wide for the narrow lanes.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from teamformer.mission.parts.roads import GROUND, Roads

CART = "cart"
SLOWER = 1.5
"""How much longer carts take on a lane."""

LANES = (3.0, 12.0)
"""Seconds that a lane takes, at speed 1."""


@dataclass
class SiteGraph:
    """Places, and the lanes between them: from, to, seconds, and whether a lane is narrow."""

    rng: np.random.Generator
    places: list[str] = field(default_factory=list)
    lanes: list[tuple[int, int, float, bool]] = field(default_factory=list)

    def place(self, name: str) -> int:
        """Add a place; return its number."""
        self.places.append(name)
        return len(self.places) - 1

    def lane(self, begin: int, end: int, is_one_way: bool = False, is_narrow: bool = False) -> None:
        """Add a lane; the way back, if there is one, takes about as long."""
        seconds = float(self.rng.uniform(*LANES))
        self.lanes.append((begin, end, seconds, is_narrow))
        if not is_one_way:
            back = seconds * float(self.rng.uniform(0.9, 1.1))
            self.lanes.append((end, begin, back, is_narrow))

    def roads(self) -> Roads:
        """Return the tables of who walks and of carts."""
        times = {GROUND: self._table(1.0, True), CART: self._table(SLOWER, False)}
        return Roads(tuple(self.places), times)

    def _table(self, factor: float, takes_narrow: bool) -> tuple[tuple[float, ...], ...]:
        rows = np.full((len(self.places), len(self.places)), math.inf)  # (from, to)
        np.fill_diagonal(rows, 0.0)
        for begin, end, seconds, is_narrow in self.lanes:
            if takes_narrow or not is_narrow:
                rows[begin, end] = round(seconds * factor, 1)
        return tuple(map(tuple, rows.tolist()))


def draw_hospital(rng: np.random.Generator) -> SiteGraph:
    """Return wards and rooms along a corridor, and a tunnel back that leads one way.

    Narrow stairs join some wards that lie above one another.
    """
    graph = SiteGraph(rng)
    corridor = [graph.place(f"corridor-{n + 1}") for n in range(int(rng.integers(5, 9)))]
    for one, other in pairwise(corridor):
        graph.lane(one, other)
    graph.lane(corridor[-1], corridor[0], is_one_way=True)
    wards = _rooms(graph, corridor, "ward", int(rng.integers(6, 13)))
    _rooms(graph, corridor, "room", int(rng.integers(3, 7)))
    for _ in range(int(rng.integers(1, 4))):
        one, other = rng.permutation(wards)[:2].tolist()
        graph.lane(one, other, is_narrow=True)
    return graph


def draw_warehouse(rng: np.random.Generator) -> SiteGraph:
    """Return aisles between two cross-aisles, every other one up or down, with shelves along them.

    Narrow lanes lead across.
    """
    graph = SiteGraph(rng)
    aisles = int(rng.integers(4, 8))
    ends = [[graph.place(f"{side}-{n + 1}") for n in range(aisles)] for side in ("south", "north")]
    for row in ends:
        for one, other in pairwise(row):
            graph.lane(one, other)
    shelves = []
    for n in range(aisles):
        way = [ends[0][n], *(graph.place(f"shelf-{n + 1}-{k + 1}") for k in range(3)), ends[1][n]]
        shelves.append(way[1:-1])
        way = way if n % 2 == 0 else way[::-1]
        for one, other in pairwise(way):
            graph.lane(one, other, is_one_way=True)
    for n in range(aisles - 1):
        if n == 0 or rng.random() < 0.5:
            graph.lane(shelves[n][1], shelves[n + 1][1], is_narrow=True)
    return graph


def _rooms(graph: SiteGraph, along: Sequence[int], name: str, count: int) -> list[int]:
    """Add places, each beside one of those along which they lie."""
    rooms = [graph.place(f"{name}-{n + 1}") for n in range(count)]
    for room in rooms:
        graph.lane(along[int(graph.rng.integers(len(along)))], room)
    return rooms
