"""Bounds of a coalition problem that take no search, and why they hold.

A chain: no task starts before the last kind of robot that it needs can be there (its head), and
after its end they have a way home (its tail). Work: the robots with a capability have to bring it
everywhere, each time after some way.
All of it stands on ways being as short as possible: closed under going by way of other places.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from teamformer.base.array_types import Ints
from teamformer.planning.problem.coalition_problem import NEVER, NOBODY, CoalitionProblem


class Relaxation(NamedTuple):
    """What holds in every plan."""

    ways: Ints  # (paces, places, tasks) never longer than a detour by other tasks
    home: Ints  # (kinds, places) the same home
    head: Ints  # (tasks,) no earlier start
    tail: Ints  # (tasks,) what is left at least when a task has ended


def relax(problem: CoalitionProblem) -> Relaxation:
    """Work out ways, heads and tails."""
    ways = _shortest(problem)
    home = _shortest_home(problem, ways)
    return Relaxation(ways, home, *_heads_and_tails(problem, ways, home))


def bound_by_chains_and_work(problem: CoalitionProblem, relaxation: Relaxation) -> int:
    """Return ticks that no plan beats."""
    chains = relaxation.head + problem.duration + relaxation.tail
    caps = range(problem.needs.shape[1])
    work = [_work(problem, relaxation, cap) for cap in caps]
    return max([int(chains.max()), _idle_bound(problem, relaxation.home), *work])


def _shortest(problem: CoalitionProblem) -> Ints:
    """Return ways that are never longer than a detour by other tasks (Floyd and Warshall)."""
    ways = problem.ways.copy()
    for task in range(len(problem.needs)):
        np.minimum(ways, ways[:, :, task, None] + ways[:, None, task, :], out=ways)
    return ways


def _shortest_home(problem: CoalitionProblem, ways: Ints) -> Ints:
    """Return ways home that are never longer than a detour by a task."""
    home, tasks = problem.home.copy(), len(problem.needs)
    for kind, robots in enumerate(problem.like):
        by = ways[problem.pace[robots[0]]] + home[kind, :tasks]  # (places, tasks)
        np.minimum(home[kind], by.min(axis=1), out=home[kind])
    return home


def _able(problem: CoalitionProblem, cap: int) -> Ints:
    return np.flatnonzero(problem.counts[:, cap])


def _heads_and_tails(problem: CoalitionProblem, ways: Ints, home: Ints) -> tuple[Ints, Ints]:
    """Return heads and tails, with those of tasks before and after taken in."""
    tasks = len(problem.needs)
    head, tail = problem.release.copy(), np.zeros(tasks, np.int64)
    for cap in range(problem.needs.shape[1]):
        able, needing = _able(problem, cap), problem.needs[:, cap] > 0
        if not needing.any():
            continue
        ready = problem.ready[problem.origin[able] - tasks]  # (able,)
        leave = ready[:, None] + ways[problem.pace[able], problem.origin[able]]
        there = leave.min(axis=0)  # (tasks,)
        back = home[problem.kind[able], :tasks].min(axis=0)
        head[needing] = np.maximum(head, there)[needing]
        tail[needing] = np.maximum(tail, back)[needing]
    for _ in range(tasks if (problem.before[:, 0] != NOBODY).any() else 0):
        for task in range(tasks):
            for other in problem.before[task][problem.before[task] != NOBODY]:
                head[task] = max(head[task], head[other] + problem.duration[other])
                tail[other] = max(tail[other], problem.duration[task] + tail[task])
    return head, tail


def _idle_bound(problem: CoalitionProblem, home: Ints) -> int:
    """Return the longest way home, which the robot has even if it does nothing."""
    ready = problem.ready[problem.origin - len(problem.needs)]
    return int((ready + home[problem.kind, problem.origin]).max(initial=0))


def _work(problem: CoalitionProblem, relaxation: Relaxation, cap: int) -> int:
    """Return the work of a capability, shared out evenly: services, ways there and home.

    Whoever has a long way home may do nothing: it is shared among those with the shortest ways home
    that are over first with it.
    """
    able, tasks = _able(problem, cap), np.flatnonzero(problem.needs[:, cap])
    if not len(tasks):
        return 0
    places = np.concatenate([tasks, np.unique(problem.origin[able])])
    into = relaxation.ways[np.unique(problem.pace[able])][:, places][:, :, tasks].min(axis=0)
    into[np.arange(len(tasks)), np.arange(len(tasks))] = NEVER
    cheapest = problem.duration[tasks] + into.min(axis=0)
    needed = int((problem.needs[tasks, cap] * cheapest).sum())
    counts = problem.counts[able, cap].astype(np.int64)
    back = relaxation.home[problem.kind[able]][:, tasks].min(axis=1)
    order = np.argsort(back, kind="stable")
    done = needed + np.cumsum((counts * back)[order])  # (able,) by so many robots
    return int((-(-done // np.cumsum(counts[order]))).min())
