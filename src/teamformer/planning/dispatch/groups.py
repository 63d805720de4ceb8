"""Linked tasks in futures: given out one after the other, to different robots, held as gaps ask."""

from __future__ import annotations

from typing import TYPE_CHECKING

from teamformer.base.kernels.jit import kernel
from teamformer.planning.problem.coalition_problem import NOBODY, CoalitionProblem
from teamformer.planning.problem.links import FREE
from teamformer.planning.problem.schedule import released, time_one

if TYPE_CHECKING:
    from teamformer.planning.problem.schedule import Schedule


@kernel
def are_linked(problem: CoalitionProblem) -> bool:
    """Say whether starts of some tasks are linked."""
    return problem.links.members.shape[1] > 2  # the last column is empty


@kernel
def begun_group(problem: CoalitionProblem, schedule: Schedule) -> int:
    """Return the group of which some tasks are given out and some are not; NOBODY if there is none.

    Its tasks come next, so that no robot waits for one that waits for it.
    """
    links, tasks = problem.links, len(schedule.rank)
    for task in range(tasks):
        if schedule.rank[task] == tasks:
            continue
        for other in links.members[links.group[task]]:
            if other == NOBODY:
                break
            if schedule.rank[other] == tasks:
                return int(links.group[task])
    return NOBODY


@kernel
def may_begin(problem: CoalitionProblem, schedule: Schedule, task: int) -> bool:
    """Say whether all is given out that comes before the tasks that one is linked with."""
    links, tasks = problem.links, len(schedule.rank)
    for member in links.members[links.group[task]]:
        if member == NOBODY:
            break
        for other in problem.before[member]:
            if other == NOBODY:
                break
            if schedule.rank[other] == tasks and links.group[other] != links.group[task]:
                return False
    return True


@kernel
def is_taken(problem: CoalitionProblem, schedule: Schedule, task: int, robot: int) -> bool:
    """Say whether a robot does a task whose start is linked with that of another one."""
    if not are_linked(problem) or robot >= problem.bodies:
        return False
    links, tasks = problem.links, len(schedule.rank)
    for other in links.members[links.group[task]]:
        if other == NOBODY:
            break
        if schedule.rank[other] == tasks or links.gap[task, other] == FREE:
            continue
        for seat in range(schedule.plan.size[other]):
            if schedule.plan.coalition[other, seat] == robot:
                return True
    return False


@kernel
def opens(problem: CoalitionProblem, schedule: Schedule, task: int) -> int:
    """Return when a task may start, whoever is there: linked ones are given out before."""
    start = released(problem, schedule.end, task)
    if not are_linked(problem):
        return start
    links, tasks = problem.links, len(schedule.rank)
    for other in links.members[links.group[task]]:
        if other == NOBODY:
            break
        if schedule.rank[other] < tasks and links.gap[other, task] > FREE:
            start = max(start, schedule.start[other] + links.gap[other, task])
    return start


@kernel
def time_next(problem: CoalitionProblem, schedule: Schedule, position: int) -> None:
    """Time the task at a position of the order, and hold those that it is linked with."""
    time_one(problem, schedule, position)
    if are_linked(problem):
        _hold(problem, schedule, schedule.plan.order[position])


@kernel
def _hold(problem: CoalitionProblem, schedule: Schedule, task: int) -> None:
    """Put off the starts of a group, as far as it is given out, until no gap is too small."""
    links, tasks = problem.links, len(schedule.rank)
    members = links.members[links.group[task]]
    for _ in range(len(members)):  # each turn settles one more of a chain
        for one in members:
            if one == NOBODY:
                break
            for other in members:
                if other == NOBODY:
                    break
                if schedule.rank[one] == tasks or schedule.rank[other] == tasks:
                    continue
                if links.gap[one, other] > FREE:
                    late = schedule.start[one] + links.gap[one, other] - schedule.start[other]
                    schedule.start[other] += max(0, late)
                    schedule.end[other] += max(0, late)


@kernel
def time_again(problem: CoalitionProblem, schedule: Schedule, position: int) -> None:
    """Time what was given out before a position, if starts are linked: some may have been held."""
    if are_linked(problem):
        for earlier in range(position):
            schedule.rank[schedule.plan.order[earlier]] = len(schedule.rank)
        for earlier in range(position):
            time_next(problem, schedule, earlier)
