"""The search for plans of linked tasks: annealing, in whole numbers as for all other plans."""

from __future__ import annotations

from teamformer.jit import entry, kernel
from teamformer.planning.coalitions.linked.moves import (
    NO_CHANGE,
    change,
    gather,
)
from teamformer.planning.coalitions.linked.problem import LinkedProblem
from teamformer.planning.coalitions.linked.schedule import (
    LinkedSchedule,
    copy_from,
    empty_linked_schedule,
    time_group,
    time_linked,
)
from teamformer.planning.coalitions.problem import NOBODY
from teamformer.planning.coalitions.search.annealing import SLACKS, STEPS
from teamformer.planning.coalitions.search.window import empty_desk
from teamformer.planning.relaxation.insertion import draw_below

TRIES = 100
"""How many first plans are begun before nobody is said to be able: linked tasks take robots from
one another."""


class LinkedSearch:
    """A search: where it stands, the best plan since it was begun anew, and room to work in."""

    def __init__(self, problem: LinkedProblem, seed: int) -> None:
        self.problem = problem
        self._now, self._next, self._best = (empty_linked_schedule(problem) for _ in range(3))
        self._desk = empty_desk(problem.base, seed)

    def begin_anew(self) -> bool:
        """Make a first plan in a random order; say whether every task has an able coalition."""
        for _ in range(TRIES):
            if construct_linked(self.problem, self._now, self._desk):
                stand_at(self._now, self._next)
                stand_at(self._now, self._best)
                return True
        return False

    def begin_at_best(self) -> None:
        """Go back to the best plan."""
        stand_at(self._best, self._now)
        stand_at(self._best, self._next)

    def begin_at(self, schedule: LinkedSchedule) -> None:
        """Stand at a plan."""
        stand_at(schedule, self._best)
        self.begin_at_best()

    @property
    def leg(self) -> int:
        """Return what a robot's visit to a task costs on average."""
        return max(1, int(self._now.cost[0]) // int(self._now.size.sum()))

    def anneal(self, hot: int, cold: int, begin: int, end: int, rounds: int) -> None:
        """Make the rounds from `begin` to `end` of so many, from `hot` to `cold`."""
        parts = (self._now, self._next, self._best, self._desk)
        anneal_linked(self.problem, *parts, SLACKS, hot, cold, begin, end, rounds)

    @property
    def cost(self) -> int:
        """Return what the best plan costs."""
        return int(self._best.cost[0])

    @property
    def best(self) -> LinkedSchedule:
        """Return a copy of the best plan."""
        best = empty_linked_schedule(self.problem)
        stand_at(self._best, best)
        return best


def stand_at(schedule: LinkedSchedule, into: LinkedSchedule) -> None:
    """Overwrite a schedule with another."""
    for name in LinkedSchedule._fields:
        getattr(into, name)[...] = getattr(schedule, name)


@entry
def anneal_linked(problem, now, then, best, desk, slacks, hot, cold, begin, end, rounds):  # type: ignore[no-untyped-def]
    """Make changes; keep those that are better or, while it is hot, a bit worse.

    `then` is `now` between changes.
    """
    for turn in range(begin, end):
        temperature = hot + (cold - hot) * turn // rounds
        slack = temperature * slacks[draw_below(desk.random, len(slacks))] // STEPS
        first = change(problem, then, desk)
        if first != NO_CHANGE:
            time_linked(problem, then, first)
            if then.cost[0] <= now.cost[0] + slack:
                copy_from(then, now, first)
                if now.cost[0] < best.cost[0]:
                    copy_from(now, best, 0)
                continue
        copy_from(now, then, 0)


@entry
def construct_linked(problem, schedule, desk):  # type: ignore[no-untyped-def]
    """Plan groups in a random order that precedence allows, each by whoever is there first."""
    groups = len(schedule.order)
    for group in range(groups):
        schedule.rank[group] = groups
    for task in range(len(schedule.size)):
        schedule.size[task] = 0
    for position in range(groups):
        group = _draw_ready(problem, schedule, desk)
        schedule.order[position] = group
        schedule.rank[group] = position
        count = 0
        while problem.members[group, count] != NOBODY:
            count += 1
        if not gather(problem, schedule, desk, group, draw_below(desk.random, count), count):
            return False
        time_group(problem, schedule, position)
    time_linked(problem, schedule, groups)
    return True


@kernel
def _draw_ready(problem, schedule, desk):  # type: ignore[no-untyped-def]
    """Draw a group that is not planned while all that come before it are."""
    groups = len(schedule.order)
    group = draw_below(desk.random, groups)
    while not _is_ready(problem, schedule, group):
        group = (group + 1) % groups
    return group


@kernel
def _is_ready(problem, schedule, group):  # type: ignore[no-untyped-def]
    groups = len(schedule.order)
    if schedule.rank[group] < groups:
        return False
    for task in problem.members[group]:
        if task == NOBODY:
            break
        for other in problem.base.before[task]:
            if other == NOBODY:
                break
            if schedule.rank[problem.group[other]] == groups:
                return False
    return True
