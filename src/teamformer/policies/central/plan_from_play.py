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
        tasks, team_of = env.worlds.tasks[0][: len(crews)], env.worlds.robots["team"][0]
        for task in np.flatnonzero(tasks["done_at"] != NOBODY).tolist():
            if not crews[task]:
                order.append(task)
                crews[task] = np.flatnonzero(team_of == tasks[task]["done_by"]).tolist()
    return plan_teams(problem, order, crews) if all(crews) else None
