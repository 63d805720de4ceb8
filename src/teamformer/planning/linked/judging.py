"""Times and costs of a graph in which starts are linked, worked out only as far as they change.

Tasks that are linked are timed together: each when its robots are there, then later where a gap
says so. A gap may make a task wait for one that starts after it; then what comes after the former
is timed again. Robots that would wait for one another for ever never come to an end, so that a
change is refused where too much is timed.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from teamformer.base.array_types import Floats, Int32s, Ints
from teamformer.base.kernels.jit import entry, kernel
from teamformer.planning.graph.arc_problem import ArcProblem
from teamformer.planning.graph.graph import Graph, back_of, start_of
from teamformer.planning.graph.judging import (
    BACK,
    DURATION,
    END,
    HOMES,
    KEY,
    LOGGED,
    WAITS,
    ArcChange,
    begin_trial,
    connect,
    empty_trial,
    fit_duration,
    follow,
    follow_on,
    record,
    undo,
    wait,
)
from teamformer.planning.problem.coalition_problem import NOBODY
from teamformer.planning.problem.links import (
    COMPLETION,
    FREE,
    HOME,
    MAKESPAN,
    MAX_TARDINESS,
    PARTS,
    TARDINESS,
    TRAVEL,
    LinkedProblem,
)

MOST_TIMED, TIMED_EACH = 200, 2
"""How many tasks are timed after a change at most: so many, and each so many times."""

NOW, THEN, BEST = range(3)
"""Costs: of the graph as it is, with the change at hand, and of the best one."""


class Links(NamedTuple):
    """What is linked with what, and what plans are judged by; see `LinkedProblem`."""

    group: Int32s  # (tasks,)
    members: Int32s  # (groups, most + 1)
    gap: Ints  # (tasks, tasks)
    weight: Floats  # (PARTS,)
    task_weight: Floats  # (tasks,)


class Ledger(NamedTuple):
    """What a graph costs, and would with the change at hand."""

    part: Ints  # (PARTS,)
    then: Ints  # (PARTS,)
    cost: Floats  # (3,) what plans are judged by
    lead: Floats  # (3,) the same and what leads a search: how early all robots are home
    start: Ints  # (tasks,) room for the starts of a group
    is_less_late: Int32s  # (1,) whether a task that was the latest is late by less


def links_of(problem: LinkedProblem) -> Links:
    """Return a problem's links and weights as kernels take them."""
    parts = (problem.group, problem.members, problem.gap)
    return Links(*parts, problem.weight, problem.task_weight)


def empty_ledger(problem: LinkedProblem) -> Ledger:
    """Return a ledger in which nothing costs anything."""
    return Ledger(
        part=np.zeros(PARTS, np.int64),
        then=np.zeros(PARTS, np.int64),
        cost=np.zeros(3),
        lead=np.zeros(3),
        start=np.zeros(len(problem.group), np.int64),
        is_less_late=np.zeros(1, np.int32),
    )


def room_for_change(problem: LinkedProblem, graph: Graph) -> ArcChange:
    """Return room for a change; linked tasks may be timed more than once in it."""
    timed = MOST_TIMED + TIMED_EACH * len(graph.nodes)
    return empty_trial(graph, timed * problem.members.shape[1])


@kernel
def begin_change(trial: ArcChange, ledger: Ledger) -> None:
    """Begin a change."""
    begin_trial(trial)
    ledger.is_less_late[0] = 0
    for part in range(len(ledger.part)):
        ledger.then[part] = ledger.part[part]


@kernel
def way_out(problem: ArcProblem, graph: Graph, seat: int) -> int:
    """Return how long the way takes along the arc that leaves a seat."""
    record_of = graph.seats[seat]
    to = graph.seats[record_of.next].node
    if to >= problem.ways.shape[1]:
        return problem.home[record_of.kind, record_of.node]
    return problem.ways[problem.kinds[record_of.kind].pace, record_of.node, to]


@kernel
def travel_of(problem: ArcProblem, graph: Graph) -> int:
    """Return how long all ways take, added up."""
    travel, robots = 0, len(graph.back)
    for task in range(len(problem.near)):
        node = graph.nodes[task]
        for seat in range(node.first, node.first + node.taken):
            travel += way_out(problem, graph, seat)
    for depot in range(len(graph.seats) - 2 * robots, len(graph.seats) - robots):
        travel += way_out(problem, graph, depot)
    return travel


@kernel
def lead(
    problem: ArcProblem, graph: Graph, trial: ArcChange, ledger: Ledger, seat: int, to: int
) -> None:
    """Lead the arc that leaves a seat to another one."""
    ledger.then[TRAVEL] -= way_out(problem, graph, seat)
    connect(graph, trial, seat, to)
    ledger.then[TRAVEL] += way_out(problem, graph, seat)


@kernel
def propagate(
    problem: ArcProblem, links: Links, graph: Graph, trial: ArcChange, ledger: Ledger, most: int
) -> bool:
    """Time what has changed; say if that came to an end after so many tasks."""
    number, nodes, start = trial.number, graph.nodes, ledger.start
    while number[WAITS] > 0:
        most -= 1
        if most < 0:
            return False
        number[WAITS] -= 1
        task = trial.agenda[number[WAITS]].task
        nodes[task].is_waiting = 0
        members = links.members[links.group[task]]
        for other in members:
            if other == NOBODY:
                break
            if nodes[other].is_load:
                fit_duration(problem, graph, trial, other)
            start[other] = start_of(problem, graph, other, nodes[other].first)
        if members[1] != NOBODY:
            _keep_gaps(links, members, start)
        for other in members:
            if other == NOBODY:
                break
            if start[other] + nodes[other].duration != nodes[other].end:
                _start(problem, links, graph, trial, ledger, other)
    return True


@kernel
def _keep_gaps(links: Links, members: Int32s, start: Ints) -> None:
    """Start tasks of a group later until all gaps are kept; gaps do not contradict each other."""
    is_changed = True
    while is_changed:
        is_changed = False
        for task in members:
            if task == NOBODY:
                break
            for other in members:
                if other == NOBODY:
                    break
                gap = links.gap[other, task]
                if gap > FREE and start[other] + gap > start[task]:
                    start[task] = start[other] + gap
                    is_changed = True


@kernel
def _start(
    problem: ArcProblem, links: Links, graph: Graph, trial: ArcChange, ledger: Ledger, task: int
) -> None:
    """Let a task start when the ledger says, and have all that follows it timed."""
    node, then = graph.nodes[task], ledger.then
    end = ledger.start[task] + node.duration
    due = graph.worth[task].due
    was_late, is_late = max(0, node.end - due), max(0, end - due)
    weight = links.task_weight[task]
    then[TARDINESS] += np.int64(weight * is_late) - np.int64(weight * was_late)
    then[COMPLETION] += np.int64(weight * end) - np.int64(weight * node.end)
    then[MAX_TARDINESS] = max(then[MAX_TARDINESS], is_late)
    if is_late < was_late and was_late == then[MAX_TARDINESS]:
        ledger.is_less_late[0] = 1
    record(trial, END, task, node.end)
    node.end = end
    follow_on(problem, graph, trial, task)


@kernel
def sum_up_change(
    problem: ArcProblem, links: Links, graph: Graph, trial: ArcChange, ledger: Ledger
) -> None:
    """Work out what the graph costs with the change at hand; homes only where they count."""
    number, then, back = trial.number, ledger.then, graph.back
    counts_homes = links.weight[MAKESPAN] > 0 or links.weight[HOME] > 0
    is_changed = False
    for index in range(number[HOMES]):
        robot = trial.homes[index]
        trial.is_listed[robot] = 0
        if counts_homes:
            now = back_of(problem, graph, robot)
            if now != back[robot]:
                record(trial, BACK, robot, back[robot])
                then[HOME] += now - back[robot]
                back[robot] = now
                is_changed = True
    number[HOMES] = 0
    if is_changed:
        then[MAKESPAN] = 0
        for robot in range(len(back)):
            then[MAKESPAN] = max(then[MAKESPAN], back[robot])
    if ledger.is_less_late[0]:
        then[MAX_TARDINESS] = 0
        for task in range(len(problem.near)):
            late = graph.nodes[task].end - graph.worth[task].due
            then[MAX_TARDINESS] = max(then[MAX_TARDINESS], late)
    ledger.cost[THEN] = 0.0
    for part in range(len(then)):
        if part != HOME:
            ledger.cost[THEN] += links.weight[part] * then[part]
    ledger.lead[THEN] = ledger.cost[THEN] + links.weight[HOME] * then[HOME]


@kernel
def is_better(ledger: Ledger, one: int, other: int) -> bool:
    """Say whether one of NOW, THEN and BEST costs less than another, or as much and leads on."""
    if ledger.cost[one] == ledger.cost[other]:
        return ledger.lead[one] < ledger.lead[other]
    return ledger.cost[one] < ledger.cost[other]


@kernel
def accept_change(graph: Graph, trial: ArcChange, ledger: Ledger) -> None:
    """Give tasks the keys of their starts."""
    for place in range(trial.number[LOGGED]):
        what = trial.log[place].what
        if what in (END, KEY, DURATION):
            node = graph.nodes[trial.log[place].index]
            node.key = 2 * (node.end - node.duration) + 1
    for part in range(len(ledger.part)):
        ledger.part[part] = ledger.then[part]
    replace_cost(ledger, NOW, THEN)


@kernel
def replace_cost(ledger: Ledger, one: int, other: int) -> None:
    """Note that one of NOW, THEN and BEST costs what another does."""
    ledger.cost[one], ledger.lead[one] = ledger.cost[other], ledger.lead[other]


@entry
def time_links(
    problem: ArcProblem, links: Links, graph: Graph, trial: ArcChange, ledger: Ledger, most: int
) -> bool:
    """Work out all times and the cost of a graph that is timed as if nothing were linked.

    Say if the times come to an end.
    """
    tasks, seats = len(problem.near), graph.seats
    for part in range(len(ledger.part)):
        ledger.part[part] = 0
    for task in range(tasks):
        node = graph.nodes[task]
        late = max(0, node.end - graph.worth[task].due)
        ledger.part[TARDINESS] += np.int64(links.task_weight[task] * late)
        ledger.part[COMPLETION] += np.int64(links.task_weight[task] * node.end)
    ledger.part[TRAVEL] = travel_of(problem, graph)
    for robot in range(len(graph.back)):
        ledger.part[HOME] += graph.back[robot]
        ledger.part[MAKESPAN] = max(ledger.part[MAKESPAN], graph.back[robot])
    begin_change(trial, ledger)
    for task in range(tasks):
        wait(graph, trial, task, graph.nodes[task].key)
    if not propagate(problem, links, graph, trial, ledger, most):
        undo(graph, trial)
        return False
    for robot in range(len(graph.back)):
        follow(graph, trial, len(seats) - len(graph.back) + robot)
    ledger.is_less_late[0] = 1
    sum_up_change(problem, links, graph, trial, ledger)
    accept_change(graph, trial, ledger)
    return True
