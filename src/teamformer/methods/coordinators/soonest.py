"""The rule without search: the task that can begin soonest, by those who are there first.

Every robot works it out alike from what everybody knows, as with a shared plan. It needs no network
and no search, so it is a bar for both.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from teamformer.base.array_types import Array
from teamformer.mission.coordination import NEWS, Known, Plan
from teamformer.planning.problem.coalition_plan import plan_of_lists
from teamformer.planning.problem.relaxed_problem import Relaxed
from teamformer.planning.steps.situation import Situation, plan_of, situation_of
from teamformer.world.rules.constants import FAR


class Soonest:
    """Next comes the task that can begin soonest, by whoever is there first; nothing is searched.

    It is asked whenever something is done, too, as it does not foresee how long forming takes.
    """

    heeds = NEWS
    times = ("steps",)

    def update(self, known: Known, plan: Plan | None) -> Plan:
        """Return who does each task that is possible now, in the order in which they can begin."""
        if not known.possible_tasks:
            return Plan(made_from="nothing")
        situation = situation_of(replace(known, open_tasks=known.possible_tasks))
        order, coalitions = _in_turn(situation)
        return replace(plan_of(situation, plan_of_lists(order, coalitions)), made_from="soonest")


def _in_turn(situation: Situation) -> tuple[list[int], list[list[int]]]:
    """Return the tasks in the order in which they begin, and the robots of each."""
    problem, robots = situation.problem, np.arange(len(situation.robots))
    tasks = len(problem.needs)
    there = problem.ready + _ways(problem, robots, tasks + robots)  # (tasks, robots)
    opens, coalitions = problem.appears.astype(np.int64), [list[int]() for _ in range(tasks)]
    order, left = list[int](), set(range(tasks))
    while left:
        able = [task for task in sorted(left) if left.isdisjoint(problem.before[task].tolist())]
        begins = np.maximum(_complete_at(problem, there, able), opens[able])
        task = able[int(np.argmin(begins))]
        team = _cover(problem, there[task], task)
        end = int(begins.min()) + int(problem.duration[task])
        end += situation.forming_steps if len(team) > 1 else 0
        there[:, team] = end + _ways(problem, np.array(team), np.full(len(team), task))
        follows = (problem.before == task).any(axis=1)
        opens[follows] = np.maximum(opens[follows], end)
        coalitions[task] = team
        order.append(task)
        left.remove(task)
    return order, coalitions


def _ways(problem: Relaxed, robots: Array, places: Array) -> Array:
    """Return the steps that robots take from a place each to all tasks, as (tasks, robots)."""
    return problem.steps[problem.pace[robots], problem.cells[:, places]].astype(np.int64)


def _complete_at(problem: Relaxed, there: Array, tasks: list[int]) -> Array:
    """Return when all that each of some tasks needs is there, whoever comes first, as (tasks,)."""
    order = np.argsort(there[tasks], axis=1, kind="stable")  # (tasks, robots)
    brought = np.cumsum(problem.counts[order], axis=1)  # (tasks, robots, caps)
    is_enough = np.asarray((brought >= problem.needs[tasks][:, None, :]).all(axis=2))
    last = np.argmax(is_enough, axis=1)
    times = np.take_along_axis(there[tasks], order, axis=1)[np.arange(len(tasks)), last]
    return np.where(is_enough.any(axis=1), times, FAR)


def _cover(problem: Relaxed, there: Array, task: int) -> list[int]:
    """Return the robots that are there first and have what a task needs, none of them spare."""
    team, needs = list[int](), problem.needs[task]
    brought = np.zeros_like(needs)
    for robot in np.argsort(there, kind="stable").tolist():
        if ((problem.counts[robot] > 0) & (brought < needs)).any():
            team.append(robot)
            brought = brought + problem.counts[robot]
        if (brought >= needs).all():
            break
    for robot in reversed(team):
        if (brought - problem.counts[robot] >= needs).all():
            team.remove(robot)
            brought = brought - problem.counts[robot]
    return team
