"""Tours of like robots through tasks with time windows: are there enough, and what do they allow.

Held and Karp's recurrence (1962) over sets of tasks, forwards for when a tour can be at its last
task and backwards for when it must be at its first. A set that a tour can do leaves the others to
the other robots; only such sets count when the windows of its tasks are narrowed. A tour of the
only robot with a capability also says which other tasks it can come by.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from teamformer.base.array_types import Ints
from teamformer.base.kernels.jit import entry, kernel
from teamformer.planning.problem.coalition_problem import NEVER

MANY = 127
"""Tours of a set that no number of robots can do."""


class SetTables(NamedTuple):
    """Room for what is known of each set of tasks, as bits."""

    early: Ints  # (sets, tasks) earliest start of the last task of a tour through a set
    late: Ints  # (sets, tasks) latest start of its first task
    tours: npt.NDArray[np.int8]  # (sets,) the least number of tours through a set


def empty_tables(tasks: int) -> SetTables:
    """Return room for sets of so many tasks."""
    sets = 1 << tasks
    return SetTables(
        np.zeros((sets, tasks), np.int64),
        np.zeros((sets, tasks), np.int64),
        np.zeros(sets, np.int8),
    )


@entry
def narrow_starts(
    between: Ints,
    duration: Ints,
    first: Ints,
    last: Ints,
    robots: int,
    tables: SetTables,
) -> bool:
    """Narrow the times between which tasks start, `first` and `last`; False if nothing is left.

    `between` (tasks, tasks) must obey the triangle inequality. Each task is in the tour of one of
    so many robots, which may be anywhere before its first task and after its last.
    """
    tasks = len(duration)
    sets = 1 << tasks
    tables.tours[0] = 0
    for some in range(1, sets):
        _tour_through(between, duration, first, last, tables, some)
    for some in range(1, sets):
        if tables.tours[some] != 1:
            tables.tours[some] = _fewest_tours(tables.tours, some)
    if tables.tours[sets - 1] > robots:
        return False
    least, most = np.full(tasks, NEVER), np.full(tasks, -NEVER)
    for some in range(1, sets):
        if tables.tours[some] == 1 and tables.tours[sets - 1 - some] < robots:
            for task in range(tasks):
                is_open = least[task] > first[task] or most[task] < last[task]
                if some >> task & 1 and is_open:
                    _widen(tables, some, task, least, most)
    for task in range(tasks):
        if least[task] > most[task]:
            return False
        first[task], last[task] = least[task], most[task]
    return True


@entry
def fit_in(
    duration: Ints,
    ways: Ints,
    others: Ints,
    tables: SetTables,
    before: npt.NDArray[np.bool_],
    after: npt.NDArray[np.bool_],
) -> None:
    """Say which tasks fit into a tour before each of its own, (others, visited), and after.

    `ways` (visited, others) are those to them; `others` (4, others) tells of each when the robot
    can be there first, between which times it starts, and how long it takes.
    """
    early, late, tours = tables
    visited, sets = len(duration), 1 << len(duration)
    for done in range(sets):
        left = sets - 1 - done
        if (done != 0 and tours[done] != 1) or (left != 0 and tours[left] != 1):
            continue
        for other in range(ways.shape[1]):
            begin, first, last, stay = others[:, other]
            soonest, leave = (begin if done == 0 else NEVER), (NEVER if left == 0 else -NEVER)
            for task in range(visited):
                if left >> task & 1:
                    leave = max(leave, late[left, task] - ways[task, other])
                elif early[done, task] < NEVER:
                    there = early[done, task] + duration[task] + ways[task, other]
                    soonest = min(soonest, there)
            soonest = max(soonest, first)
            if soonest > last or soonest + stay > leave:
                continue
            for task in range(visited):
                if left >> task & 1:
                    before[other, task] = True
                else:
                    after[other, task] = True


@kernel
def _tour_through(
    between: Ints,
    duration: Ints,
    first: Ints,
    last: Ints,
    tables: SetTables,
    some: int,
) -> None:
    """Work out whether one tour can do a set of tasks, and when it ends and begins."""
    tables.tours[some] = MANY
    smallest = some & -some
    if some != smallest and tables.tours[some ^ smallest] != 1:
        return  # what is too much for a tour without this task is too much with it
    for task in range(len(duration)):
        if not some >> task & 1:
            continue
        rest = some ^ (1 << task)
        begin, finish = first[task], last[task]
        if rest != 0:
            begin, finish = _go_on(between, duration, tables, rest, task)
            begin, finish = max(begin, first[task]), min(finish, last[task])
        tables.early[some, task] = begin if begin <= last[task] else NEVER
        tables.late[some, task] = finish if finish >= first[task] else -NEVER
        if begin <= last[task]:
            tables.tours[some] = 1


@kernel
def _go_on(
    between: Ints, duration: Ints, tables: SetTables, rest: int, task: int
) -> tuple[int, int]:
    """Return when a task can start after a tour through the rest, and must start before one."""
    begin, finish = NEVER, -NEVER
    if tables.tours[rest] != 1:
        return begin, finish
    for other in range(len(duration)):
        if rest >> other & 1:
            if tables.early[rest, other] < NEVER:
                there = tables.early[rest, other] + duration[other] + between[other, task]
                begin = min(begin, there)
            if tables.late[rest, other] > -NEVER:
                leave = tables.late[rest, other] - between[task, other] - duration[task]
                finish = max(finish, leave)
    return begin, finish


@kernel
def _fewest_tours(tours, some):  # type: ignore[no-untyped-def]
    """Return how many tours a set takes that is too much for one."""
    smallest = some & -some
    rest = some ^ smallest
    part, fewest = rest, MANY
    while True:  # every tour through the first task of the set
        if tours[part | smallest] == 1 and tours[rest ^ part] + 1 < fewest:
            fewest = tours[rest ^ part] + 1
        if part == 0 or fewest == 2:
            return fewest
        part = (part - 1) & rest


@kernel
def _widen(tables, some, task, least, most):  # type: ignore[no-untyped-def]
    """Let a task start whenever a tour through a set of tasks allows."""
    bit = 1 << task
    rest = some ^ bit
    part = rest
    while True:  # part of the rest comes before the task, part after it
        begin, finish = tables.early[part | bit, task], tables.late[(rest ^ part) | bit, task]
        if begin <= finish:
            least[task], most[task] = min(least[task], begin), max(most[task], finish)
        if part == 0:
            return
        part = (part - 1) & rest
