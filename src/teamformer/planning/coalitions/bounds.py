"""Lower bounds on the makespan of a coalition problem, and why they hold.

A chain: no task starts before the last kind of robot that it needs can be there (its head), and
after its end they have a way home (its tail). Work: the robots with a capability have to bring it
everywhere, each time after some way. Tours: if all is done by a time, then the robots with a
capability have tours through the tasks that need it, each task within its head and tail; whether
they have is found by dynamic programming over sets of tasks, and the time by bisection.

All of it stands on ways being as short as possible: closed under going by way of other places.
"""

from __future__ import annotations

import math
import time
from typing import NamedTuple

import numpy as np

from teamformer.jit import entry
from teamformer.planning.coalitions.problem import NOBODY, CoalitionProblem, Ticks

MOST_TASKS_A_TOUR = 15
"""Sets of more tasks are too many; the tours of those that need most time are bounded instead."""

FAR = 2**60


class Windows(NamedTuple):
    """When tasks can be done at all."""

    head: Ticks  # (tasks,) no earlier start
    tail: Ticks  # (tasks,) what is left at least when a task has ended


def bound_makespan(problem: CoalitionProblem, upper: int, seconds: float = math.inf) -> int:
    """Return ticks that no plan beats; `upper` is the makespan of a plan, or more.

    Tours are not looked at any more when the seconds are over.
    """
    deadline = time.perf_counter() + seconds
    ways = _shortest(problem)  # (paces, places, tasks)
    windows = _windows(problem)
    bound = max(int((windows.head + problem.duration + windows.tail).max()), _idle_bound(problem))
    caps = range(problem.needs.shape[1])
    bound = max([bound, *(_work(problem, ways, cap) for cap in caps)])
    for cap in sorted(caps, key=lambda cap: -_work(problem, ways, cap)):
        if time.perf_counter() > deadline:
            break
        bound = _raise_by_tours(problem, ways, windows, cap, bound, upper)
    return min(bound, upper)


def _shortest(problem: CoalitionProblem) -> Ticks:
    """Return ways that are never longer than a detour by other tasks (Floyd and Warshall)."""
    ways = problem.ways.copy()
    for task in range(len(problem.needs)):
        np.minimum(ways, ways[:, :, task, None] + ways[:, None, task, :], out=ways)
    return ways


def _able(problem: CoalitionProblem, cap: int) -> Ticks:
    return np.flatnonzero(problem.counts[:, cap])


def _windows(problem: CoalitionProblem) -> Windows:
    """Return heads and tails, with those of tasks before and after taken in."""
    ways, tasks = _shortest(problem), len(problem.needs)
    head, tail = problem.release.copy(), np.zeros(tasks, np.int64)
    for cap in range(problem.needs.shape[1]):
        able, needing = _able(problem, cap), problem.needs[:, cap] > 0
        if not needing.any():
            continue
        there = ways[problem.pace[able], problem.origin[able]].min(axis=0)  # (tasks,)
        back = problem.home[problem.kind[able], :tasks].min(axis=0)
        head[needing] = np.maximum(head, there)[needing]
        tail[needing] = np.maximum(tail, back)[needing]
    for _ in range(tasks if (problem.before[:, 0] != NOBODY).any() else 0):
        for task in range(tasks):
            for other in problem.before[task][problem.before[task] != NOBODY]:
                head[task] = max(head[task], head[other] + problem.duration[other])
                tail[other] = max(tail[other], problem.duration[task] + tail[task])
    return Windows(head, tail)


def _idle_bound(problem: CoalitionProblem) -> int:
    """Return the longest way straight home, which the robot has even if it does nothing."""
    return int(problem.home[problem.kind, problem.origin].min(initial=0))


def _work(problem: CoalitionProblem, ways: Ticks, cap: int) -> int:
    """Return the work of a capability, shared out evenly: services, ways there and home."""
    able, tasks = _able(problem, cap), np.flatnonzero(problem.needs[:, cap])
    if not len(tasks):
        return 0
    places = np.concatenate([tasks, np.unique(problem.origin[able])])
    into = ways[np.unique(problem.pace[able])][:, places][:, :, tasks].min(axis=0)
    into[np.arange(len(tasks)), np.arange(len(tasks))] = FAR
    cheapest = problem.duration[tasks] + into.min(axis=0)
    needed = int((problem.needs[tasks, cap] * cheapest).sum())
    counts = problem.counts[able, cap].astype(np.int64)
    back = problem.home[problem.kind[able]][:, tasks].min(axis=1)
    return -(-(needed + int((counts * back).sum())) // int(counts.sum()))


def _raise_by_tours(
    problem: CoalitionProblem, ways: Ticks, windows: Windows, cap: int, bound: int, upper: int
) -> int:
    """Return the least time, of those from `bound` to `upper`, that leaves room for the tours."""
    able, tasks = _able(problem, cap), np.flatnonzero(problem.needs[:, cap])
    if len(tasks) < 2:
        return bound
    urgent = problem.duration + windows.head + windows.tail
    tasks = tasks[np.argsort(-urgent[tasks], kind="stable")][:MOST_TASKS_A_TOUR]
    between = ways[np.unique(problem.pace[able])][:, tasks][:, :, tasks].min(axis=0)
    head, tail, duration = windows.head[tasks], windows.tail[tasks], problem.duration[tasks]
    ends = np.zeros((1 << len(tasks), len(tasks)), np.int64)
    tours = np.zeros(1 << len(tasks), np.int8)
    least, most = bound, upper
    while least < most:
        time = (least + most) // 2
        if count_tours(between, duration, head, time - tail, ends, tours) <= len(able):
            most = time
        else:
            least = time + 1
    return least


@entry
def count_tours(between, duration, head, latest, ends, tours):  # type: ignore[no-untyped-def]
    """Return how many robots are needed to end every task by its latest time.

    Held and Karp's recurrence: `ends[set, task]` is the earliest end of a tour through a set of
    tasks with that task last. `tours[set]` is the least number of tours through a set.
    """
    tasks = len(duration)
    sets = 1 << tasks
    for some in range(1, sets):
        is_possible = False
        for last in range(tasks):
            ends[some, last] = FAR
            if not some >> last & 1:
                continue
            rest = some ^ (1 << last)
            best = head[last] if rest == 0 else FAR
            for other in range(tasks):
                if rest >> other & 1 and ends[rest, other] < FAR:
                    best = min(best, max(head[last], ends[rest, other] + between[other, last]))
            if best < FAR and best + duration[last] <= latest[last]:
                ends[some, last] = best + duration[last]
                is_possible = True
        tours[some] = 1 if is_possible else 127
    for some in range(1, sets):
        if tours[some] == 1:
            continue
        low = some & -some
        rest = some ^ low
        part = rest
        fewest = 127
        while True:  # every tour through the first task of the set
            if tours[part | low] == 1 and tours[rest ^ part] + 1 < fewest:
                fewest = tours[rest ^ part] + 1
            if part == 0:
                break
            part = (part - 1) & rest
        tours[some] = fewest
    return tours[sets - 1]
