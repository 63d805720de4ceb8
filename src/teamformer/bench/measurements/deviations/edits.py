"""Deviations: a plan with one thing changed, and what there is to be said about the change."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from teamformer.bench.measurements.deviations.moments import Moment
from teamformer.capabilities import covers, total
from teamformer.planning.teams.facts import SharedPlan
from teamformer.planning.teams.shared_plan import ends_of
from teamformer.rules.constants import FAR

MOST = 40
"""Steps; longer ones count as so many in features."""


class Deviation(NamedTuple):
    """Another plan, which differs in what some robots do about a task."""

    kind: str
    plan: SharedPlan
    robots: tuple[int, ...]
    task: int


def draw_deviation(moment: Moment, kind: str, rng: np.random.Generator) -> Deviation | None:
    """Return one of a kind of `KINDS`, each as likely as any other; None if there is none."""
    found = list(KINDS[kind](moment))
    return found[rng.integers(len(found))] if found else None


def features_of(moment: Moment, deviation: Deviation) -> tuple[float, ...]:
    """Return what is known about a deviation as numbers around 1, in the order of `FEATURES`."""
    kind, plan, robots, task = deviation
    real, slowest = moment.mission.tasks[task], min(robots, key=_speed_in(moment))
    following = moment.tasks_of(slowest)
    there = moment.free_at(slowest) + moment.way(slowest, task)
    spare_next = moment.spare[following[0]] if following else MOST
    waits = MOST
    if following:
        arrives = moment.free_at(slowest) + moment.way(slowest, following[0])
        waits = moment.begin_of(following[0]) - arrives
    may_need = real.may_need if task in moment.unseen else {}
    open_tasks, left = len(moment.plan.order), moment.makespan - moment.facts.step
    later = max(ends_of(moment.situation, plan).values()) - moment.makespan
    return (
        *(float(kind == other) for other in KINDS),
        _steps(there - moment.facts.step),
        _steps(moment.begin_of(task) - there),
        _steps(waits),
        _steps(spare_next),
        _steps(moment.spare[task]),
        _steps(later),
        float(not following),
        float(sum(may_need.values())),
        float(bool(real.within) and task in moment.unseen),
        float(len(robots)),
        _speed_in(moment)(slowest),
        len(plan.coalitions[plan.order.index(task)]) / 3,
        min(left, 200) / 100,
        len(moment.unseen.intersection(moment.plan.order)) / open_tasks,
        open_tasks / len(moment.situation.robots) / 3,
    )


def _steps(number: int) -> float:
    return min(max(number, -MOST), MOST) / 20


def _speed_in(moment: Moment) -> Callable[[int], float]:
    return lambda robot: moment.mission.robots[robot].speed


def _groups(moment: Moment) -> Iterator[tuple[tuple[int, ...], list[int]]]:
    """Yield robots that are together and have the same tasks next, and those tasks."""
    for team in moment.facts.teams:
        together: dict[int | None, list[int]] = {}
        for robot in team:
            tasks = moment.tasks_of(robot)
            together.setdefault(tasks[0] if tasks else None, []).append(robot)
        for robots in together.values():
            yield tuple(robots), moment.tasks_of(robots[0])


def _look_first(moment: Moment) -> Iterator[Deviation]:
    """A group looks first at a task that nobody has seen, before anybody begins there."""
    for robots, tasks in _groups(moment):
        for task in sorted(moment.unseen.intersection(moment.plan.order)):
            way = max(moment.way(robot, task) for robot in robots)
            is_there = max(map(moment.free_at, robots)) + way <= moment.begin_of(task)
            if way < FAR and is_there and task not in tasks[:1]:
                others = [pair for pair in moment.plan.scouts if pair[0] not in robots]
                scouts = [pair for pair in others if pair[1] != task]
                scouts += [(robot, task) for robot in robots]
                plan = replace(moment.plan, scouts=tuple(sorted(scouts)))
                yield Deviation("look first", plan, robots, task)


def _do_not_look(moment: Moment) -> Iterator[Deviation]:
    """Robots that are to look at a task do not."""
    for task in sorted({task for _, task in moment.plan.scouts}):
        robots = tuple(robot for robot, scouted in moment.plan.scouts if scouted == task)
        scouts = tuple(pair for pair in moment.plan.scouts if pair[1] != task)
        yield Deviation("do not look", replace(moment.plan, scouts=scouts), robots, task)


def _other_first(moment: Moment) -> Iterator[Deviation]:
    """Robots do their next task after the one that follows; so do all that do it with them."""
    order, coalitions = list(moment.plan.order), list(moment.plan.coalitions)
    for robots, tasks in _groups(moment):
        for task, following in pairwise(tasks[:2]):
            begin, end = order.index(task), order.index(following)
            turned = order[:begin] + order[begin + 1 : end + 1] + [task] + order[end + 1 :]
            whom = dict(zip(order, coalitions, strict=True))
            plan = replace(
                moment.plan, order=tuple(turned), coalitions=tuple(whom[task] for task in turned)
            )
            yield Deviation("other task first", plan, robots, task)


def _take_along(moment: Moment) -> Iterator[Deviation]:
    """A robot comes along that has what a task may need, or more of what it needs."""
    for task, team in zip(moment.plan.order, moment.plan.coalitions, strict=True):
        wanted = moment.mission.tasks[task].worst_needs.keys()
        for robot in moment.situation.robots:
            has = moment.mission.robots[robot].can.keys()
            if robot not in team and wanted & has and moment.way(robot, task) < FAR:
                yield _with_team(moment, "take along", task, (*team, robot), robot)


def _leave_out(moment: Moment) -> Iterator[Deviation]:
    """A robot does not come to a task that can be done without it, unless what it may need is."""
    for task, team in zip(moment.plan.order, moment.plan.coalitions, strict=True):
        for robot in team if task in moment.unseen and len(team) > 1 else ():
            others = tuple(other for other in team if other != robot)
            have = total(moment.mission.robots[other].can for other in others)
            if covers(have, moment.mission.tasks[task].needs):
                yield _with_team(moment, "leave out", task, others, robot)


def _with_team(
    moment: Moment, kind: str, task: int, team: tuple[int, ...], robot: int
) -> Deviation:
    coalitions = list(moment.plan.coalitions)
    coalitions[moment.plan.order.index(task)] = tuple(sorted(team))
    return Deviation(kind, replace(moment.plan, coalitions=tuple(coalitions)), (robot,), task)


KINDS: Mapping[str, Callable[[Moment], Iterator[Deviation]]] = {
    "look first": _look_first,
    "do not look": _do_not_look,
    "other task first": _other_first,
    "take along": _take_along,
    "leave out": _leave_out,
}

FEATURES = (
    *KINDS,
    "steps to the task",
    "steps there before the service",
    "steps that it waits at its next task",
    "slack of its next task",
    "slack of the task",
    "steps more by the plan",
    "has nothing to do",
    "needs that there may be",
    "hides its place",
    "robots",
    "speed",
    "coalition",
    "steps left",
    "share of unseen tasks",
    "tasks for each robot",
)
