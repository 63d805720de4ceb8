"""Offers: tasks that could be given out next, each with robots that would do it.

Of each of the tasks that can begin soonest there are two offers: by those who are there first, and
by those among them who are less wanted elsewhere. Features are shares, counts, and lengths of time
in what a task takes a robot on average. None belongs to a capability, a robot or a task, so one
network serves any fleet, in steps and in continuous time.
"""

from __future__ import annotations

from enum import IntEnum
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import numpy.typing as npt

from teamformer.base.array_types import Array, Int32s, Ints
from teamformer.base.kernels.jit import entry, kernel
from teamformer.planning.dispatch.futures import (
    Calls,
    call,
    empty_calls,
    have_done,
    is_ready,
    leg_of,
)
from teamformer.planning.problem.coalition_problem import NEVER, NOBODY, CoalitionProblem
from teamformer.planning.problem.schedule import arrival, released

if TYPE_CHECKING:
    from teamformer.planning.problem.schedule import Schedule

MOST_TASKS = 24
"""Of how many tasks there are offers: those that can begin soonest."""

MOST_OFFERS = 2 * MOST_TASKS

OFFER_INPUTS = ("features", "is_offer")
"""What a network's file takes: (states, offers, features) and which offers there are."""

FARTHEST = 6.0
"""Times are clipped here, in what a task takes a robot."""


class OfferFeature(IntEnum):
    """What the network sees of an offer; times as said above."""

    BEGINS = 0  # after the first that could begin
    BEGINS_NEAR = 1  # the same, clipped at 1
    LONGEST_WAY = 2
    MEAN_WAY = 3
    MEAN_WAIT = 4  # of those who are there before it begins
    ROBOT_TIME = 5  # of all robots until it begins
    DURATION = 6
    SIZE = 7
    COMES_APART = 8  # robots come from different places
    SCARCITY = 9  # of the scarcest capability that it needs, among all tasks
    SCARCITY_NOW = 10  # among those left
    SPARED = 11  # of the scarcest that its robots have and it does not need
    SURPLUS = 12  # share of what its robots bring that it does not need
    NEXT = 13  # the way from it to the nearest task left
    SECOND_NEXT = 14
    NEIGHBOURS = 15  # tasks left within half of what a task takes
    REMOTENESS = 16  # the mean way from it to tasks left
    NEXT_TOGETHER = 17  # the way to the nearest task that the same robots can do
    FOLLOWERS = 18  # tasks that come after it
    CHAIN = 19  # the longest of these
    DUE = 20  # how long before it is due it ends
    HAS_DUE = 21
    OPENS_LATE = 22  # how long its robots wait for its window, or for what it is after
    TASKS_LEFT = 23
    LOAD = 24  # tasks left for each robot
    RANK = 25  # by when it begins, as a share of the offers
    IS_SPARING = 26
    RIVALS = 27  # offers that begin before it ends and want some of its robots
    RIVAL_BEGINS = 28  # the first of these
    IS_ALIKE = 29  # both offers of the task are the same


FEATURES = len(OfferFeature)


class Offers(NamedTuple):
    """What is on offer in a state, and room to work it out."""

    features: npt.NDArray[np.float32]  # (offers, FEATURES)
    task: Int32s  # (offers,) the first `made` of them
    made: Int32s  # (1,) how many these are
    load: Ints  # (caps,) what is left to do with each capability, in 1024ths for each that there is


class Dispatcher(NamedTuple):
    """A problem as it is given out: who would be called for each task, first or sparingly."""

    first: Calls
    sparing: Calls
    offers: Offers


def empty_dispatcher(problem: CoalitionProblem, seed: int = 0) -> Dispatcher:
    """Return room to give out the tasks of a problem."""
    caps = problem.counts.shape[1]
    first, sparing = empty_calls(problem, seed), empty_calls(problem, seed)
    load = problem.needs.sum(axis=0) / np.maximum(1, problem.counts.sum(axis=0))
    wanted = (problem.counts > 0) * load / max(1e-9, load.max(initial=0.0))
    sparing.reserve[:] = leg_of(problem) * wanted.sum(axis=1) / 2
    return Dispatcher(
        first,
        sparing,
        Offers(
            features=np.zeros((MOST_OFFERS, FEATURES), np.float32),
            task=np.zeros(MOST_OFFERS, np.int32),
            made=np.zeros(1, np.int32),
            load=np.zeros(caps, np.int64),
        ),
    )


@entry
def make_offers(
    problem: CoalitionProblem, schedule: Schedule, dispatcher: Dispatcher, position: int, leg: int
) -> int:
    """Write what is on offer at a position of the order; return how many offers there are."""
    first, sparing, offers = dispatcher.first, dispatcher.sparing, dispatcher.offers
    kept = 0
    for task in range(len(schedule.rank)):
        first.is_stale[task] = sparing.is_stale[task] = True
    for task in range(len(schedule.rank)):
        if not is_ready(problem, schedule, task):
            continue
        call(problem, schedule, first, task, position)
        if first.begin[task] < NEVER:
            kept = _insert(first, offers.task, task, kept)
    _weigh_load(problem, schedule, offers.load)
    for place in range(kept - 1, -1, -1):
        task = offers.task[place]
        call(problem, schedule, sparing, task, position)
        offers.task[2 * place] = offers.task[2 * place + 1] = task
    offers.made[0] = 2 * kept
    for offer in range(2 * kept):
        _describe(problem, schedule, dispatcher, offer, position, leg)
    return 2 * kept


@entry
def accept_offer(
    problem: CoalitionProblem, schedule: Schedule, dispatcher: Dispatcher, offer: int, position: int
) -> None:
    """Have the task of an offer done next by its robots."""
    task = dispatcher.offers.task[offer]
    calls = dispatcher.sparing if offer % 2 else dispatcher.first
    have_done(problem, schedule, calls, task, position)


@kernel
def _insert(calls: Calls, tasks: Array, task: int, kept: int) -> int:
    """Keep a task if it is among those that can begin soonest; return how many are kept."""
    place = kept
    while place > 0 and calls.begin[tasks[place - 1]] > calls.begin[task]:
        if place < MOST_TASKS:
            tasks[place] = tasks[place - 1]
        place -= 1
    if place < MOST_TASKS:
        tasks[place] = task
    return min(kept + 1, MOST_TASKS)


@kernel
def _weigh_load(problem: CoalitionProblem, schedule: Schedule, load: Array) -> None:
    """Write how much is left to do with each capability, for each of it that robots bring."""
    for cap in range(len(load)):
        needed, brought = 0, 0
        for task in range(len(schedule.rank)):
            if schedule.rank[task] == len(schedule.rank):
                needed += problem.needs[task, cap]
        for robot in range(problem.counts.shape[0]):
            brought += problem.counts[robot, cap]
        load[cap] = 1024 * needed // max(1, brought)


@kernel
def _clip(ticks: int, leg: int) -> float:
    """Return a time in what a task takes a robot, clipped."""
    return max(-FARTHEST, min(FARTHEST, ticks / leg)) / 2


@kernel
def _describe(
    problem: CoalitionProblem,
    schedule: Schedule,
    dispatcher: Dispatcher,
    offer: int,
    position: int,
    leg: int,
) -> None:
    """Write the features of an offer."""
    offers, first = dispatcher.offers, dispatcher.first
    task, is_sparing = offers.task[offer], offer % 2 == 1
    calls = dispatcher.sparing if is_sparing else first
    out, soonest = offers.features[offer], first.begin[offers.task[0]]
    tasks = len(schedule.rank)
    out[OfferFeature.BEGINS] = _clip(calls.begin[task] - soonest, leg)
    out[OfferFeature.BEGINS_NEAR] = min(1.0, (calls.begin[task] - soonest) / leg)
    out[OfferFeature.DURATION] = _clip(problem.duration[task], leg)
    out[OfferFeature.SCARCITY] = calls.scarcity[task] / 1024
    out[OfferFeature.HAS_DUE] = problem.due[task] < NEVER
    out[OfferFeature.DUE] = 0.0
    if problem.due[task] < NEVER:
        out[OfferFeature.DUE] = _clip(
            problem.due[task] - calls.begin[task] - problem.duration[task], leg
        )
    out[OfferFeature.TASKS_LEFT] = np.log2(1.0 + tasks - position) / 8
    out[OfferFeature.LOAD] = min(4.0, (tasks - position) / len(problem.origin) / 4)
    out[OfferFeature.RANK] = offer // 2 / max(1, offers.made[0] // 2)
    out[OfferFeature.IS_SPARING] = is_sparing
    _describe_robots(problem, schedule, calls, out, task, position, leg)
    _describe_load(problem, calls, offers.load, out, task)
    _describe_places(problem, schedule, calls, out, task, leg)
    _describe_followers(problem, out, task, leg)
    _describe_rivals(problem, dispatcher, calls, out, task, leg)


@kernel
def _describe_robots(
    problem: CoalitionProblem,
    schedule: Schedule,
    calls: Calls,
    out: Array,
    task: int,
    position: int,
    leg: int,
) -> None:
    """Say how far its robots go, and how long they wait."""
    size, longest, ways, waits, used, latest = calls.size[task], 0, 0, 0, 0, 0
    is_apart = False
    for seat in range(size):
        robot = calls.team[task, seat]
        place = schedule.last[position, robot]
        way = problem.ways[problem.pace[robot], place, task]
        there = arrival(problem, schedule, robot, task, position)
        longest, ways, latest = max(longest, way), ways + way, max(latest, there)
        waits += calls.begin[task] - there
        used += calls.begin[task] - schedule.end[place]
        is_apart |= (
            problem.site[place] != problem.site[schedule.last[position, calls.team[task, 0]]]
        )
    out[OfferFeature.LONGEST_WAY] = _clip(longest, leg)
    out[OfferFeature.MEAN_WAY] = _clip(ways // max(1, size), leg)
    out[OfferFeature.MEAN_WAIT] = _clip(waits // max(1, size), leg)
    out[OfferFeature.ROBOT_TIME] = _clip(used // 4, leg)
    out[OfferFeature.SIZE] = min(size, 8) / 8
    out[OfferFeature.COMES_APART] = is_apart
    out[OfferFeature.OPENS_LATE] = _clip(
        max(0, released(problem, schedule.end, task) - latest), leg
    )


@kernel
def _describe_load(
    problem: CoalitionProblem, calls: Calls, load: Array, out: Array, task: int
) -> None:
    """Say how scarce is what it needs, and what its robots bring beside that."""
    most, needed, spared, beyond, brought = 1, 0, 0, 0, 0
    for cap in range(len(load)):
        most = max(most, load[cap])
        if problem.needs[task, cap] > 0:
            needed = max(needed, load[cap])
        has = 0
        for seat in range(calls.size[task]):
            has += problem.counts[calls.team[task, seat], cap]
        brought += has
        beyond += max(0, has - problem.needs[task, cap])
        if has > 0 and problem.needs[task, cap] == 0:
            spared = max(spared, load[cap])
    out[OfferFeature.SCARCITY_NOW] = needed / most
    out[OfferFeature.SPARED] = spared / most
    out[OfferFeature.SURPLUS] = beyond / max(1, brought)


@kernel
def _describe_places(
    problem: CoalitionProblem, schedule: Schedule, calls: Calls, out: Array, task: int, leg: int
) -> None:
    """Say how far other tasks are from it."""
    tasks, pace = len(schedule.rank), problem.pace[calls.team[task, 0]]
    nearest, second, together = NEVER, NEVER, NEVER
    total, others, near = 0, 0, 0
    for other in range(tasks):
        if other == task or schedule.rank[other] < tasks:
            continue
        way = problem.ways[pace, task, other]
        others += 1
        total += min(way, 8 * leg)
        near += 2 * way <= leg
        if way < nearest:
            nearest, second = way, nearest
        else:
            second = min(second, way)
        if way < together and _can_all_do(problem, calls, task, other):
            together = way
    out[OfferFeature.NEXT] = _clip(nearest, leg)
    out[OfferFeature.SECOND_NEXT] = _clip(second, leg)
    out[OfferFeature.NEXT_TOGETHER] = _clip(together, leg)
    out[OfferFeature.NEIGHBOURS] = min(near, 8) / 8
    out[OfferFeature.REMOTENESS] = _clip(total // max(1, others), leg)


@kernel
def _can_all_do(problem: CoalitionProblem, calls: Calls, task: int, other: int) -> bool:
    """Say whether the robots that do a task can do another one."""
    for cap in range(problem.needs.shape[1]):
        short = problem.needs[other, cap]
        if short > 0:
            for seat in range(calls.size[task]):
                short -= problem.counts[calls.team[task, seat], cap]
            if short > 0:
                return False
    return True


@kernel
def _describe_followers(problem: CoalitionProblem, out: Array, task: int, leg: int) -> None:
    """Say what comes after it."""
    followers, longest = 0, 0
    for other in problem.after[task]:
        if other == NOBODY:
            break
        followers += 1
        longest = max(longest, problem.duration[other] + problem.ways[0, task, other])
    out[OfferFeature.FOLLOWERS] = min(followers, 4) / 4
    out[OfferFeature.CHAIN] = _clip(longest, leg)


@kernel
def _describe_rivals(
    problem: CoalitionProblem, dispatcher: Dispatcher, calls: Calls, out: Array, task: int, leg: int
) -> None:
    """Say which other offers want some of its robots before it ends."""
    first, offers = dispatcher.first, dispatcher.offers
    end, soonest = calls.begin[task] + problem.duration[task], first.begin[offers.task[0]]
    rivals, begins = 0, NEVER
    for place in range(0, offers.made[0], 2):
        other = offers.task[place]
        if other == task or first.begin[other] > end:
            continue
        is_rival = False
        for seat in range(first.size[other]):
            for mine in range(calls.size[task]):
                is_rival |= first.team[other, seat] == calls.team[task, mine]
        if is_rival:
            rivals += 1
            begins = min(begins, first.begin[other])
    out[OfferFeature.RIVALS] = min(rivals, 8) / 8
    out[OfferFeature.RIVAL_BEGINS] = _clip(begins - soonest, leg)
    is_alike = dispatcher.sparing.size[task] == first.size[task]
    for seat in range(first.size[task]):
        is_alike &= dispatcher.sparing.team[task, seat] == first.team[task, seat]
    out[OfferFeature.IS_ALIKE] = is_alike
