"""Auctions again and again, each robot bidding by its own timetable alone.

In the style of the consensus-based timetable algorithm (CBTA): robots sign up for tasks so that
each starts as early as it can, and agree task by task on whose offer holds. Written from the idea
as its abstract tells it, not from the authors' code.
"""

from __future__ import annotations

import time

import numpy as np

from teamformer.base.array_types import Ints
from teamformer.bench.peers.peer_plan import PeerPlan, plan_of
from teamformer.planning.problem.coalition_plan import without_spares
from teamformer.planning.problem.coalition_problem import NEVER, CoalitionProblem

Timetable = list[tuple[int, int]]
"""The tasks that a robot has signed up for, with when each starts, in their order."""

NOISE = 0.3
"""By how much of a task's usual length bids of a re-auction are changed at most."""


def auction(problem: CoalitionProblem, seconds: float) -> PeerPlan | None:
    """Return the best plan of auctions that were held in so many seconds.

    The first is fair; in each later one all robots give up what starts after a random moment, and
    offers are changed by chance. None if some task finds no coalition.
    """
    deadline = time.perf_counter() + seconds
    rng = np.random.default_rng(0)
    usual = float(problem.duration.mean() + np.median(problem.ways))
    best: list[Timetable] | None = None
    least = NEVER
    tables: list[Timetable] = [[] for _ in problem.origin]
    while best is None or time.perf_counter() < deadline:
        noise = 0.0 if best is None else NOISE * usual * rng.random()
        held = _hold(problem, tables, noise, rng, deadline if best is not None else None)
        if held is None and best is None:
            return None
        if held is not None:
            over = max(_home(problem, robot, table) for robot, table in enumerate(held))
            if over <= least:
                best, least = held, over
        assert best is not None
        moment = rng.random() * least
        tables = [[entry for entry in table if entry[1] < moment] for table in best]
    starts: dict[int, int] = {}
    coalitions: list[list[int]] = [[] for _ in problem.needs]
    for robot, table in enumerate(best):
        for task, start in table:
            starts[task] = start
            coalitions[task].append(robot)
    rank = {task: place for place, task in enumerate(_signed_in_turn(best, starts))}
    return PeerPlan(plan_of(problem, coalitions, sorted(rank, key=rank.__getitem__)))


def _hold(
    problem: CoalitionProblem,
    kept: list[Timetable],
    noise: float,
    rng: np.random.Generator,
    deadline: float | None,
) -> list[Timetable] | None:
    """Auction all tasks that nobody has signed up for; None if that cannot be, or takes too long.

    A robot's bid is when it could be there, after what it has signed up for. A task's offer is the
    coalition of the earliest bids that brings what is needed; the earliest offer of all holds.
    """
    tables = [list(table) for table in kept]
    taken = {task for table in tables for task, _ in table}
    bids = np.array([_bids(problem, robot, table) for robot, table in enumerate(tables)])
    offers = {
        task: _offer(problem, task, bids) for task in range(len(problem.needs)) if task not in taken
    }
    fee = {task: int(noise * rng.random()) for task in offers}
    while offers:
        if deadline is not None and time.perf_counter() > deadline:
            return None
        task = min(offers, key=lambda each: (offers[each][0] + fee[each], each))
        start, coalition = offers.pop(task)
        if start == NEVER:
            return None
        for robot in coalition:
            tables[robot].append((task, start))
            bids[robot] = _bids(problem, robot, tables[robot])
        outbid = [
            other for other, (_, theirs) in offers.items() if not theirs.isdisjoint(coalition)
        ]
        for other in outbid:
            offers[other] = _offer(problem, other, bids)
    return tables


def _bids(problem: CoalitionProblem, robot: int, table: Timetable) -> Ints:
    """Return when a robot could be at each task after its timetable, as (tasks,)."""
    place, free = int(problem.origin[robot]), 0
    if table:
        place, start = table[-1]
        free = start + int(problem.duration[place])
    ways: Ints = problem.ways[problem.pace[robot], place]
    return free + ways


def _offer(problem: CoalitionProblem, task: int, bids: Ints) -> tuple[int, frozenset[int]]:
    """Return when a task can start and by whom: the earliest bids, without those to spare."""
    left = problem.needs[task].copy()
    chosen: list[int] = []
    for robot in np.argsort(bids[:, task], kind="stable"):
        if (np.minimum(left, problem.counts[robot]) > 0).any():
            chosen.append(int(robot))
            left = np.maximum(0, left - problem.counts[robot])
            if not left.any():
                break
    if left.any():
        return NEVER, frozenset()
    chosen = without_spares(problem.counts, problem.needs[task], chosen)
    return int(bids[chosen, task].max()), frozenset(chosen)


def _home(problem: CoalitionProblem, robot: int, table: Timetable) -> int:
    if not table:
        return int(problem.home[problem.kind[robot], problem.origin[robot]])
    task, start = table[-1]
    return start + int(problem.duration[task] + problem.home[problem.kind[robot], task])


def _signed_in_turn(tables: list[Timetable], starts: dict[int, int]) -> list[int]:
    """Return the tasks in the order of their starts; of equal ones as timetables have them."""
    place = dict.fromkeys(starts, 0)
    for table in tables:
        for number, (task, _) in enumerate(table):
            place[task] = max(place[task], number)
    return sorted(starts, key=lambda task: (starts[task], place[task], task))
