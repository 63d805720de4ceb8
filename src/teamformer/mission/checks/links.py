"""Tasks whose starts are linked: two that are linked directly are done by different robots."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING

from teamformer.base.errors import Problem
from teamformer.mission.parts.capabilities import ONE, Counts, covers, describe, missing, total

if TYPE_CHECKING:
    from teamformer.mission.model import Mission, Task


MOST_TRIES = 20_000
"""So many ways of dealing robots out are looked at; with more it counts as possible."""

Units = tuple[int, ...]
"""Counts of each capability in thousandths."""

Lacks = tuple[Units, ...]
"""What each task lacks yet."""

Brings = tuple[Units, ...]
"""What a robot brings to each task: nothing to one that it is not able for."""


def groups_of(tasks: Sequence[Task]) -> list[list[int]]:
    """Return the tasks whose starts are linked, directly or by others; the others stand alone."""
    number_of = {task.name: number for number, task in enumerate(tasks)}
    leader = list(range(len(tasks)))
    for number, task in enumerate(tasks):
        for name in task.starts:
            one, two = leader[number], leader[number_of[name]]
            leader = [min(one, two) if at in (one, two) else at for at in leader]
    groups: dict[int, list[int]] = {}
    for number, at in enumerate(leader):
        groups.setdefault(at, []).append(number)
    return list(groups.values())


def linked_with(tasks: Sequence[Task]) -> list[set[int]]:
    """Return the tasks whose starts are linked with that of each directly: others do them."""
    number_of = {task.name: number for number, task in enumerate(tasks)}
    linked: list[set[int]] = [set() for _ in tasks]
    for number, task in enumerate(tasks):
        for name in task.starts:
            linked[number].add(number_of[name])
            linked[number_of[name]].add(number)
    return linked


def find_link_problems(mission: Mission) -> Iterator[Problem]:
    """Return what is wrong with linked starts."""
    problems = [*problems_of_names(mission), *_problems_of_gaps(mission)]
    yield from problems
    if not problems:
        yield from _problems_of_groups(mission)


def find_links(mission: Mission) -> Iterator[Problem]:
    """Return where a mission has linked starts."""
    for number, task in enumerate(mission.tasks):
        if task.starts:
            what = f"task '{task.name}' has starts, which are for continuous time"
            yield Problem(("tasks", number, "starts"), what)


def problems_of_names(mission: Mission) -> Iterator[Problem]:
    """Return which tasks starts are linked with that are none, or themselves."""
    names = {task.name for task in mission.tasks}
    for number, task in enumerate(mission.tasks):
        for name in task.starts:
            where = ("tasks", number, "starts", name)
            if name not in names:
                message = f"the start of task '{task.name}' is linked with '{name}', which is no"
                yield Problem(where, f"{message} task; name one")
            elif name == task.name:
                yield Problem(where, f"task '{name}' is linked with itself; name another")


def _problems_of_gaps(mission: Mission) -> Iterator[Problem]:
    for number, task in enumerate(mission.tasks):
        for name, (least, most) in task.starts.items():
            if not 0 <= least <= most <= 1e9:
                message = f"task '{task.name}' starts {least:g} to {most:g} after '{name}'"
                remedy = "use [least, most], 0 or more and in this order"
                yield Problem(("tasks", number, "starts", name), f"{message}; {remedy}")


def _problems_of_groups(mission: Mission) -> Iterator[Problem]:
    """Return what linked tasks cannot keep together."""
    tasks = mission.tasks
    groups = [group for group in groups_of(tasks) if len(group) > 1]
    group_of = {number: at for at, group in enumerate(groups) for number in group}
    number_of = {task.name: number for number, task in enumerate(tasks)}
    for group in groups:
        listed = ", ".join(f"'{tasks[number].name}'" for number in group)
        where = ("tasks", group[-1], "starts")
        if _is_contradictory([tasks[number] for number in group]):
            yield Problem(where, f"the gaps between the starts of {listed} contradict one another")
        for apart in all_apart(tasks, group):
            yield from _problems_of_robots(mission, apart)
    for number, task in enumerate(tasks):
        for name in task.after:
            other = number_of.get(name, number)
            if number in group_of and group_of.get(other) == group_of[number]:
                message = f"task '{task.name}' is after '{name}', with which its start is linked"
                yield Problem(
                    ("tasks", number, "after"), f"{message}; drop after, the link says it"
                )
                return
    if groups:
        yield from _problems_of_waiting(mission, groups)


def all_apart(tasks: Sequence[Task], group: Sequence[int]) -> list[list[int]]:
    """Return sets of tasks of a group of which each is linked with each other one directly.

    Each task is in the one that it begins, or in one with all of these.
    """
    found: list[set[int]] = []
    linked = linked_with(tasks)
    for first in group:
        apart = {first}
        for other in group:
            if apart <= linked[other]:
                apart.add(other)
        if not any(apart <= known for known in found):
            found.append(apart)
    return [sorted(apart) for apart in found]


def _problems_of_robots(mission: Mission, apart: Sequence[int]) -> Iterator[Problem]:
    """Return why there are too few robots for tasks that are done by different ones."""
    tasks = mission.tasks
    where = ("tasks", max(number for number in apart if tasks[number].starts), "starts")
    listed = ", ".join(f"'{tasks[number].name}'" for number in apart)
    if len(apart) > len(mission.robots):
        message = f"{listed} are done by different robots, of which there are"
        yield Problem(where, f"{message} {len(mission.robots)}; add some or drop a link")
    needs = total(tasks[number].worst_needs for number in apart)
    have = total(robot.can for robot in mission.robots)
    if not covers(have, needs):
        short = describe(missing(have, needs))
        message = f"{listed} are done by different robots, and all together lack {short}"
        yield Problem(where, f"{message}; add robots or drop a link")
    elif not can_be_apart(
        [tasks[number].worst_needs for number in apart], [robot.can for robot in mission.robots]
    ):
        message = f"{listed} are done by different robots, and some robot is needed by two of them"
        yield Problem(where, f"{message}; add robots or drop a link")


def _is_contradictory(tasks: Sequence[Task]) -> bool:
    """Say whether no starts keep all gaps: the longest ways between starts go round in a gain."""
    longest = longest_gaps(tasks)
    return any(longest[task.name, task.name] > 0 for task in tasks)


def longest_gaps(tasks: Sequence[Task]) -> dict[tuple[str, str], float]:
    """Return how long after each of some linked tasks another one starts at least, by names.

    That follows from all their gaps; less than 0 for how long before at most, -inf if nothing does.
    """
    longest = {(one.name, two.name): -math.inf for one in tasks for two in tasks}
    for task in tasks:
        for name, (least, most) in task.starts.items():
            longest[name, task.name] = max(longest[name, task.name], least)
            longest[task.name, name] = max(longest[task.name, name], -most)
    for by in tasks:
        for one in tasks:
            for two in tasks:
                detour = longest[one.name, by.name] + longest[by.name, two.name]
                longest[one.name, two.name] = max(longest[one.name, two.name], detour)
    return longest


def _problems_of_waiting(mission: Mission, groups: Sequence[Sequence[int]]) -> Iterator[Problem]:
    """Refuse groups that wait for one another, which is a circle that single tasks need not see."""
    tasks = mission.tasks
    leader = {tasks[number].name: tasks[group[0]].name for group in groups for number in group}
    before: dict[str, set[str]] = {}
    for task in tasks:
        waits_for = before.setdefault(leader.get(task.name, task.name), set())
        waits_for |= {leader.get(name, name) for name in task.after}
    while before:
        is_ready = {name for name, others in before.items() if not others & before.keys()}
        if not is_ready:
            listed = ", ".join(f"'{name}'" for name in sorted(before))
            message = (
                f"{listed}, or tasks whose starts are linked with theirs, wait for one another"
            )
            yield Problem(("tasks",), f"{message}; drop an after or a link")
            return
        before = {name: others for name, others in before.items() if name not in is_ready}


def can_be_apart(
    needs: Sequence[Counts],
    robots: Sequence[Counts],
    is_able: Callable[[int, int], bool] = lambda robot, need: True,
) -> bool:
    """Say whether robots can be dealt out to tasks so that each task gets what it needs.

    `is_able` says whether a robot can do a task, by their numbers here.
    """
    caps = sorted({cap for need in needs for cap in need})
    lacks = tuple(_units(need, caps) for need in needs)
    own = (
        tuple(_units(can if is_able(robot, task) else {}, caps) for task in range(len(needs)))
        for robot, can in enumerate(robots)
    )
    brings = sorted(own, key=_versatility)
    tried: set[tuple[int, Lacks]] = set()
    open_ways = [(0, lacks)]
    while open_ways:
        way = open_ways.pop()
        dealt, lacks = way
        if not any(map(any, lacks)):
            return True
        if way in tried or not _is_enough(lacks, brings[dealt:]):
            continue
        tried.add(way)
        if len(tried) > MOST_TRIES:
            return True
        open_ways += [(dealt + 1, left) for left in _with_one_more(lacks, brings[dealt])]
    return False


def _units(counts: Counts, caps: Sequence[str]) -> Units:
    return tuple(round(counts.get(cap, 0) * ONE) for cap in caps)


def _versatility(brings: Brings) -> tuple[int, Brings]:
    """Return by what robots are dealt out: who can do one thing first, alike ones together."""
    return sum(count > 0 for count in _most(brings)), brings


def _most(brings: Brings) -> Units:
    """Return what a robot brings to the task that it brings most to."""
    return tuple(map(max, zip(*brings, strict=True)))


def _is_enough(lacks: Lacks, brings: Sequence[Brings]) -> bool:
    """Say whether robots bring what all tasks lack together."""
    have = map(sum, zip(*map(_most, brings), strict=True)) if brings else [0] * len(lacks[0])
    return all(there >= sum(lack) for there, *lack in zip(have, *lacks, strict=True))


def _with_one_more(lacks: Lacks, brings: Brings) -> Iterator[Lacks]:
    """Yield what is lacking when a robot does one of the tasks that it can help with, or none."""
    helped = [
        tuple(max(0, count - there) for count, there in zip(lack, own, strict=True))
        for lack, own in zip(lacks, brings, strict=True)
    ]
    are_helped = [left != lack for left, lack in zip(helped, lacks, strict=True)]
    if not any(are_helped):
        yield lacks
    for number, is_helped in enumerate(are_helped):
        if is_helped:
            yield (*lacks[:number], helped[number], *lacks[number + 1 :])
