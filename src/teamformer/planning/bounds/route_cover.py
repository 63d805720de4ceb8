"""Lower bounds by routes: robots have to bring in time what tasks need, all robots together.

In a plan that takes T steps every robot has a route that ends by then, and all routes together
bring each task what it needs. So whatever prizes are put on what is needed, the most that the
robots can collect in T steps, each for itself, is no less than all prizes together; prizes for
which it is less prove that no plan takes T steps. The best prizes are the duals of a linear
programme, the largest share of all needs that a mix of routes brings. It is solved by column
generation (Dantzig and Wolfe, "Decomposition principle for linear programs", 1960); the proof is
in whole numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from teamformer.base.array_types import Array
from teamformer.mission.model import Mission
from teamformer.mission.parts.grid import Grid
from teamformer.planning.bounds.earliest import earliest_formed
from teamformer.planning.bounds.legs import one_for_each_place
from teamformer.planning.bounds.prize_routes import collect, empty_outlook, look_ahead
from teamformer.planning.bounds.robot_kinds import Kind, robot_kinds, size_of_kinds
from teamformer.planning.bounds.route_mix import RouteMix
from teamformer.planning.problem.relaxed_problem import Relaxed
from teamformer.world.rules.constants import FAR

MEMORIES = (1, 3, 5, 7)
"""How many places a stop remembers: the more, the fewer routes come back, and the slower."""

QUICK, LARGEST = 1e8, 4e8
"""What may be looked at in one go, in legs by memory and time, each about a nanosecond."""

PRIZES = 10**9
"""What all prizes add up to."""

BUILDING = 2e6
"""What it costs to list the stops of a kind of robots, in the same unit."""

GROWTH = 4
"""How much more there is to look at with the next memory."""

MOST_PRICES = 150
"""How often prizes are set for one makespan."""

STEADY = 0.5
"""Weight of the prizes that proved most so far against those that the last mix suggests."""

LEAP = 0.5
"""Share of the steps to go on by that a proof with room to spare suggests."""


def raise_by_routes(
    mission: Mission,
    problem: Relaxed,
    bound: int,
    offer: Callable[[int], None],
    is_over: Callable[[], bool],
    largest: float = LARGEST,
) -> int:
    """Raise a lower bound on the makespan of any policy until nothing more can be proven so.

    Every better bound is offered as it is proven. `problem` is the mission's, of which no task is
    called off. Nothing is tried that has more to look at in one go than `largest`, nor for loads,
    which end elsewhere than they begin. Returns the best bound.
    """
    if problem.carry.any():
        return bound
    kinds, legs = size_of_kinds(problem)
    if BUILDING * kinds + legs * 2 ** MEMORIES[0] * bound > largest:
        return bound
    covers = list(_covers(mission, problem))
    return raise_by_covers(covers, legs * bound, bound, offer, is_over, largest)


def raise_by_covers(
    covers: list[RouteCover],
    legs: float,
    bound: int,
    offer: Callable[[int], None],
    is_over: Callable[[], bool],
    largest: float = LARGEST,
    grain: int = 1,
) -> int:
    """Raise a bound by the routes of covers, of which each needs to be possible.

    `legs` is how much there is to look at where nothing is remembered. Bounds are raised by a
    `grain` at least. Returns the best one.
    """
    for memory in MEMORIES:
        effort = legs * 2**memory
        if is_over() or effort > largest:
            break
        if memory < MEMORIES[-2] and GROWTH * effort <= min(QUICK, largest):
            continue  # to remember more is quick as well, and proves more
        covers.sort(key=lambda one: one.margin, reverse=True)  # those that have proven most
        for cover in covers:
            cover.remember(memory)
            bound = _raise(cover, bound, offer, is_over, largest, grain)
    return bound


def _raise(
    cover: RouteCover,
    bound: int,
    offer: Callable[[int], None],
    is_over: Callable[[], bool],
    largest: float,
    grain: int,
) -> int:
    """Disprove one makespan after the other; after a leap too far go back to the next."""
    while True:
        mix, target = cover.empty_mix(), bound + grain - 1
        while cover.effort(target) <= largest and cover.disprove(target, mix, is_over):
            bound = target + 1
            offer(bound)
            target = bound + max(grain - 1, int(LEAP * cover.margin * target))
        if target == bound + grain - 1:
            return bound


def _covers(mission: Mission, problem: Relaxed) -> Iterator[RouteCover]:
    """Yield what has to be covered, apart for capabilities that no robot links."""
    start = earliest_formed(mission, problem)
    tasks: Array = np.flatnonzero(start < FAR)
    if not isinstance(mission.world, Grid):
        tasks = one_for_each_place(problem, tasks, start)  # to touch is not to be in one place
    is_need = np.zeros_like(problem.needs, dtype=bool)
    is_need[tasks] = problem.needs[tasks] > 0
    for caps in linked_capabilities(problem.counts):
        if is_need[:, caps].any():
            is_theirs = np.zeros(is_need.shape[1], dtype=bool)
            is_theirs[caps] = True
            is_here = is_need & is_theirs
            needs = np.argwhere(is_here)  # (needs, 2) task and capability
            kinds = robot_kinds(mission, problem, start, needs)
            effort = 4.0 + problem.duration[needs[:, 0]]  # (needs,)
            yield RouteCover(problem.needs[is_here], effort, kinds)


def linked_capabilities(counts: Array) -> list[list[int]]:
    """Return capabilities in groups such that no robot has some of two groups.

    `counts` (robots, caps) says what each robot has.
    """
    groups: list[set[int]] = []
    for caps in (set(np.flatnonzero(row).tolist()) for row in counts):
        touched = [group for group in groups if group & caps]
        groups = [group for group in groups if not group & caps]
        groups.append(caps.union(*touched))
    return [sorted(group) for group in groups if group]


class RouteCover:
    """What tasks need, the robots by kind, and the prizes that have proven most so far."""

    def __init__(self, amount: Array, effort: Array, kinds: list[Kind]) -> None:
        """Take how many each need takes, and how much work each of these is about: (needs,)."""
        self.amount = amount.astype(np.int64)  # (needs,)
        self.margin = 0.0  # share of all prizes that the last proof had to spare
        prizes = effort / max(1.0, float((effort * self.amount).sum()))
        self.prizes: Array = prizes  # (needs,) for one of each; times amounts they add up to 1
        self._kinds = kinds

    def remember(self, memory: int) -> None:
        """Let every stop remember so many places."""
        self._kinds = [kind.with_memory(memory) for kind in self._kinds]

    def empty_mix(self) -> RouteMix:
        """Return a mix of no routes."""
        sizes = [kind.sizes for kind in self._kinds]
        return RouteMix(self.amount, np.concatenate([*sizes, np.zeros(0, np.int64)]))

    def effort(self, makespan: int) -> int:
        """Return how much there is to look at to collect prizes once."""
        efforts = (k.stops.carried.size * (1 + k.deadline(makespan)) for k in self._kinds)
        return sum(efforts)

    def disprove(self, makespan: int, mix: RouteMix, is_over: Callable[[], bool]) -> bool:
        """Say whether no plan takes so few steps; a mix learns routes for this or fewer steps."""
        prizes, least = self.prizes, np.inf
        for _ in range(MOST_PRICES):
            if is_over():
                return False
            whole = np.floor(prizes * PRIZES).astype(np.int64)
            most, sum_ = self._collect(whole, makespan, mix), int(whole @ self.amount)
            if most < least * sum_:
                least, self.prizes = most / sum_, prizes
            if most < sum_:
                self.margin = 1 - least
                return True
            suggested = mix.prices()
            if suggested is None:
                return False
            prizes = STEADY * self.prizes + (1 - STEADY) * suggested
        return False

    def _collect(self, prizes: Array, makespan: int, mix: RouteMix) -> int:
        """Return the most that all robots collect, each for itself; add their routes to a mix."""
        total, group = 0, 0
        for kind in self._kinds:
            deadline = kind.deadline(makespan)
            if deadline >= 0:
                outlook = empty_outlook(kind.stops, deadline)
                look_ahead(kind.stops, kind.brings @ prizes, deadline, outlook)
                visits = np.zeros(len(kind.stops.ready), np.int64)
                for number, (size, first) in enumerate(zip(kind.sizes, kind.first, strict=True)):
                    total += int(size) * collect(kind.stops, outlook, first, deadline, visits)
                    mix.add(group + number, visits @ kind.brings)
            group += len(kind.sizes)
        return total
