"""The search for plans of linked tasks: annealing.

Times are whole numbers. What they cost is a sum in floating point, always in the same order, so
that a plan is the same on every machine all the same.
"""

from __future__ import annotations

from random import Random

from teamformer.jit import entry
from teamformer.planning.continuous.coalition_choice import Workspace, empty_workspace
from teamformer.planning.continuous.linked.first_plan import construct
from teamformer.planning.continuous.linked.moves import NO_CHANGE, change
from teamformer.planning.continuous.linked.problem import LinkedProblem
from teamformer.planning.continuous.linked.schedule import (
    LinkedSchedule,
    copy_from,
    empty_linked_schedule,
    time_linked,
)
from teamformer.rules.arrays import Array
from teamformer.rules.chance import SLACKS, STEPS, draw_below

UNTIMED = -1
"""What a plan costs before its times are worked out."""

TRIES = 100
"""How many first plans are begun before nobody is said to be able: linked tasks take robots from
one another."""


class LinkedSearch:
    """A search: where it stands, the best plan since it was begun anew, and room to work in."""

    def __init__(self, problem: LinkedProblem, seed: int) -> None:
        self.problem = problem
        self._now, self._next, self._best = (empty_linked_schedule(problem) for _ in range(3))
        self._workspace, self._draws = empty_workspace(problem.base, seed), Random(seed)

    def begin_anew(self) -> bool:
        """Make a first plan in a random order; say whether every task has an able coalition."""
        for _ in range(TRIES):
            if construct(self.problem, self._next, self._draws):
                self._now.cost[0] = UNTIMED
                self.anneal(0, 0, 0, 0, 1)
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
    def leg(self) -> float:
        """Return what a robot's visit to a task costs on average."""
        return float(self._now.cost[0]) / int(self._now.size.sum())

    def anneal(self, hot: float, cold: float, begin: int, end: int, rounds: int) -> None:
        """Make the rounds from `begin` to `end` of so many, from `hot` to `cold`."""
        parts = (self._now, self._next, self._best, self._workspace)
        warmth = (float(hot), float(cold))  # of one type: it is compiled for each
        anneal_linked(self.problem, *parts, SLACKS, *warmth, begin, end, rounds)

    @property
    def cost(self) -> float:
        """Return what the best plan costs."""
        return float(self._best.cost[0])

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
def anneal_linked(
    problem: LinkedProblem,
    now: LinkedSchedule,
    then: LinkedSchedule,
    best: LinkedSchedule,
    workspace: Workspace,
    slacks: Array,
    hot: float,
    cold: float,
    begin: int,
    end: int,
    rounds: int,
) -> None:
    """Make changes; keep those that are better or, while it is hot, a bit worse.

    `then` is `now` between changes. A plan whose times are not known yet stands in `then` and is
    timed first. There is one place for each thing that is done, since each is compiled in place.
    """
    is_new = now.cost[0] == UNTIMED
    for turn in range(begin - is_new, end):
        first, slack = 0, 0.0
        if not is_new:
            temperature = hot + (cold - hot) * turn / rounds
            slack = temperature * slacks[draw_below(workspace.random, len(slacks))] / STEPS
            first = change(problem, then, workspace)
        if first != NO_CHANGE:
            time_linked(problem, then, first)
            if is_new or then.cost[0] <= now.cost[0] + slack:
                copy_from(then, now, first)
                if is_new or now.cost[0] < best.cost[0]:
                    copy_from(now, best, 0)
                is_new = False
                continue
        copy_from(now, then, 0)
