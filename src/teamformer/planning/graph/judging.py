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
    AIMED,
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
    AIM,
    BACK_SUM,
    COST,
    END_SUM,
    LATEST,
    LEADS,
    MAKESPAN,
    MISSED,
    PRICE,
    Graph,
    aim_of,
    back_of,
    cost_of,
    is_in_steps,
    start_of,
    tail_of,
    takes,
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
def sum_up_trial(problem: ArcProblem, graph: Graph, trial: ArcChange) -> int:
    """Time the homes, and return what the plan costs now; `total` stays until it is accepted."""
    number, back, total = trial.number, graph.back, graph.total
    makespan, back_sum, price, end_sum = 0, total[BACK_SUM], total[PRICE], total[END_SUM]
    misses, leads = total[MISSED], total[LEADS]
    is_latest_changed = False
    for index in range(number[HOMES]):
        robot = trial.homes[index]
        trial.is_listed[robot] = 0
        now = back_of(problem, graph, robot)
        old = back[robot]
        if now != old:
            is_latest_changed |= robot == total[LATEST]
            record(trial, BACK, robot, old)
            back[robot] = now
            back_sum += now - old
            makespan = max(makespan, now)
    number[HOMES] = 0
    if not is_latest_changed:
        makespan = max(makespan, total[MAKESPAN])
    elif makespan < total[MAKESPAN]:
        for robot in range(len(back)):
            makespan = max(makespan, back[robot])
    for entry in range(number[LOGGED]):
        if trial.log[entry].what == END:
            task, old_end = trial.log[entry].index, trial.log[entry].old
            end, worth = graph.nodes[task].end, graph.worth[task]
            end_sum += counted_end(problem, worth, end) - counted_end(problem, worth, old_end)
            price += priced(problem, worth, end) - priced(problem, worth, old_end)
            misses += missed(problem, worth, end) - missed(problem, worth, old_end)
            leads += missed_leads(problem, worth, end) - missed_leads(problem, worth, old_end)
    number[AIMED] = aim_of(problem, graph, makespan, price) + misses
    return cost_of(problem, graph, makespan, back_sum, end_sum, price, leads)


@kernel
def accept(problem: ArcProblem, graph: Graph, trial: ArcChange, cost: int) -> None:
    """Give tasks the keys of their starts and their tails, from the latest one backwards."""
    number, nodes, seats = trial.number, graph.nodes, graph.seats
    total, back = graph.total, graph.back
    total[AIM], total[COST] = number[AIMED], cost
    number[CHAINED] = NOBODY
    is_latest_changed = False
    for place in range(number[LOGGED]):
        index, old = trial.log[place].index, trial.log[place].old
        if trial.log[place].what == END:
            node, worth = nodes[index], graph.worth[index]
            node.key = 2 * (node.end - node.duration) + 1
            end = node.end
            total[END_SUM] += counted_end(problem, worth, end) - counted_end(problem, worth, old)
            total[PRICE] += priced(problem, worth, end) - priced(problem, worth, old)
            total[MISSED] += missed(problem, worth, end) - missed(problem, worth, old)
            total[LEADS] += missed_leads(problem, worth, end) - missed_leads(problem, worth, old)
        elif trial.log[place].what == BACK:
            total[BACK_SUM] += back[index] - old
            is_latest_changed |= index == total[LATEST]
            if back[index] > total[MAKESPAN]:
                total[MAKESPAN] = back[index]
                total[LATEST] = index
    if is_latest_changed:
        latest = 0
        for robot in range(len(back)):
            if back[robot] > back[latest]:
                latest = robot
        total[LATEST] = latest
        total[MAKESPAN] = back[latest]
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
