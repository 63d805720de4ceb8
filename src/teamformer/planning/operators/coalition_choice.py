"""Who could come to a task at a cut through the graph, and which of them make the best coalition.

Every robot's route crosses a cut, which is a moment, along one arc: there the task can be put in.
Arcs are looked for at near tasks and depots.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from teamformer.base.array_types import Array, Int32s, Ints
from teamformer.base.kernels.jit import kernel
from teamformer.planning.graph.arc_problem import ArcProblem, Records, takes_with
from teamformer.planning.graph.arriving import arrive
from teamformer.planning.graph.graph import Graph, leave
from teamformer.planning.graph.worth import is_left_out
from teamformer.planning.problem.coalition_problem import NEVER, NOBODY
from teamformer.planning.problem.constants import TICKS
from teamformer.world.rules.chance import draw_below
from teamformer.world.rules.coverage import helps

BLINK = 16
"""Every so many arcs one is overlooked, so that the search does not always see the same."""

DEPOTS = 24
"""How many depots are looked at."""

DETOUR = 20
"""Sixty-fourths of its detour that an arc is judged by beside its chain."""

AT_RANDOM = 20  # percent
"""How often the first cover is taken that there are robots for, from a random one on."""

GREEDILY = 50  # percent
"""How often robots are picked greedily where not all covers are listed."""

THIS_ONE = 75  # percent
"""How often it is the robot that the makespan hangs on that is to be replaced, of a task where
there is one; else any robot of the task is."""

CANDIDATE = np.dtype(
    [
        ("seat", np.int64),  # whose arc out it is
        ("kind", np.int64),
        ("comes", np.int64),
        ("leaves", np.int64),  # its chain from there on, for a load from when it takes that up
        ("score", np.int64),
    ]
)

if TYPE_CHECKING:
    from teamformer.planning.operators.state import SearchState

PICKS, TYPES, COMES, LEAVES, BANNED, FELLOWS_FROM, FELLOWS_TO = range(7)
"""Numbers of a choice: robots picked, types found, when the last of those picked comes, the longest
chain that leaves, the seat whose arc out is not to be picked, and in steps between which nodes the
group is that the task was offered to, or NOBODY."""

TOGETHER = 6 * TICKS
"""How much sooner a robot that comes with a group is taken to come in steps."""


class Choice(NamedTuple):
    """Room to choose a coalition in."""

    number: Ints  # (7,)
    candidates: Records  # (types, most) CANDIDATE, best first
    found: Int32s  # (types,) how many there are
    types: Int32s  # (types,) those of which there are any
    pick: Records  # (seats,) CANDIDATE
    lacking: Int32s  # (caps,)


def empty_choice(problem: ArcProblem, seats: int) -> Choice:
    """Return room to choose a coalition of at most so many seats in."""
    types = len(problem.counts)
    most = int(problem.useful.max(initial=1))
    return Choice(
        number=np.full(7, NOBODY, np.int64),
        candidates=np.zeros((types, most), CANDIDATE).view(np.recarray),
        found=np.zeros(types, np.int32),
        types=np.zeros(types, np.int32),
        pick=np.zeros(seats + 1, CANDIDATE).view(np.recarray),
        lacking=np.zeros(problem.needs.shape[1], np.int32),
    )


@kernel
def gather(
    problem: ArcProblem, search: SearchState, task: int, cut: int, comes_by: int, by_chain: bool
) -> None:
    """Gather arcs that cross the cut as if the task were nowhere, the best of each type.

    One of the robots that do the task now is not among them, so that something changes.
    """
    graph, choice, random = search.graph, search.choice, search.random
    nodes, seats, most = graph.nodes, graph.seats, problem.most[0]
    need = nodes[task].need
    for index in range(choice.number[TYPES]):
        choice.found[choice.types[index]] = 0
    choice.number[TYPES] = 0
    own = comes_by
    if own == NOBODY or draw_below(random, 100) >= THIS_ONE:
        own = task * most + draw_below(random, nodes[task].taken)
    choice.number[BANNED] = NOBODY if is_left_out(problem, graph, task) else seats[own].prev
    for index in range(-1, problem.near.shape[1]):
        other = task if index < 0 else problem.near[task, index]
        is_before = nodes[other].key < cut
        for seat in range(other * most, other * most + nodes[other].taken):
            if problem.useful[need, problem.kinds[seats[seat].kind].type] == 0:
                continue
            if index < 0:
                tail, head = seats[seat].prev, seats[seat].next
            elif is_before:
                tail, head = seat, seats[seat].next
                if seats[head].node == task:
                    head = seats[head].next
            else:
                tail, head = seats[seat].prev, seat
                if seats[tail].node == task:
                    tail = seats[tail].prev
            if nodes[seats[tail].node].key < cut < nodes[seats[head].node].key:
                _consider(problem, search, task, tail, head, by_chain)
    robots = len(graph.back)
    robot = draw_below(random, robots)
    for _ in range(min(robots, DEPOTS)):
        robot = robot + 1 if robot + 1 < robots else 0
        tail = len(seats) - 2 * robots + problem.mixed[robot]
        if problem.useful[need, problem.kinds[seats[tail].kind].type] == 0:
            continue
        head = seats[tail].next
        if seats[head].node == task:
            head = seats[head].next
        if nodes[seats[head].node].key > cut:
            _consider(problem, search, task, tail, head, by_chain)


@kernel
def _consider(
    problem: ArcProblem, search: SearchState, task: int, tail: int, head: int, by_chain: bool
) -> None:
    """Put an arc among the best of its type, if it is of use.

    Of loads it also counts how fast the robot carries them.
    """
    graph, choice, random = search.graph, search.choice, search.random
    nodes, seats = graph.nodes, graph.seats
    kind = seats[tail].kind
    which = problem.kinds[kind].type
    keeps = problem.useful[nodes[task].need, which]
    if tail == choice.number[BANNED]:
        return
    place, pace = seats[tail].node, problem.kinds[kind].pace
    comes, _, _ = arrive(problem, graph, kind, tail, task)
    if place == choice.number[FELLOWS_FROM] and seats[head].node == choice.number[FELLOWS_TO]:
        comes -= TOGETHER
    found, best = choice.found[which], choice.candidates[which]
    if found == keeps and best[found - 1].score <= comes:
        return
    leaves = leave(problem, graph, kind, task, head)
    if nodes[task].is_load:
        leaves += takes_with(problem, pace, task)
    score = comes
    if by_chain:
        straight = leave(problem, graph, kind, place, head)
        way = problem.ways_to[pace, task, place]
        score += leaves + (way + leaves - straight) * DETOUR // 64
    if found == keeps and best[found - 1].score <= score:
        return
    for index in range(found):
        if best[index].seat == tail:
            return
    if draw_below(random, BLINK) == 0:
        return
    if found == 0:
        choice.types[choice.number[TYPES]] = which
        choice.number[TYPES] += 1
    if found < keeps:
        found += 1
        choice.found[which] = found
    index = found - 1
    while index > 0 and best[index - 1].score > score:
        _copy(best, index - 1, best, index)
        index -= 1
    best[index].seat, best[index].kind = tail, kind
    best[index].comes, best[index].leaves, best[index].score = comes, leaves, score


@kernel
def _copy(source: Array, index: int, into: Array, to: int) -> None:
    into[to].seat = source[index].seat
    into[to].kind = source[index].kind
    into[to].comes = source[index].comes
    into[to].leaves = source[index].leaves
    into[to].score = source[index].score


@kernel
def choose(problem: ArcProblem, choice: Choice, random: Array, need: int, by_chain: bool) -> bool:
    """Pick the coalition that comes first, or whose longest chain is shortest; say if any is.

    Every so often a random one is picked.
    """
    choice.number[PICKS] = 0
    listed, best, least = problem.listed[need], NOBODY, NEVER
    is_partial = listed == problem.covers.shape[1]
    if listed == 0 or (is_partial and draw_below(random, 100) < GREEDILY):
        return _choose_greedily(problem, choice, need, by_chain)
    index = 0
    is_random = draw_below(random, 100) < AT_RANDOM
    if is_random:
        index = draw_below(random, listed)
    for _ in range(listed):
        value = _value_of(problem, choice, need, index, by_chain, least)
        if value < least:
            best, least = index, value
            if is_random:
                break
        index = index + 1 if index + 1 < listed else 0
    if best == NOBODY:
        return False
    _pick(problem, choice, need, best)
    return True


@kernel
def _value_of(
    problem: ArcProblem, choice: Choice, need: int, index: int, by_chain: bool, least: int
) -> int:
    """Return when the last robot of a cover comes, and its longest chain goes on; NEVER if none."""
    comes, leaves = 0, 0
    for part in range(problem.covers.shape[2]):
        which, count = problem.covers[need, index, part, 0], problem.covers[need, index, part, 1]
        if which == NOBODY:
            break
        if choice.found[which] < count:
            return NEVER
        for place in range(count):
            comes = max(comes, choice.candidates[which, place].comes)
            leaves = max(leaves, choice.candidates[which, place].leaves)
        if comes + leaves * by_chain >= least:
            return NEVER
    return comes + leaves * by_chain


@kernel
def _pick(problem: ArcProblem, choice: Choice, need: int, index: int) -> None:
    """Pick the robots of a cover."""
    for part in range(problem.covers.shape[2]):
        which = problem.covers[need, index, part, 0]
        if which == NOBODY:
            break
        for place in range(problem.covers[need, index, part, 1]):
            _copy(choice.candidates[which], place, choice.pick, choice.number[PICKS])
            choice.number[PICKS] += 1


@kernel
def pick_seat(
    problem: ArcProblem, graph: Graph, choice: Choice, task: int, tail: int, head: int
) -> None:
    """Pick the robot whose arc leads from one seat to another, whatever it brings."""
    kind, pick = graph.seats[tail].kind, choice.pick[choice.number[PICKS]]
    pick.seat, pick.kind = tail, kind
    pick.comes, _, _ = arrive(problem, graph, kind, tail, task)
    pick.leaves = leave(problem, graph, kind, task, head)
    if graph.nodes[task].is_load:
        pick.leaves += takes_with(problem, problem.kinds[kind].pace, task)
    take(problem, choice, problem.kinds[kind].type)


@kernel
def want(problem: ArcProblem, choice: Choice, need: int) -> None:
    """Begin to pick robots that cover a need."""
    choice.number[PICKS] = 0
    for cap in range(len(choice.lacking)):
        choice.lacking[cap] = problem.needs[need, cap]


@kernel
def take(problem: ArcProblem, choice: Choice, which: int) -> None:
    """Count the robot in the next place as picked; it is of a type."""
    choice.number[PICKS] += 1
    for cap in range(len(choice.lacking)):
        choice.lacking[cap] -= problem.counts[which, cap]


@kernel
def is_lacking(choice: Choice) -> bool:
    """Say whether something is lacking that those who are picked do not bring."""
    for cap in range(len(choice.lacking)):
        if choice.lacking[cap] > 0:
            return True
    return False


@kernel
def _choose_greedily(problem: ArcProblem, choice: Choice, need: int, by_chain: bool) -> bool:
    """Pick robot after robot, the best of those that bring what is lacking; then drop spare ones.

    `found` is used up: what is picked of a type is its best that is left.
    """
    number = choice.number
    want(problem, choice, need)
    comes, leaves = 0, 0
    while is_lacking(choice):
        best, least, at = NOBODY, NEVER, 0
        for index in range(number[TYPES]):
            which = choice.types[index]
            place = 0
            for pick in range(number[PICKS]):
                place += problem.kinds[choice.pick[pick].kind].type == which
            if place >= choice.found[which] or not helps(problem.counts[which], choice.lacking):
                continue
            candidate = choice.candidates[which, place]
            value = max(comes, candidate.comes) + max(leaves, candidate.leaves) * by_chain
            if value < least:
                best, least, at = which, value, place
        if best == NOBODY:
            return False
        _copy(choice.candidates[best], at, choice.pick, number[PICKS])
        take(problem, choice, best)
        comes = max(comes, choice.candidates[best, at].comes)
        leaves = max(leaves, choice.candidates[best, at].leaves)
    drop_spare(problem, choice)
    return bool(number[PICKS] > 0)


@kernel
def drop_spare(problem: ArcProblem, choice: Choice) -> None:
    """Drop robots that are not needed, the last picked first."""
    pick, number = choice.pick, choice.number
    index = number[PICKS] - 1
    while index >= 0:
        which, is_spare = problem.kinds[pick[index].kind].type, True
        for cap in range(len(choice.lacking)):
            is_spare &= choice.lacking[cap] + problem.counts[which, cap] <= 0 or (
                problem.counts[which, cap] == 0
            )
        if is_spare:
            for cap in range(len(choice.lacking)):
                choice.lacking[cap] += problem.counts[which, cap]
            number[PICKS] -= 1
            for later in range(index, number[PICKS]):
                _copy(pick, later + 1, pick, later)
        index -= 1


@kernel
def sum_up_picks(choice: Choice) -> None:
    """Note when the last robot picked comes, and the longest chain that leaves."""
    comes, leaves = 0, 0
    for index in range(choice.number[PICKS]):
        comes = max(comes, choice.pick[index].comes)
        leaves = max(leaves, choice.pick[index].leaves)
    choice.number[COMES], choice.number[LEAVES] = comes, leaves
