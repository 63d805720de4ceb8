"""Who has time to spare looks at what nobody has seen yet, and is at its next task in time.

Robots that would wait for others, or that have nothing to do, lose nothing by it, and what is known
earlier makes better plans.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from teamformer.base.array_types import Array
from teamformer.mission.coordination import Known, Plan
from teamformer.planning.steps.situation import Situation, situation_of
from teamformer.world.rules.constants import FAR

SOONER = 3
"""By how many steps a look must come before the service, for anybody to make use of it."""

SEARCH = 5
"""How many steps it takes to look for a task whose place is not known, beyond the way there."""


class _Group(NamedTuple):
    """Robots of one team that have the same next task, in the numbers of a situation."""

    robots: tuple[int, ...]
    task: int | None  # None: they have nothing to do
    has_to_part: bool  # others of the team go elsewhere


class _Look(NamedTuple):
    """A group can be at a task in a step, and is at its own in time all the same."""

    there: int
    group: int
    task: int


def with_free_looks(known: Known, plan: Plan) -> Plan:
    """Return a plan in which robots that have time to spare scout.

    Every task is looked at by one group of robots at most, the one that is there first, and every
    group looks at one.
    """
    takes = dict.fromkeys(known.unseen_needs, 0) | dict.fromkeys(known.unseen_places, SEARCH)
    if takes.keys().isdisjoint(plan.order):
        return plan
    situation = situation_of(replace(known, open_tasks=plan.order))
    groups = _groups_of(plan, situation)
    scouts: list[tuple[int, int]] = []
    is_out, is_scouted = np.zeros(len(groups), np.bool_), np.zeros(len(plan.order), np.bool_)
    for _, number, task in sorted(_free_looks(plan, situation, known.step, takes, groups)):
        if not is_out[number] and not is_scouted[task]:
            is_out[number] = is_scouted[task] = True
            scouts += [(situation.robots[r], situation.tasks[task]) for r in groups[number].robots]
    return replace(plan, scouts=tuple(sorted(scouts)))


def _groups_of(plan: Plan, situation: Situation) -> list[_Group]:
    place = {task: index for index, task in enumerate(situation.tasks)}
    following: dict[int, int] = {}
    for task, robots in zip(plan.order, plan.coalitions, strict=True):
        for robot in robots:
            following.setdefault(robot, place[task])
    together: dict[tuple[int, int | None], list[int]] = {}
    for index, robot in enumerate(situation.robots):
        key = int(situation.company[index]), following.get(robot)
        together.setdefault(key, []).append(index)
    leaders = [leader for leader, _ in together]
    return [
        _Group(tuple(robots), task, leaders.count(leader) > 1)
        for (leader, task), robots in together.items()
    ]


def _free_looks(
    plan: Plan, situation: Situation, step: int, takes: Mapping[int, int],
    groups: list[_Group],
) -> Iterator[_Look]:  # fmt: skip
    """Yield what groups can look at in time, before anybody begins there.

    `takes` are the tasks that have something to be seen, and how many steps that takes beyond the
    way there.
    """
    problem, forming = situation.problem, situation.forming_steps
    no_way = problem.steps.shape[1] - 1
    speeds = len(problem.steps) // len(problem.lengths)
    starts, sizes = _services(plan, situation)
    tasks = np.array([k for k, task in enumerate(situation.tasks) if task in takes], np.int64)
    lasts = np.array([takes[situation.tasks[task]] for task in tasks], np.int64)
    for number, (robots, following, has_to_part) in enumerate(groups):
        slowest = min(problem.speed[robot] for robot in robots)
        flies = all(problem.pace[robot] >= speeds for robot in robots)
        rank = next(int(problem.pace[r]) for r in robots if problem.speed[r] == slowest) % speeds
        steps_of = problem.steps[rank + speeds if flies else rank]
        leaves = max(step, *(int(problem.ready[robot]) for robot in robots)) + forming * has_to_part
        cells = problem.cells[tasks, len(starts) + robots[0]]
        there = leaves + steps_of[cells]
        is_free = (cells < no_way) & (there + SOONER <= starts[tasks])
        if following is not None:
            back = there + lasts + steps_of[problem.cells[following, tasks]]
            is_free &= back + forming * sizes[following] <= starts[following]
            is_free &= tasks != following
        for index in np.flatnonzero(is_free).tolist():
            yield _Look(int(there[index]), number, int(tasks[index]))


def _services(plan: Plan, situation: Situation) -> tuple[Array, Array]:
    """Return when each task's service is to begin, and how many robots do it."""
    place = {task: index for index, task in enumerate(situation.tasks)}
    starts = np.full(len(place), FAR, np.int64)
    sizes = np.zeros(len(place), np.int64)
    for task, robots, end in zip(plan.order, plan.coalitions, plan.ends, strict=True):
        starts[place[task]] = end - situation.problem.duration[place[task]]
        sizes[place[task]] = len(robots)
    return starts, sizes
