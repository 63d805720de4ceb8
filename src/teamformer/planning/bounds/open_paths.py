"""How long must robots walk to visit places? Bounds from below on sets of open paths.

The bound by spanning trees whose nodes pay for having other than two neighbours (Held and
Karp, "The traveling-salesman problem and minimum spanning trees", 1970), for several paths.
"""

from __future__ import annotations

import numpy as np

from teamformer.base.array_types import Array, Floats
from teamformer.base.kernels.jit import entry, kernel
from teamformer.world.rules.sorting import sort_indices


def bound_paths(legs: Floats, ready: Floats, most: int, rounds: int) -> Floats:
    """Return bounds on the total length of 1, 2, ... paths that visit every place, as (most,).

    A path that begins at place i costs `ready[i]` before its legs. `legs` is symmetric and
    obeys the triangle inequality. `most` is at most the number of places.
    """
    bounds = np.zeros(most)
    _ascend(legs, ready, bounds, rounds)
    return bounds


def span(legs: Floats, ready: Floats) -> float:
    """Return the weight of the shortest tree over all places and one start, `ready` from each."""
    weight = np.empty(len(ready))
    _span(legs, np.zeros(len(ready)), ready, weight, np.empty(len(ready), np.int64))
    return float(weight.sum())


@entry
def _span(legs: Floats, penalty: Floats, rooted: Floats, weight: Floats, parent: Array) -> None:
    _grow_tree(legs, penalty, rooted, weight, parent, np.empty(len(rooted), np.bool_))


@kernel
def _grow_tree(
    legs: Floats,
    penalty: Floats,
    rooted: Floats,
    weight: Floats,
    parent: Array,
    is_open: Array,
) -> None:
    """Grow a shortest spanning tree from a root (Prim 1957): each place's parent and leg.

    Legs are `legs[i, j] + penalty[i] + penalty[j]`, and `rooted[i]` from the root, whose number
    is -1. `is_open` (places,) is room to work in.
    """
    count = len(rooted)
    for place in range(count):
        weight[place], parent[place], is_open[place] = rooted[place], -1, True
    for _ in range(count):
        nearest = -1
        for place in range(count):
            if is_open[place] and (nearest < 0 or weight[place] < weight[nearest]):
                nearest = place
        is_open[nearest] = False
        for place in range(count):
            leg = legs[nearest, place] + penalty[nearest] + penalty[place]
            if is_open[place] and leg < weight[place]:
                weight[place] = leg
                parent[place] = nearest


@entry
def _ascend(legs: Floats, ready: Floats, bounds: Floats, rounds: int) -> None:
    """Raise the bounds by subgradient steps on the penalties, steered by the most paths.

    A set of u paths is a forest of u trees plus u beginnings and u endings, in which every place
    has two neighbours, beginnings and endings included. So for any penalties, the
    shortest such forest (the shortest tree less its u - 1 longest legs), the u cheapest
    beginnings (`ready` plus penalty) and the u cheapest endings (penalty), less twice
    all penalties, are no longer than any u paths.
    """
    count, most = len(ready), len(bounds)
    penalty, before, surplus = np.empty(count), np.empty(count), np.empty(count)
    weight, rooted, begin_cost = np.empty(count), np.empty(count), np.empty(count)
    parent, longest = np.empty(count, np.int64), np.empty(count, np.int64)
    begins, ends = np.empty(count, np.int64), np.empty(count, np.int64)
    spare, is_open = np.empty(count, np.int64), np.empty(count, np.bool_)
    soonest = ready[0]
    for place in range(count):
        penalty[place] = before[place] = 0.0
        rooted[place] = np.inf
        soonest = min(soonest, ready[place])
    rooted[0] = 0.0  # the tree grows from place 0, which costs nothing
    stride = 0.0
    for round_ in range(rounds):
        _grow_tree(legs, penalty, rooted, weight, parent, is_open)
        tree = paid = 0.0
        for place in range(count):
            begin_cost[place] = ready[place] + penalty[place]
            tree += weight[place]
            paid += penalty[place]
        total = tree - 2 * paid
        _sort_backwards(weight, longest, surplus, spare)  # the root comes last: its leg is 0
        sort_indices(begin_cost, begins, spare)
        sort_indices(penalty, ends, spare)
        for paths in range(most):
            total += ready[begins[paths]] + penalty[begins[paths]] + penalty[ends[paths]]
            bounds[paths] = max(bounds[paths], total)
            if paths < count - 1:
                total -= weight[longest[paths]]
        if round_ == 0:
            stride = 0.1 * (tree + soonest) / count
        _count_neighbours(surplus, parent, longest, begins, ends, most)
        for place in range(count):
            before[place] = 0.7 * surplus[place] + 0.3 * before[place]
            penalty[place] += stride * before[place]
        stride *= 1 - 4 / rounds


@kernel
def _sort_backwards(weight: Floats, order: Array, keys: Floats, spare: Array) -> None:
    """Write places from the longest leg to the shortest, place 0 behind all; `keys` is room."""
    keys[0] = np.inf
    for place in range(1, len(weight)):
        keys[place] = -weight[place]
    sort_indices(keys, order, spare)


@kernel
def _count_neighbours(
    surplus: Floats, parent: Array, longest: Array, begins: Array, ends: Array, most: int
) -> None:
    """Write how many neighbours more than two each place has in the forest of so many paths."""
    for place in range(len(surplus)):
        surplus[place] = -2.0
    for rank in range(most - 1, len(surplus) - 1):
        surplus[longest[rank]] += 1
        surplus[parent[longest[rank]]] += 1
    for rank in range(most):
        surplus[begins[rank]] += 1
        surplus[ends[rank]] += 1
