"""Makes a plan of what a policy did: who did each task, in the order in which they were done."""

from __future__ import annotations

import math
import time

import numpy as np

from teamformer.model import Scenario
from teamformer.planning.relaxation.problem import Relaxed
from teamformer.planning.teams.plan import TeamPlan, plan_teams
from teamformer.policies.protocol import Policy
from teamformer.sim.arrays import NOBODY
from teamformer.sim.env import TeamFormation


def plan_from_play(
    scenario: Scenario, problem: Relaxed, policy: Policy, deadline: float = math.inf
) -> TeamPlan | None:
    """Return the plan of a policy's play; None if that does not complete, or not in time.

    Every robot of the team that does a task is in its crew. `problem` is the scenario's;
    `deadline` is what `time.perf_counter` then shows.
    """
    env = TeamFormation([scenario])
    order: list[int] = []
    crews: list[list[int]] = [[] for _ in scenario.tasks]
    while env.is_running[0] and time.perf_counter() < deadline:
        env.step(policy.decide(env.view()))
        done = env.worlds.tasks[0]["done_at"][: len(crews)] != NOBODY
        for task in np.flatnonzero(done).tolist():
            if not crews[task]:
                order.append(task)
                crews[task] = _who_did(env, problem, task)
    return plan_teams(problem, order, crews) if all(crews) else None


def _who_did(env: TeamFormation, problem: Relaxed, task: int) -> list[int]:
    """Return the robots of the team that stands at a task and can do it; none if nobody does."""
    place, teams = env.worlds.tasks[0][task], env.worlds.teams[0]
    is_there = (teams["size"] > 0) & (teams["x"] == place["x"]) & (teams["y"] == place["y"])
    for slot in np.flatnonzero(is_there).tolist():
        robots = np.flatnonzero(env.worlds.robots["team"][0] == slot)
        if (problem.counts[robots].sum(axis=0) >= problem.needs[task]).all():
            return [int(robot) for robot in robots]
    return []
