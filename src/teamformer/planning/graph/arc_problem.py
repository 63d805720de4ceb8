"""A coalition problem as graphs of arcs see it: what does not change while plans are searched."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from teamformer.base.array_types import Int32s, Ints
from teamformer.base.kernels.jit import kernel
from teamformer.planning.graph.covers import list_covers
from teamformer.planning.problem.batteries import Batteries, are_charged
from teamformer.planning.problem.coalition_problem import (
    NEVER,
    NOBODY,
    CoalitionProblem,
    different_rows,
)
from teamformer.planning.problem.constants import TICKS
from teamformer.planning.problem.links import Links, have_weights
from teamformer.planning.problem.misses import can_miss
from teamformer.planning.problem.prices import SHARES, Prices
from teamformer.planning.problem.prices import SMOOTH as SMOOTH_IF_PRICED
from teamformer.planning.problem.rotas import Rotas

Records = np.recarray[Any, np.dtype[np.void]]

KIND = np.dtype([("pace", np.int32), ("type", np.int32), ("lost", np.int64)])

FEWEST_NEAR, MOST_NEAR, NEAR_SHARE = 14, 28, 7
"""How many tasks are near to each: every seventh within these limits."""

NEAR_IF_WEIGHED = 60
"""How many are if plans have a cost: who is cheap matters then, not who is soon there, and windows
make most near tasks useless at a moment."""

ANYWHERE, IN_PLACE, BUNDLE, SMOOTH, SLACK = range(5)
"""Habits of a search: of the moves how many percent are to any moment, in place, or try a bundle;
how many percent the mean end of tasks weighs in steps; by how many ticks chains may be longer than
allowed."""

CONTINUOUS = (5, 0, 0, 0, 0)
STEPS, LARGE_STEPS = (10, 10, 60, 60, 10 * TICKS), (2, 15, 60, 40, 2 * TICKS)
"""The habits in continuous time, in steps, and in steps with a hundred tasks and more."""


class ArcProblem(NamedTuple):
    """What does not change: the places, the kinds of robots, who covers what."""

    ways: Ints  # (paces, places, tasks)
    ways_to: Ints  # (paces, tasks, places + 1) the same, so that all ways to a task lie together;
    # last how long the task takes at least where somebody of the pace takes part
    home: Ints  # (kinds, places)
    site: Int32s  # (places,) the same number for places that lie at the same position
    kinds: Records  # (kinds,) KIND
    origin: Int32s  # (robots,) the place where each starts
    kind: Int32s  # (robots,)
    mixed: Int32s  # (robots,) all robots, those of a kind far from each other
    counts: Int32s  # (types, caps) what robots of each type bring
    needs: Int32s  # (needs, caps) the different needs
    useful: Int32s  # (needs, types) how many of a type a coalition has at most
    covers: Int32s  # (needs, covers, width, 2) types and how many of each, then NOBODY
    listed: Int32s  # (needs,) how many covers are listed; 0 if there are too many
    near: Int32s  # (tasks, near) the tasks nearest to each
    before: Int32s  # (tasks, most) the tasks that must have ended before each, then NOBODY
    after: Int32s  # (tasks, most) the tasks that each must have ended before, then NOBODY
    forming: Ints  # (1,)
    most: Ints  # (1,) seats of each task
    habits: Int32s  # (5,)
    passed: Int32s  # (ways + 1,) of in steps: where the tasks of each way begin in `passes`
    passes: Int32s  # tasks that take time and lie on a way, from the place on
    together: Int32s  # (paces, paces) the pace of those who go together
    weights: Ints  # (5,) in steps: of makespan and ends, the divisor, and if there are prices;
    # last by how much a search may be led on that a task is missed no more, 0 if none can be
    links: Links  # as in the coalition problem
    batteries: Batteries  # as there
    rotas: Rotas  # the same
    bodies: Ints  # (1,) how many kinds of robots have a body; those behind them are permits
    extras: tuple[int, ...]  # empty without batteries, shifts, zones and tasks that can be missed


def near_of(problem: CoalitionProblem) -> int:
    """Return how many tasks are near to each in continuous time."""
    tasks = len(problem.needs)
    if have_weights(problem.links):
        return min(tasks - 1, NEAR_IF_WEIGHED)
    return min(tasks - 1, max(FEWEST_NEAR, min(MOST_NEAR, tasks // NEAR_SHARE)))


class StepRules(NamedTuple):
    """What a mission in steps has beside its coalition problem; robots of a team are in a row."""

    lost: Ints  # (robots,) the step in which each is lost, if that is known; alike in a kind
    together: Int32s  # (paces, paces) the pace of those who go together
    prices: Prices  # if more than the makespan counts
    near: int  # how many tasks are near to each
    is_large: bool  # of a hundred tasks and more
    passed: Int32s  # (ways + 1,) as in ArcProblem
    passes: Int32s


def pose_arcs(problem: CoalitionProblem, steps: StepRules | None = None) -> ArcProblem:
    """Return a coalition problem as one of arcs.

    Robots are of a type if they bring the same; of a kind if they are as fast and go home to the
    same place, too.
    """
    asked = problem.needs.max(axis=0, initial=0) > 0
    _, first = np.unique(problem.kind, return_index=True)
    brings = problem.counts[first][:, asked]  # (kinds, caps)
    first_kind, kind_type = different_rows(brings)
    kinds = np.zeros(len(first), KIND).view(np.recarray)
    kinds.pace, kinds.type = problem.pace[first], kind_type
    kinds.lost = NEVER if steps is None else steps.lost[first]
    needs, _ = different_needs(problem)
    takes = least_durations(problem, steps) + problem.slower  # (paces, tasks)
    counts = brings[first_kind]
    number = np.bincount(kind_type[problem.kind], minlength=len(counts)).astype(np.int32)
    useful, covers, listed = list_covers(counts, number, needs)
    return ArcProblem(
        ways=problem.ways,
        ways_to=np.ascontiguousarray(
            np.concatenate([problem.ways.transpose(0, 2, 1), takes[:, :, None]], axis=2)
        ),
        home=problem.home,
        site=problem.site,
        kinds=kinds,
        origin=problem.origin,
        kind=problem.kind,
        mixed=_mixed(problem),
        counts=np.ascontiguousarray(counts, np.int32),
        needs=needs,
        useful=useful,
        covers=covers,
        listed=listed,
        near=near_tasks(problem, near_of(problem) if steps is None else steps.near),
        before=problem.before,
        after=problem.after,
        forming=problem.forming,
        most=np.array([most_seats(problem)]),
        habits=np.array(_habits(steps), np.int32),
        passed=np.zeros(1, np.int32) if steps is None else steps.passed,
        passes=np.zeros(0, np.int32) if steps is None else steps.passes,
        together=np.zeros((0, 0), np.int32) if steps is None else steps.together,
        weights=_weights(problem, steps),
        links=problem.links,
        batteries=problem.batteries,
        rotas=problem.rotas,
        bodies=np.array([len(set(problem.kind[: problem.bodies].tolist()))]),
        extras=(1,) * has_extras(problem),
    )


def has_extras(problem: CoalitionProblem) -> bool:
    """Say whether somebody has a battery or shifts, there are zones, or tasks can be missed."""
    is_bound = are_charged(problem.batteries) or len(problem.rotas.every) > 0
    return is_bound or can_miss(problem.misses) or problem.bodies < len(problem.counts)


@kernel
def may_have_extras(problem: ArcProblem) -> bool:
    """Say whether a problem has any of these.

    How long a tuple is belongs to its type, so kernels are compiled twice: where this is False what
    is asked only for the others is left out.
    """
    return len(problem.extras) > 0


@kernel
def is_permit(problem: ArcProblem, kind: int) -> bool:
    """Say whether a kind of robots has no body: it is room in a zone."""
    return may_have_extras(problem) and kind >= problem.bodies[0]


@kernel
def is_weighed(problem: ArcProblem) -> bool:
    """Say whether plans are judged by a cost; starts may be linked then."""
    return len(problem.links.weight) > 0


@kernel
def takes_with(problem: ArcProblem, pace: int, task: int) -> int:
    """Return how long a task takes at least where somebody of a pace takes part."""
    return problem.ways_to[pace, task, problem.ways.shape[1]]


def least_durations(problem: CoalitionProblem, steps: StepRules | None = None) -> Ints:
    """Return how long tasks take with the fastest coalition, (tasks,).

    In continuous time what takes no time takes a tick, so that all that follows starts later.
    """
    return np.maximum(problem.duration, 1 if steps is None else 0)


def _weights(problem: CoalitionProblem, steps: StepRules | None) -> Ints:
    """Return the weights of makespan and ends in what a search in steps goes by, and the divisor.

    The ends of tasks only lead the search: so plans of one makespan differ.
    """
    tasks, gains = len(problem.needs), 2 * int(problem.misses.leads.max(initial=0))
    if can_miss(problem.misses):
        gains = max(1, gains)
    if steps is None:
        return np.array([1, 0, 1, 0, gains])
    if len(steps.prices.due) > 0:
        return np.array([steps.prices.whole[0], SMOOTH_IF_PRICED, SHARES * tasks, 1, gains])
    return np.array([100 * tasks, _habits(steps)[SMOOTH], 100 * tasks, 0, gains])


@kernel
def may_miss(problem: ArcProblem) -> bool:
    """Say whether tasks can be missed."""
    return may_have_extras(problem) and problem.weights[4] > 0


def _habits(steps: StepRules | None) -> tuple[int, ...]:
    if steps is None:
        return CONTINUOUS
    return LARGE_STEPS if steps.is_large else STEPS


def _mixed(problem: CoalitionProblem) -> Int32s:
    """Return the first robots of all kinds, then the second ones, and so on."""
    columns = problem.like.T.ravel()
    return columns[columns != NOBODY]


def different_needs(problem: CoalitionProblem) -> tuple[Int32s, Int32s]:
    """Return the different needs, and which of them each task has."""
    asked = problem.needs.max(axis=0, initial=0) > 0
    needs = problem.needs[:, asked]
    first, number = different_rows(needs)
    return np.ascontiguousarray(needs[first]), number


def most_seats(problem: CoalitionProblem) -> int:
    """Return how many robots come to a task at most: all that it may need, and spares."""
    return int(min(len(problem.counts), problem.needs.sum(axis=1).max(initial=1) + problem.spares))


def near_tasks(problem: CoalitionProblem, count: int) -> Int32s:
    """Return the tasks nearest to each, nearest first: `count`, and all that share a zone with it.

    A permit comes from another task of its zone, wherever that is. All have as many near tasks.
    """
    ways, tasks = problem.ways[0], len(problem.needs)
    permits = problem.counts[problem.bodies :].any(axis=0)  # (caps,)
    inside = problem.needs[:, permits] > 0  # (tasks, zones)
    share_zones = (inside.astype(np.int64) @ inside.T.astype(np.int64)) > 0
    count = min(count + int(share_zones.sum(axis=1).max(initial=0)), tasks - 1)
    near = np.zeros((tasks, count), np.int32)
    for task in range(tasks):
        there = ways[task] + ways[:tasks, task]  # there and back: ways may differ by direction
        there[share_zones[task]] = -1
        there[task] = np.iinfo(np.int64).max
        near[task] = np.argsort(there, kind="stable")[:count]
    return near
