"""A first plan of linked tasks: groups one after the other, each by robots that are able.

It is plain Python: it is made once for millions of changes, and compiles in no time.
"""

from __future__ import annotations

from random import Random

import numpy as np

from teamformer.planning.problem.coalition_plan import CoalitionPlan, empty_plan, without_spares
from teamformer.planning.problem.coalition_problem import NOBODY, CoalitionProblem
from teamformer.planning.problem.links import FREE


def construct(problem: CoalitionProblem, draws: Random | None) -> CoalitionPlan | None:
    """Return a plan, its linked tasks beside one another; None if some task finds no coalition.

    Without `draws` the group that is due first is next, by robots that are there soonest; with
    them both are drawn.
    """
    links = problem.links
    group_of, is_linked = links.group.tolist(), links.gap > FREE
    before = [[other for other in row if other != NOBODY] for row in problem.before.tolist()]
    members = [[task for task in row if task != NOBODY] for row in links.members.tolist()]
    waiting = [{group_of[other] for task in tasks for other in before[task]} for tasks in members]
    due = [min((int(problem.due[t]), int(problem.release[t])) for t in tasks) for tasks in members]
    left, plan, order = set(range(len(members))), empty_plan(problem), list[int]()
    place = problem.origin.astype(np.int64)
    free = problem.ready[place - len(problem.needs)]
    while left:
        ready = [group for group in sorted(left) if not waiting[group] & left]
        group = _draw(ready, draws) if draws else min(ready, key=lambda one: (due[one], one))
        left.remove(group)
        tasks = list(members[group])
        while tasks:
            task = _draw(tasks, draws) if draws else tasks[0]
            taken = {
                robot
                for other in np.flatnonzero(is_linked[task])
                for robot in plan.coalition[other, : plan.size[other]].tolist()
            }
            comes = np.maximum(
                free + problem.ways[problem.pace, place, task], problem.release[task]
            )
            slower = problem.slower[problem.pace, task]
            coalition = _able_coalition(problem, task, taken, comes + slower, draws)
            if coalition is None:
                return None
            plan.size[task] = len(coalition)
            plan.coalition[task, : len(coalition)] = coalition
            tasks.remove(task)
            order.append(task)
            place[coalition] = task
            takes = problem.duration[task] + slower[coalition].max()
            free[coalition] = comes[coalition].max() + takes
    plan.order[:] = order
    return plan


def _able_coalition(
    problem: CoalitionProblem,
    task: int,
    taken: set[int],
    comes: np.ndarray[tuple[int], np.dtype[np.int64]],
    draws: Random | None,
) -> list[int] | None:
    """Return robots that bring what a task needs, none of them to spare; None if too few are left.

    None of `taken` is among them.
    """
    counts, needs = problem.counts, problem.needs[task]
    free = [robot for robot in range(len(counts)) if robot not in taken]
    coalition: list[int] = []
    while (lacking := needs - counts[coalition].sum(axis=0)).max() > 0:
        helps = [robot for robot in free if (counts[robot][lacking > 0] > 0).any()]
        if not helps:
            return None
        soonest = min(helps, key=lambda robot: (comes[robot], robot))
        coalition.append(_draw(helps, draws) if draws else soonest)
        free.remove(coalition[-1])
    return without_spares(counts, needs, coalition[::-1])[::-1]


def _draw(choices: list[int], draws: Random) -> int:
    """Draw one of several; `random` is what Python keeps the same from version to version."""
    return choices[int(draws.random() * len(choices))]
