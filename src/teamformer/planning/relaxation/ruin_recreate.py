"""The search for a good relaxed plan: tear a few tasks out, put each back where it costs least.

Ruin and recreate with annealing, after Christiaens and Vanden Berghe, "Slack induction by string
removals" (Transportation Science 2020), here with coalitions that wait for one another.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from teamformer.jit import allocating_kernel, entry, kernel, needs_compiling
from teamformer.planning.relaxation.insertion import draw, draw_below, empty_desk, insert_task
from teamformer.planning.relaxation.plan import (
    copy_plan,
    empty_plan,
    empty_timing,
    hang_tasks,
    overwrite_plan,
    start_tasks,
)
from teamformer.planning.relaxation.problem import Relaxed
from teamformer.planning.relaxation.schedule import Schedule, make_plan, read_schedule
from teamformer.rules.arrays import Array

if TYPE_CHECKING:
    from teamformer.planning.relaxation.insertion import Desk
    from teamformer.planning.relaxation.plan import Plan, Timing

NEARBY, STRETCH = 0.5, 0.3
"""How often tasks in one area, or done around one time, are torn out; else any tasks."""

LARGEST_RUIN = 10
"""At most so many tasks are torn out at a time."""

WALKED = 0.2
"""Steps of makespan that a step walked is worth, if every robot walks it."""

BROKEN = 1e6
"""Steps of makespan that a task without a coalition, or with a lost robot in it, is worth."""

HOT, COLD = 5.0, 0.3
"""Temperatures at the beginning and at the end of an annealing, in steps of makespan."""


class Search:
    """A search: where it stands, the best plan it has seen, and room to work in."""

    def __init__(self, problem: Relaxed, seed: int, start: Schedule | None = None) -> None:
        self.problem = problem
        self._plan, self._best, self._spare = (empty_plan(problem) for _ in range(3))
        self._timing = empty_timing(problem, self._plan)
        self._desk = empty_desk(problem, seed)
        self._torn = np.zeros(len(problem.appears), np.int32)
        self._costs = np.full(2, np.inf)  # of the plan it stands at, of the best
        if start is None:
            self.anneal(1, 0.0)  # nothing is placed yet, so this places everything
        else:
            self.restart(start)

    def restart(self, start: Schedule) -> None:
        """Go on from another schedule."""
        overwrite_plan(make_plan(self.problem, start.order, start.coalitions), self._plan)
        self._costs[0] = cost_of(self.problem, self._plan, self._timing)
        if self._costs[0] < self._costs[1]:
            overwrite_plan(self._plan, self._best)
            self._costs[1] = self._costs[0]

    def anneal(self, rounds: int, part: float) -> None:
        """Search for some rounds at the temperature of a part, from 0 to 1, of an annealing."""
        temperature = HOT * (COLD / HOT) ** part
        room = (self._spare, self._timing, self._desk, self._torn)
        _anneal(self.problem, self._plan, self._best, *room, self._costs, rounds, temperature)

    @property
    def cost(self) -> float:
        """Return what the best plan costs; it falls whenever a better one is found."""
        return float(self._costs[1])

    @property
    def best(self) -> Schedule | None:
        """Return the best schedule seen, None if each has a task that nobody is left to do."""
        return read_schedule(self.problem, self._best)


def is_compiled() -> bool:
    """Say whether the search was compiled before, so that a first plan has not to wait for it."""
    return not needs_compiling(_anneal)


@entry
def _anneal(
    problem: Relaxed,
    plan: Plan,
    best: Plan,
    spare: Array,
    timing: Timing,
    desk: Desk,
    torn: Array,
    costs: Array,
    rounds: int,
    temperature: float,
) -> None:
    """Ruin and recreate for a number of rounds.

    `plan` is where the search stands and `best` the best seen; `costs` holds the costs of both.
    `spare` and `torn` are room to work in.
    """
    for _ in range(rounds):
        copy_plan(plan, spare)
        count = ruin(problem, spare, timing, desk, torn)
        cost = recreate(problem, spare, timing, desk, torn, count)
        if cost <= costs[0] - temperature * np.log(1.0 - draw(desk.random)):
            copy_plan(spare, plan)
            costs[0] = cost
            if cost < costs[1]:
                copy_plan(spare, best)
                costs[1] = cost


@kernel
def ruin(problem: Relaxed, plan: Plan, timing: Timing, desk: Desk, torn: Array) -> Any:
    """Take tasks out of a plan; list them, and those that had no coalition; return how many."""
    first = _choose_first(problem, plan, timing, desk)
    wanted = 1 + draw_below(desk.random, min(LARGEST_RUIN, len(plan.size)))
    kind = draw(desk.random)
    if kind < NEARBY:
        _tear_nearby(plan, desk, first, wanted)
    elif kind < NEARBY + STRETCH:
        _tear_stretch(plan, desk, first, wanted)
    else:
        for _ in range(wanted):
            plan.size[draw_below(desk.random, len(plan.size))] = 0
    plan.size[first] = 0
    return _close_gaps(plan, torn)


@kernel
def _choose_first(problem: Relaxed, plan: Plan, timing: Timing, desk: Desk) -> int:
    """Choose any task, or every other time one that the makespan hangs on."""
    chosen = draw_below(desk.random, len(plan.size))
    if draw(desk.random) < 0.5:
        makespan, _, _ = start_tasks(problem, plan, timing)
        hang_tasks(problem, plan, timing)
        seen = 0
        for position in range(plan.placed[0]):
            task = plan.order[position]
            if timing.start[task] + timing.tail[task] >= makespan:
                seen += 1
                if draw_below(desk.random, seen) == 0:
                    chosen = task
    return chosen


@kernel
def _tear_nearby(plan: Plan, desk: Desk, first: int, wanted: int) -> None:
    """Take out tasks around one, most but not all of the nearest."""
    for nearby in range(desk.near.shape[1]):
        if wanted > 1 and draw(desk.random) < 0.6:
            plan.size[desk.near[first, nearby]] = 0
            wanted -= 1


@kernel
def _tear_stretch(plan: Plan, desk: Desk, first: int, wanted: int) -> None:
    """Take out tasks that are done around the same time as one."""
    at = 0
    while at < plan.placed[0] and plan.order[at] != first:
        at += 1
    begin = max(0, at - draw_below(desk.random, wanted))
    for position in range(begin, min(begin + wanted, plan.placed[0])):
        plan.size[plan.order[position]] = 0


@kernel
def _close_gaps(plan: Plan, torn: Array) -> int:
    """Drop tasks without a coalition from the order and list them; return how many."""
    kept = 0
    for position in range(plan.placed[0]):
        task = plan.order[position]
        if plan.size[task] > 0:
            plan.order[kept] = task
            kept += 1
    plan.placed[0] = kept
    count = 0
    for task in range(len(plan.size)):
        if plan.size[task] == 0:
            torn[count] = task
            count += 1
    return count


@allocating_kernel
def recreate(
    problem: Relaxed, plan: Plan, timing: Timing, desk: Desk, torn: Array, count: int
) -> Any:
    """Put tasks back, in random order; return the cost of the plan."""
    for last in range(count - 1, 0, -1):
        other = draw_below(desk.random, last + 1)
        torn[last], torn[other] = torn[other], torn[last]
    for index in range(count):
        makespan, _, _ = start_tasks(problem, plan, timing)
        hang_tasks(problem, plan, timing)
        insert_task(problem, plan, timing, desk, torn[index], makespan)
    return cost_of(problem, plan, timing)


@entry
def cost_of(problem: Relaxed, plan: Plan, timing: Timing) -> float:
    """Return what the search minimises, in steps of makespan."""
    makespan, walked, late = start_tasks(problem, plan, timing)
    undone = late + len(plan.size) - plan.placed[0]
    return makespan + WALKED * walked / len(timing.robots) + BROKEN * undone
