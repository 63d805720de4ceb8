"""Annealing (Kirkpatrick et al. 1983) without exponentials and clocks, the same everywhere.

Costs in which the makespan alone counts are whole numbers. A cost of several parts is a sum in
floating point, always in the same order.
"""

from __future__ import annotations

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import entry, kernel
from teamformer.planning.graph.arc_problem import SLACK, ArcProblem, is_weighed, may_miss
from teamformer.planning.graph.changes import CHAINED, undo
from teamformer.planning.graph.graph import COST, LEADS, MAKESPAN, Graph, counted_makespan
from teamformer.planning.graph.ledger import (
    BEST,
    NOW,
    THEN,
    Ledger,
    accept_change,
    begin_change,
    is_better,
    replace_cost,
    sum_up_change,
    time_all_anew,
    time_change,
)
from teamformer.planning.graph.worth import is_left_out
from teamformer.planning.operators.draws import draw_task
from teamformer.planning.operators.exchanges import exchange_rests
from teamformer.planning.operators.group_moves import move_group
from teamformer.planning.operators.optional_tasks import drop_task, exchange_tasks
from teamformer.planning.operators.riders import ride
from teamformer.planning.operators.state import SearchState
from teamformer.planning.operators.stretches import move_stretch
from teamformer.planning.operators.table import (
    DROP,
    EXCHANGE,
    EXCHANGE_TASKS,
    MOVE_GROUP,
    MOVE_TASK,
    RIDE,
    STRETCH,
    draw_operator,
)
from teamformer.planning.operators.task_moves import move_task
from teamformer.planning.problem.coalition_problem import NEVER, NOBODY
from teamformer.world.rules.chance import STEPS, draw_below


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
    for index in range(len(graph.left)):
        into.left[index] = graph.left[index]
        into.detour[index] = graph.detour[index]


@entry
def anneal(
    problem: ArcProblem,
    search: SearchState,
    best: Graph,
    shares: Array,
    slacks: Array,
    leg: int,
    hot: float,
    cold: float,
    begin: int,
    end: int,
    rounds: int,
) -> None:
    """Make changes; keep those that are better or, while it is hot, a bit worse."""
    graph, trial, ledger, random = search.graph, search.trial, search.ledger, search.random
    is_best, must_copy = False, False
    trial.number[CHAINED] = NOBODY
    for turn in range(begin, end):
        heat = hot + np.floor((cold - hot) * turn / rounds)
        slack = heat * slacks[draw_below(random, len(slacks))] / STEPS
        allowed, limit = _allow(problem, graph, ledger, heat, slack)
        task = draw_task(problem, search)
        begin_change(trial, ledger)
        search.candidates.heat[0] = heat
        number = draw_operator(shares, random)
        is_kept = _change(problem, search, number, task, leg, limit)
        if is_kept and time_change(problem, graph, trial, ledger, limit, allowed):
            sum_up_change(problem, graph, trial, ledger)
            is_kept = ledger.lead[THEN] <= allowed
        else:
            is_kept = False
        if is_kept and is_best and not is_better(ledger, THEN, NOW):
            is_kept, must_copy = False, True  # not yet: the best is written down first
        if is_kept:
            accept_change(problem, graph, trial, ledger)
            is_best = is_better(ledger, NOW, BEST)
        else:
            undo(graph, trial)
            if must_copy:
                _write_down(problem, graph, best, ledger)
                trial.number[CHAINED] = NOBODY  # in steps writing down corrects times
                is_best, must_copy = False, False
    if is_best:
        _write_down(problem, graph, best, ledger)


@kernel
def _change(
    problem: ArcProblem, search: SearchState, number: int, task: int, leg: int, limit: int
) -> bool:
    """Have an operator change the graph around a task; say whether it did.

    A task that is left out can only be put in.
    """
    graph = search.graph
    if may_miss(problem):
        is_out = is_left_out(problem, graph, task)
        is_fixed = not graph.worth[task].is_optional
        if is_out or (is_fixed and number <= EXCHANGE_TASKS):
            number = MOVE_GROUP if is_weighed(problem) else MOVE_TASK
        elif number == DROP:
            return drop_task(problem, search, task, leg, limit)
        elif number == EXCHANGE_TASKS:
            return exchange_tasks(problem, search, task, leg, limit)
    if number == RIDE:
        return ride(problem, search, task, leg, limit)
    if number == STRETCH:
        return move_stretch(problem, search, task, leg, limit)
    if number == EXCHANGE:
        return exchange_rests(problem, search, task, leg, limit)
    if number == MOVE_GROUP:
        return move_group(problem, search, task, leg, limit)
    return move_task(problem, search, task, leg, limit)


@kernel
def _allow(
    problem: ArcProblem, graph: Graph, ledger: Ledger, heat: float, slack: float
) -> tuple[float, int]:
    """Return what the next change may cost, and how long a chain may be then."""
    if is_weighed(problem):
        return ledger.lead[NOW] + slack, NEVER  # a longer chain may cost less
    allowed, total = ledger.lead[NOW] + np.floor(slack), graph.total
    if problem.weights[3]:
        return allowed, NEVER
    spread = total[COST] - counted_makespan(problem, graph, total[MAKESPAN], total[LEADS])
    gains = problem.weights[4]
    return allowed, np.int64(allowed) - spread + np.int64(heat) // 8 + problem.habits[SLACK] + gains


@kernel
def _write_down(problem: ArcProblem, graph: Graph, best: Graph, ledger: Ledger) -> None:
    """Overwrite the best plan with one that is better, and is so when all is timed anew."""
    time_all_anew(problem, graph, ledger)
    if is_better(ledger, NOW, BEST):
        copy_graph(graph, best)
        replace_cost(ledger, BEST, NOW)
