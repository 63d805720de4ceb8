"""The moment in which a shared plan has just been made: what it says about robots and tasks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from teamformer.model import Scenario
from teamformer.planning.teams.facts import Facts, SharedPlan, Situation, situation_of
from teamformer.planning.teams.shared_plan import ends_of
from teamformer.sim.env import TeamFormation


class Moment(NamedTuple):
    """A plan, the present that it is made for, and what follows if nothing happens."""

    mission: Scenario  # as its file has it
    believed: Scenario
    facts: Facts
    plan: SharedPlan  # without `ends`
    situation: Situation
    ends: Mapping[int, int]  # by task
    spare: Mapping[int, int]  # how much later each task could end for the same makespan
    unseen: frozenset[int]  # tasks of which nobody knows the place, or the needs

    @property
    def makespan(self) -> int:
        """Return the step in which the last task is done."""
        return max(self.ends.values())

    def begin_of(self, task: int) -> int:
        """Return the step in which the service of a task begins."""
        return self.ends[task] - int(self.believed.tasks[task].duration)

    def tasks_of(self, robot: int) -> list[int]:
        """Return a robot's tasks in the order of the plan."""
        pairs = zip(self.plan.order, self.plan.coalitions, strict=True)
        return [task for task, robots in pairs if robot in robots]

    def way(self, robot: int, task: int, after: int | None = None) -> int:
        """Return the steps to a task from another, or from where the robot is; FAR if no way."""
        problem, index = self.situation.problem, self.situation.robots.index(robot)
        place = self.situation.tasks.index
        start = len(self.situation.tasks) + index if after is None else place(after)
        return int(problem.steps[problem.pace[index], problem.cells[place(task), start]])

    def free_at(self, robot: int) -> int:
        """Return the step from which a robot is free."""
        return max(self.facts.step, self.facts.free_at[robot])


def moment_in(env: TeamFormation, mission: Scenario) -> Moment | None:
    """Return the present of an environment's only world; None if there is no whole plan."""
    believed, facts, plan = env.plan_now()
    pairs = zip(plan.order, plan.coalitions, strict=True)
    rows = [(task, robots) for task, robots in pairs if task in facts.open_tasks]
    if not rows or not all(robots for _, robots in rows):
        return None
    order, coalitions = zip(*rows, strict=True)
    plan = replace(plan, order=order, coalitions=coalitions)
    situation = situation_of(believed, replace(facts, open_tasks=order))
    tasks = env.worlds.tasks[0]
    unseen = np.flatnonzero(tasks["hides_needs"] | tasks["hides_place"]).tolist()
    ends = ends_of(situation, plan)
    moment = Moment(mission, believed, facts, plan, situation, ends, {}, frozenset(unseen))
    return moment._replace(spare=_spare(moment))


def _spare(moment: Moment) -> dict[int, int]:
    """Return by how many steps tasks can end later: the slack of the critical path method.

    That robots meet and part is left out.
    """
    spare: dict[int, int] = {}
    following: dict[int, int] = {}
    pairs = list(zip(moment.plan.order, moment.plan.coalitions, strict=True))
    for task, robots in reversed(pairs):
        spare[task] = moment.makespan - moment.ends[task]
        for robot in robots:
            after = following.get(robot)
            if after is not None:
                arrives = moment.ends[task] + moment.way(robot, after, task)
                waits = max(0, moment.begin_of(after) - arrives)
                spare[task] = min(spare[task], waits + spare[after])
            following[robot] = task
    return spare
