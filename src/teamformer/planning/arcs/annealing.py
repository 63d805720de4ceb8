"""The search: annealing (Kirkpatrick et al. 1983) without exponentials, clocks or fractions."""

from __future__ import annotations

import numpy as np

from teamformer.jit import entry
from teamformer.planning.arcs.coalition_choice import Choice, empty_choice
from teamformer.planning.arcs.draws import draw_task
from teamformer.planning.arcs.graph import (
    BACK_SUM,
    COST,
    LATE,
    ArcProblem,
    Graph,
    empty_graph,
    lay,
    most_seats,
    near_of,
    pose_arcs,
    read_off,
)
from teamformer.planning.arcs.judging import (
    Trial,
    accept,
    empty_trial,
    sum_up_trial,
    undo,
)
from teamformer.planning.arcs.start import first_plan
from teamformer.planning.arcs.swaps import swap_heads
from teamformer.planning.arcs.task_moves import Moved, move_task, take_back
from teamformer.planning.coalitions.problem import CoalitionProblem
from teamformer.planning.coalitions.search.annealing import SLACKS, STEPS
from teamformer.planning.coalitions.search.schedule import (
    LATENESS,
    SPREAD,
    CoalitionPlan,
    empty_plan,
)
from teamformer.planning.relaxation.insertion import draw_below
from teamformer.rules.arrays import Array

SWAPS = 40  # percent
"""How many of the changes swap the heads of two arcs; the others move a task."""


COOLING, MOST_COOLING = 30, 100
"""Annealings begin at what a task takes a robot on average, divided by the first of these and a
tenth of the tasks, and by the second at most."""

COLDER = 10
"""They end at so many times less."""


def rounds_of_a_second(tasks: int) -> int:
    """Return how many rounds take a second of one core, about."""
    return 440_000_000 // (350 + tasks)


class ArcSearch:
    """A search: the graph where it stands, the best one since it began, and room to work in."""

    def __init__(self, problem: CoalitionProblem, seed: int) -> None:
        self.problem = problem
        self.arcs = pose_arcs(problem, near_of(len(problem.needs)))
        self.graph, self._best = empty_graph(problem), empty_graph(problem)
        self._trial = empty_trial(self.graph)
        most = most_seats(problem)
        self._choice = empty_choice(self.arcs, most)
        self._moved = Moved(np.zeros(3, np.int64), np.zeros(most, np.int64))
        self.random = np.array([(seed * 2654435761 + 88172645463325252) % 2**64], np.uint64)

    def begin_anew(self) -> bool:
        """Make a first plan; say whether every task has an able coalition."""
        if (self.problem.counts.sum(axis=0) < self.problem.needs).any():
            return False
        self.begin_at(first_plan(self.problem, self.arcs, self.graph))
        return True

    def begin_at(self, plan: CoalitionPlan) -> None:
        """Stand at a plan."""
        lay(self.arcs, self.graph, plan, np.zeros(len(self.problem.counts), np.int64))
        copy_graph(self.graph, self._best)

    def begin_at_best(self) -> None:
        """Go back to the best plan."""
        copy_graph(self._best, self.graph)

    @property
    def heats(self) -> tuple[int, int]:
        """Return where an annealing begins and ends: with more tasks it may be colder."""
        hot = self.leg // min(MOST_COOLING, COOLING + len(self.problem.needs) // 10)
        return hot, hot // COLDER

    @property
    def leg(self) -> int:
        """Return the ticks that a task takes a robot on average, with the way there."""
        visits = int(self.graph.nodes.taken.sum())
        return max(1, int(self.graph.total[COST]) * len(self.problem.counts) // visits)

    def anneal(self, hot: int, cold: int, begin: int, end: int, rounds: int) -> None:
        """Make the rounds from `begin` to `end` of so many, from `hot` to `cold`."""
        parts = (self.graph, self._best, self._trial, self._choice, self._moved, self.random)
        anneal_arcs(self.arcs, *parts, SLACKS, self.leg, hot, cold, begin, end, rounds)

    @property
    def cost(self) -> int:
        """Return what the best plan costs."""
        return int(self._best.total[COST])

    @property
    def best(self) -> CoalitionPlan:
        """Return the best plan."""
        plan = empty_plan(self.problem)
        read_off(self.arcs, self._best, plan)
        tasks = len(plan.order)
        plan.order[:] = np.argsort(self._best.nodes.key[:tasks], kind="stable")
        return plan


@entry
def copy_graph(graph: Graph, into: Graph) -> None:
    """Overwrite a graph with another."""
    for index in range(len(graph.nodes)):
        into.nodes[index] = graph.nodes[index]
    for index in range(len(graph.seats)):
        into.seats[index] = graph.seats[index]
    for index in range(len(graph.back)):
        into.back[index] = graph.back[index]
    for index in range(len(graph.total)):
        into.total[index] = graph.total[index]


@entry
def anneal_arcs(
    problem: ArcProblem,
    graph: Graph,
    best: Graph,
    trial: Trial,
    choice: Choice,
    moved: Moved,
    random: Array,
    slacks: Array,
    leg: int,
    hot: int,
    cold: int,
    begin: int,
    end: int,
    rounds: int,
) -> None:
    """Make changes; keep those that are better or, while it is hot, a bit worse."""
    robots, total = len(graph.back), graph.total
    is_best, must_copy = False, False
    for turn in range(begin, end):
        temperature = hot + (cold - hot) * turn // rounds
        slack = temperature * slacks[draw_below(random, len(slacks))] // STEPS
        allowed = total[COST] + slack
        limit = allowed - total[BACK_SUM] // (SPREAD * robots) - LATENESS * total[LATE]
        limit += temperature // 8
        task = draw_task(problem, graph, trial, random)
        is_swap = draw_below(random, 100) < SWAPS
        if is_swap:
            is_short = swap_heads(problem, graph, trial, random, task, limit)
        else:
            is_short = move_task(problem, graph, trial, choice, moved, random, task, leg, limit)
        cost = sum_up_trial(problem, graph, trial) if is_short else 0
        is_kept = is_short and cost <= allowed
        if is_kept and is_best and cost >= total[COST]:
            is_kept, must_copy = False, True  # not yet: the best is written down first
        if is_kept:
            accept(problem, graph, trial, cost)
            is_best = cost < best.total[COST]
            if is_best:
                best.total[COST] = cost
        else:
            undo(graph, trial)
            if not is_swap:
                take_back(problem, graph, moved)
            if must_copy:
                copy_graph(graph, best)
                is_best, must_copy = False, False
    if is_best:
        copy_graph(graph, best)
