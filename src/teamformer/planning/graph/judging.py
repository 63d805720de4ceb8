"""Judging a change of arcs: times are worked out anew only as far as they change.

The first task on the agenda of a change is taken from it and timed. If it ends at another time than
before, those that follow it are put on the agenda. After a change that is accepted keys and tails
are worked out.
"""

from __future__ import annotations

from teamformer.base.kernels.jit import kernel
from teamformer.planning.graph.approximate_steps import comes_from, plan_ways
from teamformer.planning.graph.arc_problem import ArcProblem, is_weighed
from teamformer.planning.graph.arriving import left_after
from teamformer.planning.graph.changes import (
    BACK,
    CHAINED,
    COMES,
    DETOUR,
    DURATION,
    END,
    HOMES,
    LEFT,
    LOGGED,
    NEXT,
    PARTING,
    PAST,
    WAITS,
    ArcChange,
    follow,
    record,
    wait,
)
from teamformer.planning.graph.charging import is_charged
from teamformer.planning.graph.graph import (
    BACK_SUM,
    END_SUM,
    LATEST,
    LEADS,
    MAKESPAN,
    MISSED,
    PRICE,
    Graph,
    back_of,
    is_in_steps,
    last_home,
    start_of,
    tail_of,
    takes,
    weigh_totals,
)
from teamformer.planning.graph.worth import (
    counted_end,
    is_left_out,
    missed,
    missed_leads,
    priced,
)
from teamformer.planning.problem.coalition_problem import NOBODY
from teamformer.planning.problem.constants import TICKS


@kernel
def propagate(problem: ArcProblem, graph: Graph, trial: ArcChange, limit: int) -> bool:
    """Time what has changed; stop if some chain is longer than the limit, and say if none is."""
    number, nodes = trial.number, graph.nodes
    while number[WAITS] > 0:
        number[WAITS] -= 1
        task = trial.agenda[number[WAITS]].task
        node = nodes[task]
        is_parting = node.is_waiting == PARTING
        node.is_waiting = 0
        start, end, is_fit = 0, node.end, True
        if task < len(problem.near):
            if node.is_load:
                is_fit = fit_duration(problem, graph, trial, task)
            start = start_of(problem, graph, task, node.first)
            end = start + node.duration
            if is_charged(problem):
                is_fit = spend(problem, graph, trial, task, start)[0] and is_fit
        if end == node.end and is_fit and not is_parting:
            continue
        is_longer = node.key > number[PAST] and start + node.tail > limit
        if is_longer and not is_left_out(problem, graph, task):
            return False
        if end != node.end:
            record(trial, END, task, node.end)
            node.end = end
        if is_in_steps(graph):
            _send_on(problem, graph, trial, task)
            continue
        follow_on(problem, graph, trial, task)
    return True


@kernel
def spend(
    problem: ArcProblem, graph: Graph, trial: ArcChange, task: int, start: int
) -> tuple[bool, int]:
    """Note what robots have left after a task that starts then, and their detours to it.

    Return whether they had it before, and by how much they go round more if plans have a cost.
    """
    node, is_same, more = graph.nodes[task], True, 0
    for seat in range(node.first, node.first + node.taken):
        left, detour = left_after(problem, graph, seat, start)
        if left != graph.left[seat]:
            record(trial, LEFT, seat, graph.left[seat])
            graph.left[seat] = left
            is_same = False
        if is_weighed(problem):
            more += go_round(graph, trial, seat, detour)
    if is_weighed(problem):
        for seat in range(node.first + node.taken, node.first + problem.most[0]):
            more += go_round(graph, trial, seat, 0)
    return is_same, more


@kernel
def go_round(graph: Graph, trial: ArcChange, seat: int, detour: int) -> int:
    """Note the detour of the way to a seat, and return by how much more it is than before."""
    before = graph.detour[seat]
    if detour != before:
        record(trial, DETOUR, seat, before)
        graph.detour[seat] = detour
    return detour - before


@kernel
def fit_duration(problem: ArcProblem, graph: Graph, trial: ArcChange, task: int) -> bool:
    """Have a load take as long as it does with its coalition; say whether it did before."""
    node = graph.nodes[task]
    duration = takes(problem, graph, task)
    if duration == node.duration:
        return True
    record(trial, DURATION, task, node.duration)
    node.duration = duration
    trial.number[PAST] = max(trial.number[PAST], node.key)
    return False


@kernel
def follow_on(problem: ArcProblem, graph: Graph, trial: ArcChange, task: int) -> None:
    """Have all timed that follows a task: where its robots go, and what it must come before."""
    node = graph.nodes[task]
    for seat in range(node.first, node.first + node.taken):
        follow(graph, trial, graph.seats[seat].next)
    if node.has_links:
        _follow_links(problem, graph, trial, task)


@kernel
def _follow_links(problem: ArcProblem, graph: Graph, trial: ArcChange, task: int) -> None:
    """Have the tasks timed that a task must come before."""
    for other in problem.after[task]:
        if other == NOBODY:
            break
        if not graph.nodes[other].is_waiting:
            wait(graph, trial, other, graph.nodes[other].key)


@kernel
def _send_on(problem: ArcProblem, graph: Graph, trial: ArcChange, node: int) -> None:
    """Work out when those who leave a node are at their next ones, and have those timed.

    What starts in the same step has its turn after the node, which may have changed.
    """
    nodes, record_of = graph.nodes, graph.nodes[node]
    count, step = plan_ways(problem, graph, node), (record_of.end - record_of.duration) // TICKS
    for seat in range(record_of.first, record_of.first + record_of.taken):
        head = graph.seats[seat].next
        to = graph.seats[head].node
        comes = comes_from(problem, graph, seat, count)
        if comes != graph.comes[seat]:
            record(trial, COMES, seat, graph.comes[seat])
            graph.comes[seat] = comes
        elif to < len(nodes) - 1 and (nodes[to].end - nodes[to].duration) // TICKS > step:
            continue
        follow(graph, trial, head)
    if record_of.has_links:
        _follow_links(problem, graph, trial, node)


@kernel
def sum_up_trial(problem: ArcProblem, graph: Graph, trial: ArcChange) -> None:
    """Time the homes, and work out what is known of the graph with the change at hand.

    Who is home last is NOBODY where that is not known any more.
    """
    number, back, total = trial.number, graph.back, trial.total
    for part in range(len(total)):
        total[part] = graph.total[part]
    makespan, is_latest_changed = 0, False
    for index in range(number[HOMES]):
        robot = trial.homes[index]
        trial.is_listed[robot] = 0
        now = back_of(problem, graph, robot)
        old = back[robot]
        if now != old:
            is_latest_changed |= robot == total[LATEST]
            record(trial, BACK, robot, old)
            back[robot] = now
            total[BACK_SUM] += now - old
            makespan = max(makespan, now)
            if now > total[MAKESPAN]:
                total[MAKESPAN], total[LATEST] = now, robot
    number[HOMES] = 0
    if is_latest_changed:
        total[LATEST] = NOBODY
        if makespan < graph.total[MAKESPAN]:
            for robot in range(len(back)):
                makespan = max(makespan, back[robot])
        total[MAKESPAN] = makespan
    for entry in range(number[LOGGED]):
        if trial.log[entry].what == END:
            task, old_end = trial.log[entry].index, trial.log[entry].old
            end, worth = graph.nodes[task].end, graph.worth[task]
            total[END_SUM] += counted_end(problem, worth, end)
            total[END_SUM] -= counted_end(problem, worth, old_end)
            total[PRICE] += priced(problem, worth, end) - priced(problem, worth, old_end)
            total[MISSED] += missed(problem, worth, end) - missed(problem, worth, old_end)
            total[LEADS] += missed_leads(problem, worth, end)
            total[LEADS] -= missed_leads(problem, worth, old_end)
    weigh_totals(problem, graph, total)


@kernel
def accept(problem: ArcProblem, graph: Graph, trial: ArcChange) -> None:
    """Give tasks the keys of their starts and their tails, from the latest one backwards."""
    number, nodes, seats = trial.number, graph.nodes, graph.seats
    number[CHAINED] = NOBODY
    for part in range(len(graph.total)):
        graph.total[part] = trial.total[part]
    if graph.total[LATEST] == NOBODY:
        graph.total[LATEST] = last_home(graph)
    for place in range(number[LOGGED]):
        if trial.log[place].what == END:
            node = nodes[trial.log[place].index]
            node.key = 2 * (node.end - node.duration) + 1
    for place in range(number[LOGGED]):
        what, node = trial.log[place].what, trial.log[place].index
        is_out = what == END and is_left_out(problem, graph, node)
        if what in (DURATION, NEXT) or is_out:
            if what == NEXT:
                node = seats[node].node
            if node < len(problem.near) and not nodes[node].is_waiting:
                nodes[node].key = 2 * (nodes[node].end - nodes[node].duration) + 1
                wait(graph, trial, node, -nodes[node].key)
    hang_tails(problem, graph, trial)


@kernel
def hang_tails(problem: ArcProblem, graph: Graph, trial: ArcChange) -> None:
    """Work out the tails of the tasks on the agenda, which has them by falling keys."""
    number, nodes, seats = trial.number, graph.nodes, graph.seats
    most, tasks = problem.most[0], len(problem.near)
    while number[WAITS] > 0:
        number[WAITS] -= 1
        task = trial.agenda[number[WAITS]].task
        node = nodes[task]
        node.is_waiting = 0
        tail = tail_of(problem, graph, task, task * most)
        if tail == node.tail:
            continue
        node.tail = tail
        for seat in range(task * most, task * most + node.taken):
            other = seats[seats[seat].prev].node
            if other < tasks and not nodes[other].is_waiting:
                wait(graph, trial, other, -nodes[other].key)
        if node.has_links:
            for other in problem.before[task]:
                if other == NOBODY:
                    break
                if not nodes[other].is_waiting:
                    wait(graph, trial, other, -nodes[other].key)
