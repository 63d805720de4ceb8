"""The search: annealing (Kirkpatrick et al. 1983) without exponentials, clocks or fractions.

The same problem, seed and rounds make the same plan on every machine: all is counted in whole
numbers, and the logarithms that decide how much worse a plan may be come from a table.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from teamformer.jit import entry, kernel
from teamformer.planning.coalitions.problem import NOBODY, CoalitionProblem
from teamformer.planning.coalitions.search.coalition_choice import pick_earliest
from teamformer.planning.coalitions.search.neighbourhood import propose
from teamformer.planning.coalitions.search.schedule import (
    BACK_SUM,
    COST,
    SPREAD,
    CoalitionPlan,
    Schedule,
    copy_plan,
    empty_plan,
    empty_schedule,
    time_one,
    time_plan,
)
from teamformer.planning.coalitions.search.tail_exchange import exchange_tails
from teamformer.planning.coalitions.search.window import (
    REFUSED,
    commit_window,
    empty_desk,
    judge_window,
)
from teamformer.planning.relaxation.insertion import draw_below

if TYPE_CHECKING:
    from teamformer.planning.coalitions.search.window import Desk
    from teamformer.rules.arrays import Array

STEPS = 1024
SLACKS = np.array([int(-STEPS * math.log((i + 0.5) / STEPS)) for i in range(STEPS)], np.int64)
"""How much worse a plan may be, in 1024ths of the temperature: the chance to be allowed x or more
is exp(-x). No entry is near enough to a whole number for a processor to round it otherwise."""

EXCHANGES = 15  # percent
"""How many of the changes exchange the rests of two robots' routes."""


class CoalitionSearch:
    """A search: where it stands, the best plan since it was begun anew, and room to work in."""

    def __init__(self, problem: CoalitionProblem, seed: int) -> None:
        self.problem = problem
        self._schedule, self._best = empty_schedule(problem), empty_plan(problem)
        self._desk = empty_desk(problem, seed)
        self._best_cost = np.array([2**62])

    def begin_anew(self) -> bool:
        """Make a first plan in a random order; say whether every task has an able coalition."""
        if not construct(self.problem, self._schedule, self._desk):
            return False
        self.begin_at(self._schedule.plan)
        return True

    def begin_at(self, plan: CoalitionPlan) -> None:
        """Stand at a plan."""
        copy_plan(plan, self._schedule.plan)
        self._best_cost[0] = time_plan(self.problem, self._schedule)
        copy_plan(plan, self._best)

    def begin_at_best(self) -> None:
        """Go back to the best plan."""
        self.begin_at(self._best)

    @property
    def leg(self) -> int:
        """Return the ticks that a task takes a robot on average, with the way there."""
        visits = int(self._schedule.plan.size.sum())
        return max(1, int(self._schedule.total[COST]) * len(self.problem.counts) // visits)

    def anneal(self, hot: int, cold: int, begin: int, end: int, rounds: int) -> None:
        """Make the rounds from `begin` to `end` of so many, from `hot` to `cold`."""
        parts = (self._best, self._best_cost, self._desk)
        anneal(self.problem, self._schedule, *parts, SLACKS, hot, cold, begin, end, rounds)

    @property
    def cost(self) -> int:
        """Return what the best plan costs."""
        return int(self._best_cost[0])

    @property
    def best(self) -> CoalitionPlan:
        """Return a copy of the best plan."""
        return CoalitionPlan(*(array.copy() for array in self._best))


def schedule_of(problem: CoalitionProblem, plan: CoalitionPlan) -> Schedule:
    """Return a plan with its times."""
    schedule = empty_schedule(problem)
    copy_plan(plan, schedule.plan)
    time_plan(problem, schedule)
    return schedule


@entry
def anneal(
    problem: CoalitionProblem,
    schedule: Schedule,
    best: CoalitionPlan,
    best_cost: Array,
    desk: Desk,
    slacks: Array,
    hot: int,
    cold: int,
    begin: int,
    end: int,
    rounds: int,
) -> None:
    """Make changes; keep those that are better or, while it is hot, a bit worse."""
    robots, total = len(problem.origin), schedule.total
    for turn in range(begin, end):
        temperature = hot + (cold - hot) * turn // rounds
        slack = temperature * slacks[draw_below(desk.random, len(slacks))] // STEPS
        allowed = total[COST] + slack
        limit = allowed - total[BACK_SUM] // (SPREAD * robots) + temperature // 8
        if not _change(problem, schedule, desk, limit, allowed):
            continue
        if total[COST] < best_cost[0]:
            best_cost[0] = total[COST]
            copy_plan(schedule.plan, best)


@kernel
def _change(
    problem: CoalitionProblem, schedule: Schedule, desk: Desk, limit: int, allowed: int
) -> bool:
    """Try a random change; say whether the plan has changed."""
    if draw_below(desk.random, 100) < EXCHANGES:
        return exchange_tails(problem, schedule, desk, limit, allowed)
    if not propose(problem, schedule, desk):
        return False
    if judge_window(problem, schedule, desk, limit, allowed) >= REFUSED:
        return False
    commit_window(problem, schedule, desk)
    return True


@entry
def construct(problem: CoalitionProblem, schedule: Schedule, desk: Desk) -> bool:
    """Plan tasks in a random order that precedence allows, each by whoever is there first."""
    order, tasks = schedule.plan.order, len(schedule.plan.order)
    for task in range(tasks):
        schedule.rank[task] = tasks
        schedule.plan.size[task] = 0
    for robot in range(len(problem.origin)):
        schedule.last[0, robot] = problem.origin[robot]
    for position in range(tasks):
        task = _draw_ready(problem, schedule, desk, tasks)
        order[position] = task
        schedule.rank[task] = position
        desk.span[0] = desk.span[1] = position
        desk.clock[0] += 1
        if not pick_earliest(problem, schedule, desk, task, 0):
            return False
        schedule.plan.size[task] = desk.picks[0]
        for seat in range(desk.picks[0]):
            schedule.plan.coalition[task, seat] = desk.pick[seat]
        time_one(problem, schedule, position)
    return True


@kernel
def _draw_ready(problem: CoalitionProblem, schedule: Schedule, desk: Desk, tasks: int) -> int:
    """Draw a task that is not planned while all that come before it are."""
    task = draw_below(desk.random, tasks)
    while not is_ready(problem, schedule, task):
        task = (task + 1) % tasks
    return task


@kernel
def is_ready(problem: CoalitionProblem, schedule: Schedule, task: int) -> bool:
    """Say whether a task is not planned while all that come before it are; others have no rank."""
    tasks = len(schedule.rank)
    if schedule.rank[task] < tasks:
        return False
    for other in problem.before[task]:
        if other == NOBODY:
            break
        if schedule.rank[other] == tasks:
            return False
    return True
