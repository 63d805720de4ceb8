"""Links between the starts of tasks, and the weights of a cost.

Tasks that are linked, directly or by others, form a group: they are planned together, and start at
once or so many ticks after one another as their gaps say. Two that are linked directly are done by
different robots. All other tasks are groups of one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from teamformer.base.array_types import Floats, Int32s, Ints
from teamformer.planning.problem.constants import NEVER, SPREAD
from teamformer.world.rules.constants import NOBODY
from teamformer.world.rules.starts import Gap

FREE = -NEVER
"""A gap that says nothing."""

MAKESPAN, HOME, TRAVEL, TARDINESS, MAX_TARDINESS, COMPLETION, MISSED, LEADS = range(8)
"""What is known of a plan: when the last robot is home, when all are home, added up, their time
on the way, by how much tasks are late, added up by weight, by how much the latest one is, when
tasks end, added up by weight; and what tasks that are missed cost a plan, and cost a search.
Plans are judged by all but HOME and LEADS, which only lead a search."""

PARTS = 8

PART_OF = {
    "makespan": MAKESPAN,
    "travel": TRAVEL,
    "tardiness": TARDINESS,
    "max_tardiness": MAX_TARDINESS,
    "completion": COMPLETION,
}
"""The parts of the cost by their names in mission files."""


class Link(NamedTuple):
    """A task starts so many ticks after another starts, `least` to `most`."""

    task: int
    other: int
    least: int
    most: int


class Links(NamedTuple):
    """What is linked with what, and what plans are judged by; empty arrays if there is neither."""

    group: Int32s  # (tasks,) the group of each
    members: Int32s  # (groups, most) the tasks of each group, then NOBODY
    gap: Ints  # (tasks, tasks) [i, j]: j starts no sooner than so many ticks after i, or FREE
    weight: Floats  # (PARTS,)
    task_weight: Floats  # (tasks,)


def no_links() -> Links:
    """Return what a problem has in which nothing is linked and the makespan alone counts."""
    no_tasks, nothing = np.zeros(0, np.int32), np.zeros(0)
    table = np.zeros((0, 0), np.int32)
    return Links(no_tasks, table, table.astype(np.int64), nothing, nothing)


def have_weights(links: Links) -> bool:
    """Say whether plans are judged by a cost, which links need too."""
    return len(links.weight) > 0


def gaps_as_told(links: Links, tasks: Sequence[int]) -> list[Gap]:
    """Return the gaps between starts of some tasks as the plain rule has them, in ticks."""
    among = set(tasks)
    return [
        Gap(later, sooner, int(links.gap[sooner, later]), NEVER)
        for sooner, later in np.argwhere(links.gap > FREE).tolist()
        if sooner in among and later in among
    ]


def is_bounded(links: Links) -> bool:
    """Say whether a bound of the makespan says something of plans in which nothing is late.

    Loads that are linked are carried as slowly as can be (`continuous_mission`): bounds may then
    be too high.
    """
    weight = links.weight
    if not have_weights(links):
        return True
    is_free = bool((links.gap == FREE).all())
    return is_free and weight[MAKESPAN] > 0 and weight[TRAVEL] == weight[COMPLETION] == 0


def link_tasks(
    tasks: int,
    robots: int,
    links: Sequence[Link],
    weight: Mapping[int, float],
    task_weight: npt.ArrayLike | None = None,
) -> Links:
    """Return links of so many tasks worked out; parts that have no weight do not count."""
    weights = np.zeros(PARTS)
    weights[list(weight)] = list(weight.values())
    weights[HOME] = weights[MAKESPAN] / (SPREAD * robots)
    gap = np.full((tasks, tasks), FREE)
    leader = list(range(tasks))
    for task, other, least, most in links:
        gap[other, task] = max(gap[other, task], least)
        gap[task, other] = max(gap[task, other], -most)
        old, new = sorted((leader[task], leader[other]), reverse=True)
        leader = [new if one == old else one for one in leader]
    groups = [[t for t in range(tasks) if leader[t] == one] for one in dict.fromkeys(leader)]
    members = np.full((len(groups), 1 + max(map(len, groups))), NOBODY, np.int32)
    group = np.zeros(tasks, np.int32)
    for number, found in enumerate(groups):
        members[number, : len(found)], group[found] = found, number
    by_task = np.ones(tasks) if task_weight is None else np.asarray(task_weight, np.float64)
    return Links(group, members, gap, weights, by_task)
