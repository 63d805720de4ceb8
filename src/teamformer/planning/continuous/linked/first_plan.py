"""A first plan of linked tasks: groups in a random order, each by random robots that are able.

It is plain Python: it is made once for a hundred thousand changes, and compiles in no time.
"""

from __future__ import annotations

from random import Random

from teamformer.planning.continuous.linked.problem import LinkedProblem
from teamformer.planning.continuous.linked.schedule import LinkedSchedule
from teamformer.planning.continuous.problem import NOBODY


def construct(problem: LinkedProblem, schedule: LinkedSchedule, draws: Random) -> bool:
    """Write a plan without its times; say whether every task has found a coalition."""
    base, group_of = problem.base, problem.group.tolist()
    before = [[other for other in row if other != NOBODY] for row in base.before.tolist()]
    members = [[task for task in row if task != NOBODY] for row in problem.members.tolist()]
    waiting = [{group_of[other] for task in tasks for other in before[task]} for tasks in members]
    left = set(range(len(members)))
    for position in range(len(members)):
        ready = [group for group in sorted(left) if not waiting[group] & left]
        group = _draw(ready, draws)
        left.remove(group)
        schedule.order[position], schedule.rank[group] = group, position
        taken: set[int] = set()
        tasks = members[group]
        while tasks:
            task = _draw(tasks, draws)
            coalition = _able_coalition(problem, task, taken, draws)
            if coalition is None:
                return False
            schedule.size[task] = len(coalition)
            schedule.coalition[task, : len(coalition)] = coalition
            taken |= set(coalition)
            tasks = [other for other in tasks if other != task]
    return True


def _able_coalition(
    problem: LinkedProblem, task: int, taken: set[int], draws: Random
) -> list[int] | None:
    """Return robots that bring what a task needs, none of them to spare; None if too few are left.

    None of `taken` is among them.
    """
    counts, needs = problem.base.counts, problem.base.needs[task]
    free = [robot for robot in range(len(counts)) if robot not in taken]
    coalition: list[int] = []
    while (lacking := needs - counts[coalition].sum(axis=0)).max() > 0:
        helps = [robot for robot in free if (counts[robot][lacking > 0] > 0).any()]
        if not helps:
            return None
        coalition.append(_draw(helps, draws))
        free.remove(coalition[-1])
    for robot in list(coalition):
        others = [other for other in coalition if other != robot]
        if (counts[others].sum(axis=0) >= needs).all():
            coalition = others
    return coalition


def _draw(choices: list[int], draws: Random) -> int:
    """Draw one of several; `random` is what Python keeps the same from version to version."""
    return choices[int(draws.random() * len(choices))]
