"""The search: annealing (Kirkpatrick et al. 1983) without exponentials, clocks or fractions."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import entry, kernel
from teamformer.planning.arcs.coalition_choice import Choice, empty_choice
from teamformer.planning.arcs.draws import draw_task
from teamformer.planning.arcs.members import replace_member
from teamformer.planning.arcs.riders import ride
from teamformer.planning.arcs.start import first_plan
from teamformer.planning.arcs.stretches import move_stretch
from teamformer.planning.arcs.swaps import swap_heads
from teamformer.planning.arcs.task_moves import Moved, empty_moved, move_task, take_back
from teamformer.planning.graph.arc_problem import (
    REPLACE,
    RIDE,
    SLACK,
    STRETCH,
    SWAP,
    ArcProblem,
    StepRules,
    most_seats,
    near_of,
    pose_arcs,
)
from teamformer.planning.graph.graph import (
    AIM,
    COST,
    MAKESPAN,
    Graph,
    empty_graph,
    is_in_steps,
    lay,
    plan_of,
    time_anew,
)
from teamformer.planning.graph.judging import (
    AIMED,
    CHAINED,
    ArcChange,
    accept,
    empty_trial,
    sum_up_trial,
    undo,
)
from teamformer.planning.problem.coalition_plan import CoalitionPlan, with_seats
from teamformer.planning.problem.coalition_problem import NEVER, NOBODY, CoalitionProblem
from teamformer.planning.race import Race, search_by_clock
from teamformer.world.rules.chance import SLACKS, STEPS, draw_below

HOT, COLD = 20, 800
"""An annealing begins and ends at what a task takes a robot on average, divided by these."""

FEW_TASKS, HOT_IF_FEW, COLD_IF_FEW = 30, 8, 80
"""With fewer tasks than the first of these it is divided by the others: one moved task changes more
of a small plan, so that more has to get worse before it gets better."""

ROUNDS_EACH, FEW_ANNEALINGS = 9_000, 2
"""The shared plan of few tasks takes so many rounds for each task, so many times."""


def has_few_tasks(tasks: int) -> bool:
    """Say whether a problem of so many tasks is so small that it is searched hotter."""
    return tasks < FEW_TASKS


def rounds_of_a_second(tasks: int) -> int:
    """Return how many rounds take a second of one core, about."""
    return 440_000_000 // (350 + tasks)


def shared_annealings(tasks: int) -> list[int]:
    """Return how many rounds each annealing of the shared plan of so many tasks has."""
    if has_few_tasks(tasks):
        return [ROUNDS_EACH * tasks] * FEW_ANNEALINGS
    return [rounds_of_a_second(tasks)]


class ArcSearch:
    """A search: the graph where it stands, the best one since it began, and room to work in."""

    def __init__(
        self, problem: CoalitionProblem, seed: int, steps: StepRules | None = None
    ) -> None:
        self.problem = problem
        near = near_of(len(problem.needs)) if steps is None else steps.near
        self.arcs = pose_arcs(problem, near, steps)
        self.graph, self._best = empty_graph(problem, steps), empty_graph(problem, steps)
        self._trial = empty_trial(self.graph)
        most = most_seats(problem)
        self._choice = empty_choice(self.arcs, most)
        self._moved = empty_moved(most)
        self.random = np.array([(seed * 2654435761 + 88172645463325252) % 2**64], np.uint64)

    def begin_anew(self) -> bool:
        """Make a first plan; say whether every task has an able coalition."""
        if (self.problem.counts.sum(axis=0) < self.problem.needs).any():
            return False
        self.begin_at(first_plan(self.problem, self.arcs, self.graph))
        return True

    def begin_at(self, plan: CoalitionPlan) -> None:
        """Stand at a plan; who can be spared is left out where there are not enough seats."""
        seated = with_seats(self.problem, plan, int(self.arcs.most[0]))
        lay(self.arcs, self.graph, seated, np.zeros(len(self.problem.counts), np.int64))
        copy_graph(self.graph, self._best)

    def begin_at_best(self) -> None:
        """Go back to the best plan."""
        copy_graph(self._best, self.graph)

    @property
    def heats(self) -> tuple[int, int]:
        """Return where an annealing begins and ends."""
        is_few = has_few_tasks(len(self.problem.needs))
        hot, cold = (HOT_IF_FEW, COLD_IF_FEW) if is_few else (HOT, COLD)
        return self.leg // hot, self.leg // cold

    @property
    def leg(self) -> int:
        """Return the ticks that a task takes a robot on average, with the way there."""
        visits = int(self.graph.nodes.taken.sum())
        return max(1, int(self.graph.total[COST]) * len(self.problem.counts) // visits)

    def anneal(self, hot: int, cold: int, begin: int, end: int, rounds: int) -> None:
        """Make the rounds from `begin` to `end` of so many, from `hot` to `cold`."""
        parts = (self.graph, self._best, self._trial, self._choice, self._moved, self.random)
        anneal_arcs(self.arcs, *parts, SLACKS, self.leg, hot, cold, begin, end, rounds)

    def anneal_until(
        self,
        deadline: float,
        race: Race[Any],
        offer: Callable[[], None],
        heats: tuple[int, int],
        rounds: float = math.inf,
    ) -> None:
        """Anneal from one heat to another until `time.perf_counter` shows the deadline.

        The end of the race or so many rounds end it sooner. Each better plan is offered.
        """
        hot, cold = heats

        def anneal(passed: float, rounds: int) -> None:
            heat = hot + int((cold - hot) * passed)
            self.anneal(heat, heat, 0, rounds, rounds)

        search_by_clock(anneal, lambda: self.rank, deadline, race, offer, rounds)

    @property
    def rank(self) -> tuple[int, int]:
        """Return what the best plan is compared by: its aim, then its cost."""
        return int(self._best.total[AIM]), int(self._best.total[COST])

    @property
    def best(self) -> CoalitionPlan:
        """Return the best plan."""
        return plan_of(self.problem, self.arcs, self._best)


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
    for index in range(len(graph.comes)):
        into.comes[index] = graph.comes[index]


@entry
def anneal_arcs(
    problem: ArcProblem,
    graph: Graph,
    best: Graph,
    trial: ArcChange,
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
    total, habits = graph.total, problem.habits
    is_best, must_copy = False, False
    trial.number[CHAINED] = NOBODY
    for turn in range(begin, end):
        temperature = hot + (cold - hot) * turn // rounds
        slack = temperature * slacks[draw_below(random, len(slacks))] // STEPS
        allowed = total[COST] + slack
        limit = allowed - (total[COST] - total[MAKESPAN]) + temperature // 8 + habits[SLACK]
        if problem.weights[3]:
            limit = NEVER  # a longer chain may cost less
        task = draw_task(problem, graph, trial, random)
        what, moved.number[0] = draw_below(random, 100), 0
        if what < habits[SWAP]:
            is_short = swap_heads(problem, graph, trial, random, task, limit)
        elif what < habits[SWAP] + habits[REPLACE]:
            is_short = replace_member(problem, graph, trial, choice, moved, random, task, limit)
        elif what < habits[SWAP] + habits[REPLACE] + habits[RIDE]:
            is_short = ride(problem, graph, trial, moved, random, task, limit)
        elif what < habits[SWAP] + habits[REPLACE] + habits[RIDE] + habits[STRETCH]:
            is_short = move_stretch(problem, graph, trial, moved, random, task, limit)
        else:
            is_short = move_task(problem, graph, trial, choice, moved, random, task, leg, limit)
        cost = sum_up_trial(problem, graph, trial) if is_short else 0
        is_kept = is_short and cost <= allowed
        if is_kept and is_best and not is_less(trial.number[AIMED], cost, total[AIM], total[COST]):
            is_kept, must_copy = False, True  # not yet: the best is written down first
        if is_kept:
            accept(problem, graph, trial, cost)
            is_best = is_less(total[AIM], cost, best.total[AIM], best.total[COST])
        else:
            undo(graph, trial)
            take_back(graph, moved)
            if must_copy:
                write_down(problem, graph, best)
                trial.number[CHAINED] = NOBODY  # in steps writing down corrects times
                is_best, must_copy = False, False
    if is_best:
        write_down(problem, graph, best)


@kernel
def write_down(problem: ArcProblem, graph: Graph, best: Graph) -> None:
    """Overwrite the best plan with one that is better.

    In steps what was timed as it changed may be a bit off, so that all is timed anew before.
    """
    if is_in_steps(graph):
        time_anew(problem, graph)
        now, least = graph.total, best.total
        if not is_less(now[AIM], now[COST], least[AIM], least[COST]):
            return
    copy_graph(graph, best)


@kernel
def is_less(aim: int, cost: int, other_aim: int, other_cost: int) -> bool:
    """Say whether a plan is better than another: by its aim, and by its cost if these are equal."""
    return aim < other_aim or (aim == other_aim and cost < other_cost)
