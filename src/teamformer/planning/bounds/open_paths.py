"""How long must robots walk to visit places? Bounds from below on sets of open paths.

The bound by spanning trees whose nodes pay for having other than two neighbours (Held and
Karp, "The traveling-salesman problem and minimum spanning trees", 1970), for several paths.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from teamformer.jit import entry

Times = npt.NDArray[np.float64]

LARGEST_EXACT = 12
"""Up to so many places the shortest single path is worked out exactly."""


def shortest_path(legs: Times, ready: Times, duration: Times) -> float:
    """Return the step in which one robot at best ends the last of all tasks.

    `legs` is (places, places); no task starts before `ready` (places,), which includes the way
    from the robot's start. At most LARGEST_EXACT places.
    """
    return float(_finish_all(legs, ready, duration))


def bound_paths(legs: Times, ready: Times, most: int, rounds: int) -> Times:
    """Return bounds on the total length of 1, 2, ... paths that visit every place, as (most,).

    A path that begins at place i costs `ready[i]` before its legs. `legs` is symmetric and
    obeys the triangle inequality. `most` is at most the number of places.
    """
    bounds = np.zeros(most)
    _ascend(legs, ready, bounds, rounds)
    return bounds


def span(legs: Times, ready: Times) -> float:
    """Return the weight of the shortest tree over all places and one start, `ready` from each."""
    weight = np.empty(len(ready))
    _grow_tree(legs, np.zeros(len(ready)), ready, weight, np.empty(len(ready), np.int64))
    return float(weight.sum())


@entry
def _finish_all(legs, ready, duration):  # type: ignore[no-untyped-def]
    """Dynamic programme over subsets: the earliest end of a set with a given last task."""
    count = len(ready)
    end = np.full((1 << count, count), np.inf)
    for last in range(count):
        end[1 << last, last] = ready[last] + duration[last]
    for done in range(1, 1 << count):
        for last in range(count):
            if end[done, last] == np.inf:
                continue
            for task in range(count):
                if not done >> task & 1:
                    start = max(end[done, last] + legs[last, task], ready[task])
                    more = done | 1 << task
                    end[more, task] = min(end[more, task], start + duration[task])
    return end[-1].min()


@entry
def _grow_tree(legs, penalty, rooted, weight, parent):  # type: ignore[no-untyped-def]
    """Grow a shortest spanning tree from a root (Prim 1957): each place's parent and leg.

    Legs are `legs[i, j] + penalty[i] + penalty[j]`, and `rooted[i]` from the root, whose number
    is -1.
    """
    count = len(rooted)
    is_open = np.ones(count, np.bool_)
    weight[:] = rooted
    parent[:] = -1
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
def _ascend(legs, ready, bounds, rounds):  # type: ignore[no-untyped-def]
    """Raise the bounds by subgradient steps on the penalties, steered by the most paths.

    A set of u paths is a forest of u trees plus u beginnings and u endings, in which every place
    has two neighbours, beginnings and endings included. So for any penalties, the
    shortest such forest (the shortest tree less its u - 1 longest legs), the u cheapest
    beginnings (`ready` plus penalty) and the u cheapest endings (penalty), less twice
    all penalties, are no longer than any u paths.
    """
    count, most = len(ready), len(bounds)
    penalty, before = np.zeros(count), np.zeros(count)
    weight, parent = np.empty(count), np.empty(count, np.int64)
    rooted = np.full(count, np.inf)
    stride = 0.0
    for round_ in range(rounds):
        rooted[0] = 0.0  # the tree grows from place 0, which costs nothing
        _grow_tree(legs, penalty, rooted, weight, parent)
        longest = 1 + np.argsort(-weight[1:])
        begins, ends = np.argsort(ready + penalty), np.argsort(penalty)
        total = weight.sum() - 2 * penalty.sum()
        for paths in range(most):
            total += ready[begins[paths]] + penalty[begins[paths]] + penalty[ends[paths]]
            bounds[paths] = max(bounds[paths], total)
            if paths < len(longest):
                total -= weight[longest[paths]]
        if round_ == 0:
            stride = 0.1 * (weight.sum() + ready.min()) / count
        surplus = np.full(count, -2.0)
        for place in longest[most - 1 :]:
            surplus[place] += 1
            surplus[parent[place]] += 1
        surplus[begins[:most]] += 1
        surplus[ends[:most]] += 1
        step = 0.7 * surplus + 0.3 * before
        penalty += stride * step
        before = step
        stride *= 1 - 4 / rounds
