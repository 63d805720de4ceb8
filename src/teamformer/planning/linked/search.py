"""The search: annealing (Kirkpatrick et al. 1983) of a graph in which starts are linked.

Times are whole numbers. What they cost is a sum in floating point, always in the same order, so
that a plan is the same on every machine all the same.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from random import Random
from typing import Any

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import entry, kernel
from teamformer.planning.arcs.annealing import copy_graph
from teamformer.planning.arcs.task_moves import Moved, empty_moved, take_back
from teamformer.planning.graph.arc_problem import RIDE, ArcProblem, most_seats, pose_arcs
from teamformer.planning.graph.graph import Graph, empty_graph, lay, plan_of
from teamformer.planning.graph.judging import ArcChange, undo
from teamformer.planning.linked.candidates import CandidateRoom, empty_room
from teamformer.planning.linked.exchanges import exchange_rests
from teamformer.planning.linked.first_plan import construct
from teamformer.planning.linked.judging import (
    BEST,
    MOST_TIMED,
    NOW,
    THEN,
    TIMED_EACH,
    Ledger,
    Links,
    accept_change,
    begin_change,
    empty_ledger,
    is_better,
    links_of,
    propagate,
    replace_cost,
    room_for_change,
    sum_up_change,
    time_links,
)
from teamformer.planning.linked.moves import move, ride
from teamformer.planning.problem.coalition_plan import CoalitionPlan, with_seats
from teamformer.planning.problem.links import MAX_TARDINESS, TARDINESS, TRAVEL, LinkedProblem
from teamformer.planning.race import Race, search_by_clock
from teamformer.world.rules.chance import SLACKS, STEPS, draw_below

NEAR = 60
"""How many tasks are near to each: more than elsewhere, since who is cheap matters, not who is soon
there, and windows make most near tasks useless at a moment."""

EXCHANGES = 30  # percent
"""How many changes exchange the rests of two robots' ways; the others move tasks."""

LATE = 20  # percent
"""How many changes begin at the latest task, or before it on the way of a robot that does it."""

BACKWARDS = 5
"""How many tasks before the latest one that is at most."""

TRIES = 100
"""How many first plans are begun before nobody is said to be able: linked tasks take robots from
one another."""

HOT, COOLER, COOLINGS = 2, 0.96, 100
"""An annealing begins at what a visit costs on average, times the first of these, and is cooled
down by the second so many times, to a sixtieth."""

QUENCHED = 40
"""Rounds for each task without heat, before the first annealing: what a plan costs then says how
hot it begins."""


class LinkedSearch:
    """A search: the graph where it stands, the best one since it began, and room to work in."""

    def __init__(self, problem: LinkedProblem, seed: int) -> None:
        base = problem.base
        self.problem = problem
        self.arcs = pose_arcs(base, min(len(base.needs) - 1, NEAR))
        self.graph, self._best = empty_graph(base), empty_graph(base)
        self._links, self._ledger = links_of(problem), empty_ledger(problem)
        self._trial = room_for_change(problem, self.graph)
        self._room = empty_room(self.arcs, self._links, len(self.graph.seats))
        self._moved = empty_moved(most_seats(base))
        self._draws = Random(seed)
        self.random = np.array([(seed * 2654435761 + 88172645463325252) % 2**64], np.uint64)

    def begin_anew(self) -> bool:
        """Make a first plan; say whether every task has found an able coalition."""
        for number in range(TRIES):
            plan = construct(self.problem, self._draws if number else None)
            if plan is not None and self.begin_at(plan):
                return True
        return False

    def begin_at(self, plan: CoalitionPlan) -> bool:
        """Stand at a plan; say whether nobody waits in it for ever."""
        parts = (self.arcs, self._links, self.graph, self._trial, self._ledger)
        seated = with_seats(self.problem.base, plan, int(self.arcs.most[0]))
        lay(self.arcs, self.graph, seated, np.zeros(len(self.problem.base.counts), np.int64))
        if not time_links(*parts, MOST_TIMED + TIMED_EACH * len(plan.order)):
            return False
        copy_graph(self.graph, self._best)
        for costs in (self._ledger.cost, self._ledger.lead):
            costs[BEST] = costs[NOW]
        return True

    @property
    def leg(self) -> float:
        """Return what a robot's visit to a task costs on average."""
        return float(self._ledger.lead[NOW]) / int(self.graph.nodes.taken.sum())

    @property
    def ticks(self) -> int:
        """Return the ticks that a visit takes on average, with half of the way to a near task."""
        near = np.take_along_axis(self.arcs.ways[0][: len(self.arcs.near)], self.arcs.near, axis=1)
        way = float(near.mean()) if near.size else 0.0
        return max(1, int(self.problem.base.duration.mean() + way / 2))

    @property
    def heat(self) -> float:
        """Return where an annealing begins."""
        return HOT * self.leg

    def quench(self) -> None:
        """Take whatever is better, without heat, for some rounds."""
        self.anneal(0.0, QUENCHED * len(self.problem.group))

    def anneal(self, heat: float, rounds: int) -> None:
        """Make so many rounds at one heat."""
        parts = (self.graph, self._best, self._trial, self._ledger, self._room, self._moved)
        random = (self.random, SLACKS)
        anneal_links(self.arcs, self._links, *parts, *random, self.ticks, float(heat), rounds)

    def anneal_until(self, deadline: float, race: Race[Any], offer: Callable[[], None]) -> None:
        """Anneal until a moment, or until a race is over; offer whatever is better."""
        hot = self.heat

        def anneal(passed: float, rounds: int) -> None:
            self.anneal(hot * COOLER ** (COOLINGS * passed), rounds)

        search_by_clock(anneal, lambda: self.rank, deadline, race, offer, math.inf)

    @property
    def cost(self) -> float:
        """Return what the best plan costs."""
        return float(self._ledger.cost[BEST])

    @property
    def rank(self) -> tuple[float, float]:
        """Return what the best plan is compared by: its cost, then what leads the search."""
        return self.cost, float(self._ledger.lead[BEST])

    @property
    def best(self) -> CoalitionPlan:
        """Return the best plan."""
        return plan_of(self.problem.base, self.arcs, self._best)


@entry
def anneal_links(
    problem: ArcProblem,
    links: Links,
    graph: Graph,
    best: Graph,
    trial: ArcChange,
    ledger: Ledger,
    room: CandidateRoom,
    moved: Moved,
    random: Array,
    slacks: Array,
    leg: int,
    heat: float,
    rounds: int,
) -> None:
    """Make changes; keep those that are better or, in heat, a bit worse."""
    lead, most = ledger.lead, MOST_TIMED + TIMED_EACH * len(problem.near)
    is_best, must_copy, rides = False, False, problem.habits[RIDE]
    room.heat[0] = heat
    for _ in range(rounds):
        allowed = lead[NOW] + heat * slacks[draw_below(random, len(slacks))] / STEPS
        task = _draw_task(links, graph, ledger, random)
        begin_change(trial, ledger)
        moved.number[0] = 0
        if draw_below(random, 100) < EXCHANGES:
            is_able = exchange_rests(problem, links, graph, trial, ledger, room, random, task)
        elif rides > 0 and draw_below(random, 100) < rides:
            is_able = ride(problem, links, graph, trial, ledger, moved, random, task)
        else:
            is_able = move(problem, links, graph, trial, ledger, room, random, task, leg)
        is_kept = is_able and links.weight[TRAVEL] * ledger.then[TRAVEL] <= allowed
        if is_kept and propagate(problem, links, graph, trial, ledger, most):
            sum_up_change(problem, links, graph, trial, ledger)
            is_kept = lead[THEN] <= allowed
        else:
            is_kept = False
        if is_kept and is_best and not is_better(ledger, THEN, NOW):
            is_kept, must_copy = False, True  # not yet: the best is written down first
        if is_kept:
            accept_change(graph, trial, ledger)
            is_best = is_better(ledger, NOW, BEST)
        else:
            undo(graph, trial)
            take_back(graph, moved)
            if must_copy:
                copy_graph(graph, best)
                replace_cost(ledger, BEST, NOW)
                is_best, must_copy = False, False
    if is_best:
        copy_graph(graph, best)
        replace_cost(ledger, BEST, NOW)


@kernel
def _draw_task(links: Links, graph: Graph, ledger: Ledger, random: Array) -> int:
    """Draw a task: now and then the latest one or one before it, else any."""
    nodes, seats, tasks = graph.nodes, graph.seats, len(links.group)
    task = draw_below(random, tasks)
    latest = ledger.part[MAX_TARDINESS]
    is_counted = links.weight[TARDINESS] > 0 or links.weight[MAX_TARDINESS] > 0
    if latest == 0 or not is_counted or draw_below(random, 100) >= LATE:
        return task
    for _ in range(tasks):
        if nodes[task].end - graph.worth[task].due == latest:
            break
        task = task + 1 if task + 1 < tasks else 0
    for _ in range(draw_below(random, BACKWARDS + 1)):
        before = seats[seats[nodes[task].first + draw_below(random, nodes[task].taken)].prev].node
        if before >= tasks:
            break
        task = before
    return task
