"""A change of arcs, made in place: a log keeps what was before, an agenda what is to be timed.

Tasks whose arcs in have changed are on the agenda, by their keys. A change that is refused is
undone from the log.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from teamformer.base.array_types import Int32s, Ints
from teamformer.base.kernels.jit import kernel
from teamformer.planning.graph.arc_problem import Records
from teamformer.planning.graph.graph import Graph, is_in_steps
from teamformer.planning.problem.coalition_problem import NOBODY

ENTRY = np.dtype([("what", np.int32), ("index", np.int32), ("old", np.int64)])
WAITING = np.dtype([("key", np.int64), ("task", np.int64)])

PREV, NEXT, END, BACK, COMES, KIND, KEY, TAKEN, DURATION, LEFT, DETOUR = range(11)
"""What an entry of the log has changed."""

ARRIVING, PARTING = 1, 2
"""What is to be worked out of a node on the agenda: its start, or in steps also who leaves when."""

LOGGED, WAITS, HOMES, PAST, COMES_BY, LEAVES_BY, CHAINED = range(7)
"""Numbers of a trial: entries in the log, tasks on the agenda, homes to be timed, and the highest
key of a node whose arcs out, or duration, have changed: behind it tails still hold; the seats by
which what the makespan hangs on comes to the task at hand and leaves it, or NOBODY; and the
length of the chain, or NOBODY if the plan has changed since it was listed."""


class ArcChange(NamedTuple):
    """A change at hand."""

    number: Ints  # (7,)
    total: Ints  # (9,) what is known of the graph with it, as in there
    log: Records  # ENTRY
    agenda: Records  # (tasks + 1,) WAITING, latest first
    homes: Int32s  # (robots,) homes whose arc in, or its begin, has changed
    is_listed: Int32s  # (robots,) whether a home is among them
    chain: Int32s  # (tasks, 3) tasks that the makespan hangs on, each with COMES_BY and LEAVES_BY


def empty_trial(graph: Graph, timed_again: int = 0) -> ArcChange:
    """Return room for a change; `timed_again` is how often tasks may be timed more than once."""
    room = 10 * len(graph.seats) + 5 * len(graph.nodes) + len(graph.back) + timed_again
    room += 4 * len(graph.left)
    number = np.zeros(7, np.int64)
    number[CHAINED] = NOBODY
    return ArcChange(
        number=number,
        total=np.zeros_like(graph.total),
        log=np.zeros(room, ENTRY).view(np.recarray),
        agenda=np.zeros(len(graph.nodes) + 1, WAITING).view(np.recarray),
        homes=np.zeros(len(graph.back), np.int32),
        is_listed=np.zeros(len(graph.back), np.int32),
        chain=np.zeros((len(graph.order), 3), np.int32),
    )


@kernel
def begin_trial(trial: ArcChange) -> None:
    """Begin a change."""
    trial.number[LOGGED] = 0
    trial.number[WAITS] = 0
    trial.number[HOMES] = 0
    trial.number[PAST] = -1


@kernel
def record(trial: ArcChange, what: int, index: int, old: int) -> None:
    """Write into the log what something was before."""
    entry = trial.number[LOGGED]
    trial.log[entry].what = what
    trial.log[entry].index = index
    trial.log[entry].old = old
    trial.number[LOGGED] = entry + 1


@kernel
def remember(graph: Graph, trial: ArcChange, task: int) -> None:
    """Note the key of a task and the kinds of its robots before they change."""
    node = graph.nodes[task]
    record(trial, KEY, task, node.key)
    record(trial, TAKEN, task, node.taken)
    for seat in range(node.first, node.first + node.taken):
        record(trial, KIND, seat, graph.seats[seat].kind)


@kernel
def connect(graph: Graph, trial: ArcChange, seat: int, to: int) -> None:
    """Lead the arc that leaves a seat to another; what comes after it will be timed."""
    seats, nodes = graph.seats, graph.nodes
    record(trial, NEXT, seat, seats[seat].next)
    record(trial, PREV, to, seats[to].prev)
    seats[seat].next = to
    seats[to].prev = seat
    trial.number[PAST] = max(trial.number[PAST], nodes[seats[seat].node].key)
    follow(graph, trial, to)
    if is_in_steps(graph):
        node = seats[seat].node
        if not nodes[node].is_waiting:
            wait(graph, trial, node, nodes[node].key)
        nodes[node].is_waiting = PARTING


@kernel
def follow(graph: Graph, trial: ArcChange, seat: int) -> None:
    """Have the task or home of a seat timed."""
    node = graph.seats[seat].node
    if node == len(graph.nodes) - 1:
        robot = seat - (len(graph.seats) - len(graph.back))
        if not trial.is_listed[robot]:
            trial.is_listed[robot] = 1
            trial.homes[trial.number[HOMES]] = robot
            trial.number[HOMES] += 1
    elif not graph.nodes[node].is_waiting:
        wait(graph, trial, node, graph.nodes[node].key)


@kernel
def wait(graph: Graph, trial: ArcChange, task: int, key: int) -> None:
    """Put a task on the agenda: it is short, so that room is made by shifting."""
    agenda, place = trial.agenda, trial.number[WAITS]
    while place > 0 and agenda[place - 1].key < key:
        agenda[place].key = agenda[place - 1].key
        agenda[place].task = agenda[place - 1].task
        place -= 1
    agenda[place].key = key
    agenda[place].task = task
    trial.number[WAITS] += 1
    graph.nodes[task].is_waiting = ARRIVING


@kernel
def undo(graph: Graph, trial: ArcChange) -> None:
    """Make all as it was before the change."""
    number, seats = trial.number, graph.seats
    for place in range(number[WAITS]):
        graph.nodes[trial.agenda[place].task].is_waiting = 0
    for index in range(number[HOMES]):
        trial.is_listed[trial.homes[index]] = 0
    for entry in range(number[LOGGED] - 1, -1, -1):
        index, old = trial.log[entry].index, trial.log[entry].old
        if trial.log[entry].what == END:
            graph.nodes[index].end = old
        elif trial.log[entry].what == NEXT:
            seats[index].next = old
        elif trial.log[entry].what == PREV:
            seats[index].prev = old
        elif trial.log[entry].what == COMES:
            graph.comes[index] = old
        elif trial.log[entry].what == KIND:
            seats[index].kind = old
        elif trial.log[entry].what == KEY:
            graph.nodes[index].key = old
        elif trial.log[entry].what == TAKEN:
            graph.nodes[index].taken = old
        elif trial.log[entry].what == DURATION:
            graph.nodes[index].duration = old
        elif trial.log[entry].what == LEFT:
            graph.left[index] = old
        elif trial.log[entry].what == DETOUR:
            graph.detour[index] = old
        else:
            graph.back[index] = old
