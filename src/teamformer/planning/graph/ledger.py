"""What a graph costs, and would with the change at hand; and times where starts are linked.

Where the makespan alone counts, a ledger has what the graph is judged by and what leads a search.
If plans have a cost it also keeps the parts of it.

Tasks that are linked are timed together: each when its robots are there, then later where a gap
says so. A gap may make a task wait for one that starts after it; then what comes after the former
is timed again. Robots that would wait for one another for ever never come to an end, so that a
change is refused where too much is timed.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from teamformer.base.array_types import Floats, Int32s, Ints
from teamformer.base.kernels.jit import entry, kernel
from teamformer.planning.graph.arc_problem import ArcProblem, is_weighed, may_miss
from teamformer.planning.graph.arriving import arrive_home
from teamformer.planning.graph.changes import (
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
    follow,
    record,
    undo,
    wait,
)
from teamformer.planning.graph.charging import is_charged
from teamformer.planning.graph.graph import (
    AIM,
    COST,
    Graph,
    back_of,
    is_in_steps,
    start_of,
    time_anew,
)
from teamformer.planning.graph.judging import (
    accept,
    fit_duration,
    follow_on,
    go_round,
    propagate,
    spend,
    sum_up_trial,
)
from teamformer.planning.graph.worth import is_missed, late_by, missed, missed_leads
from teamformer.planning.problem.coalition_problem import NOBODY
from teamformer.planning.problem.links import (
    COMPLETION,
    FREE,
    HOME,
    LEADS,
    MAKESPAN,
    MAX_TARDINESS,
    MISSED,
    TARDINESS,
    TRAVEL,
)

MOST_TIMED, TIMED_EACH = 200, 2
"""How many tasks are timed after a change at most: so many, and each so many times."""

NOW, THEN, BEST = range(3)
"""Costs: of the graph as it is, with the change at hand, and of the best one."""


class Ledger(NamedTuple):
    """What a graph costs, and would with the change at hand."""

    part: Ints  # (PARTS,), without the last two if nobody has extras; (0,) if the makespan counts
    then: Ints  # the same with the change
    cost: Floats  # (3,) what plans are judged by
    lead: Floats  # (3,) the same and what leads a search: how early all robots are home
    start: Ints  # (tasks,) room for the starts of a group
    is_less_late: Int32s  # (1,) whether a task that was the latest is late by less
    detours: Ints  # (2,) how long all detours to chargers take, NOW and THEN


def empty_ledger(problem: ArcProblem) -> Ledger:
    """Return a ledger in which nothing costs anything."""
    parts = len(problem.links.weight)
    if parts > 0 and not problem.extras:
        parts = MISSED
    return Ledger(
        part=np.zeros(parts, np.int64),
        then=np.zeros(parts, np.int64),
        cost=np.zeros(3),
        lead=np.zeros(3),
        start=np.zeros(len(problem.near), np.int64),
        is_less_late=np.zeros(1, np.int32),
        detours=np.zeros(2, np.int64),
    )


def room_for_change(problem: ArcProblem, graph: Graph) -> ArcChange:
    """Return room for a change; linked tasks may be timed more than once in it."""
    if len(problem.links.members) == 0:
        return empty_trial(graph)
    timed = MOST_TIMED + TIMED_EACH * len(graph.nodes)
    noted = 1 + 2 * int(problem.most[0]) * bool(len(graph.left))  # ends; what is left, detours
    return empty_trial(graph, timed * problem.links.members.shape[1] * noted)


@kernel
def begin_change(trial: ArcChange, ledger: Ledger) -> None:
    """Begin a change."""
    begin_trial(trial)
    ledger.is_less_late[0] = 0
    ledger.detours[THEN] = ledger.detours[NOW]
    for part in range(len(ledger.part)):
        ledger.then[part] = ledger.part[part]


@kernel
def time_change(
    problem: ArcProblem, graph: Graph, trial: ArcChange, ledger: Ledger, limit: int, allowed: float
) -> bool:
    """Time what has changed; say if no chain is longer than the limit.

    If plans have a cost: if all times come to an end, and ways alone cost no more than is allowed.
    """
    if not is_weighed(problem):
        return propagate(problem, graph, trial, limit)
    if problem.links.weight[TRAVEL] * ledger.then[TRAVEL] > allowed:
        return False
    return _time_groups(problem, graph, trial, ledger)


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
    if not is_weighed(problem):
        connect(graph, trial, seat, to)
        return
    ledger.then[TRAVEL] -= way_out(problem, graph, seat)
    connect(graph, trial, seat, to)
    ledger.then[TRAVEL] += way_out(problem, graph, seat)


@kernel
def _time_groups(problem: ArcProblem, graph: Graph, trial: ArcChange, ledger: Ledger) -> bool:
    """Time what has changed; say if that came to an end."""
    number, nodes, start = trial.number, graph.nodes, ledger.start
    most = MOST_TIMED + TIMED_EACH * len(problem.near)
    while number[WAITS] > 0:
        most -= 1
        if most < 0:
            return False
        number[WAITS] -= 1
        task = trial.agenda[number[WAITS]].task
        nodes[task].is_waiting = 0
        members = problem.links.members[problem.links.group[task]]
        for other in members:
            if other == NOBODY:
                break
            if nodes[other].is_load:
                fit_duration(problem, graph, trial, other)
            start[other] = start_of(problem, graph, other, nodes[other].first)
        if members[1] != NOBODY:
            _keep_gaps(problem, members, start)
        for other in members:
            if other == NOBODY:
                break
            is_fed = True
            if is_charged(problem):
                is_fed, more = spend(problem, graph, trial, other, start[other])
                ledger.detours[THEN] += more
            if start[other] + nodes[other].duration != nodes[other].end:
                _start(problem, graph, trial, ledger, other)
            elif not is_fed:
                follow_on(problem, graph, trial, other)
    return True


@kernel
def _keep_gaps(problem: ArcProblem, members: Int32s, start: Ints) -> None:
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
                gap = problem.links.gap[other, task]
                if gap > FREE and start[other] + gap > start[task]:
                    start[task] = start[other] + gap
                    is_changed = True


@kernel
def _start(problem: ArcProblem, graph: Graph, trial: ArcChange, ledger: Ledger, task: int) -> None:
    """Let a task start when the ledger says, and have all that follows it timed."""
    node, then = graph.nodes[task], ledger.then
    end = ledger.start[task] + node.duration
    worth = graph.worth[task]
    was_late, is_late = late_by(problem, worth, node.end), late_by(problem, worth, end)
    weight = problem.links.task_weight[task]
    then[TARDINESS] += np.int64(weight * is_late) - np.int64(weight * was_late)
    then[COMPLETION] += _completion(problem, worth, weight, end)
    then[COMPLETION] -= _completion(problem, worth, weight, node.end)
    if may_miss(problem):
        then[MISSED] += missed(problem, worth, end) - missed(problem, worth, node.end)
        then[LEADS] += missed_leads(problem, worth, end) - missed_leads(problem, worth, node.end)
    then[MAX_TARDINESS] = max(then[MAX_TARDINESS], is_late)
    if is_late < was_late and was_late == then[MAX_TARDINESS]:
        ledger.is_less_late[0] = 1
    record(trial, END, task, node.end)
    node.end = end
    follow_on(problem, graph, trial, task)


@kernel
def _completion(problem: ArcProblem, worth: Any, weight: float, end: int) -> int:
    """Return what counts of the end of a task, unless it is missed."""
    return 0 if is_missed(problem, worth, end) else int(weight * end)


@kernel
def sum_up_change(problem: ArcProblem, graph: Graph, trial: ArcChange, ledger: Ledger) -> None:
    """Work out what the graph costs with the change at hand."""
    if is_weighed(problem):
        _add_up(problem, graph, trial, ledger)
    else:
        sum_up_trial(problem, graph, trial)
        ledger.cost[THEN], ledger.lead[THEN] = trial.total[AIM], trial.total[COST]


@kernel
def _add_up(problem: ArcProblem, graph: Graph, trial: ArcChange, ledger: Ledger) -> None:
    """Add up the parts of the cost; homes only where they count."""
    number, then, back = trial.number, ledger.then, graph.back
    counts_homes = problem.links.weight[MAKESPAN] > 0 or problem.links.weight[HOME] > 0
    is_changed = False
    for index in range(number[HOMES]):
        robot = trial.homes[index]
        trial.is_listed[robot] = 0
        if is_charged(problem) and problem.links.weight[TRAVEL] > 0:
            home = len(graph.seats) - len(back) + robot
            detour = arrive_home(problem, graph, home)[2]
            ledger.detours[THEN] += go_round(graph, trial, home, detour)
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
            late = late_by(problem, graph.worth[task], graph.nodes[task].end)
            then[MAX_TARDINESS] = max(then[MAX_TARDINESS], late)
    ledger.cost[THEN] = 0.0
    for part in range(len(then)):
        if part != HOME:
            ledger.cost[THEN] += problem.links.weight[part] * then[part]
    if is_charged(problem):
        ledger.cost[THEN] += problem.links.weight[TRAVEL] * ledger.detours[THEN]
    ledger.lead[THEN] = ledger.cost[THEN] + problem.links.weight[HOME] * then[HOME]
    if may_miss(problem):
        ledger.lead[THEN] += then[LEADS]
        ledger.cost[THEN] += then[MISSED]


@kernel
def is_better(ledger: Ledger, one: int, other: int) -> bool:
    """Say whether one of NOW, THEN and BEST costs less than another, or as much and leads on."""
    if ledger.cost[one] == ledger.cost[other]:
        return ledger.lead[one] < ledger.lead[other]
    return ledger.cost[one] < ledger.cost[other]


@kernel
def accept_change(problem: ArcProblem, graph: Graph, trial: ArcChange, ledger: Ledger) -> None:
    """Make the change at hand part of the graph: give tasks the keys of their starts."""
    replace_cost(ledger, NOW, THEN)
    if not is_weighed(problem):
        accept(problem, graph, trial)
        return
    for place in range(trial.number[LOGGED]):
        what = trial.log[place].what
        if what in (END, KEY, DURATION):
            node = graph.nodes[trial.log[place].index]
            node.key = 2 * (node.end - node.duration) + 1
    ledger.detours[NOW] = ledger.detours[THEN]
    for part in range(len(ledger.part)):
        ledger.part[part] = ledger.then[part]


@kernel
def replace_cost(ledger: Ledger, one: int, other: int) -> None:
    """Note that one of NOW, THEN and BEST costs what another does."""
    ledger.cost[one], ledger.lead[one] = ledger.cost[other], ledger.lead[other]


@entry
def open_ledger(problem: ArcProblem, graph: Graph, trial: ArcChange, ledger: Ledger) -> bool:
    """Work out what a graph costs that is timed as if nothing were linked, and its times then.

    Say if the times come to an end.
    """
    if not is_weighed(problem):
        note_totals(graph, ledger)
        return True
    tasks, seats = len(problem.near), graph.seats
    for part in range(len(ledger.part)):
        ledger.part[part] = 0
    for task in range(tasks):
        node = graph.nodes[task]
        worth, weight = graph.worth[task], problem.links.task_weight[task]
        ledger.part[TARDINESS] += np.int64(weight * late_by(problem, worth, node.end))
        ledger.part[COMPLETION] += _completion(problem, worth, weight, node.end)
        if may_miss(problem):
            ledger.part[MISSED] += missed(problem, worth, node.end)
            ledger.part[LEADS] += missed_leads(problem, worth, node.end)
    ledger.part[TRAVEL] = travel_of(problem, graph)
    for robot in range(len(graph.back)):
        ledger.part[HOME] += graph.back[robot]
        ledger.part[MAKESPAN] = max(ledger.part[MAKESPAN], graph.back[robot])
    ledger.detours[NOW] = 0
    for seat in range(len(graph.detour)):
        ledger.detours[NOW] += graph.detour[seat]
    begin_change(trial, ledger)
    for task in range(tasks):
        wait(graph, trial, task, graph.nodes[task].key)
    if not _time_groups(problem, graph, trial, ledger):
        undo(graph, trial)
        return False
    for robot in range(len(graph.back)):
        follow(graph, trial, len(seats) - len(graph.back) + robot)
    ledger.is_less_late[0] = 1
    _add_up(problem, graph, trial, ledger)
    accept_change(problem, graph, trial, ledger)
    return True


@kernel
def note_totals(graph: Graph, ledger: Ledger) -> None:
    """Note what a graph costs in which the makespan alone counts."""
    ledger.cost[NOW], ledger.lead[NOW] = graph.total[AIM], graph.total[COST]


@kernel
def time_all_anew(problem: ArcProblem, graph: Graph, ledger: Ledger) -> None:
    """Time all anew in steps, where what was timed as it changed may be a bit off."""
    if is_in_steps(graph):
        time_anew(problem, graph)
        note_totals(graph, ledger)
