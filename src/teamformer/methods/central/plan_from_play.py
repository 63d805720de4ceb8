"""Makes a plan of what a policy did: who did each task, in the order in which they were done."""

from __future__ import annotations

import math
import time

import numpy as np

from teamformer.methods.central.players import Player, decision_of, stage_for
from teamformer.mission.model import Mission
from teamformer.planning.problem.coalition_plan import CoalitionPlan, plan_of_lists
from teamformer.world.env import TeamFormation
from teamformer.world.rules.constants import NOBODY


class CoalitionLog:
    """Who has done which task in a play, in the order in which they were done."""

    def __init__(self, mission: Mission) -> None:
        self._order: list[int] = []
        self._may_lack = [task.optional for task in mission.tasks]
        self._coalitions: list[list[int]] = [[] for _ in mission.tasks]

    def note(self, env: TeamFormation) -> None:
        """Write down what is done since: every robot of the team that did it took part."""
        tasks = env.worlds.tasks[0][: len(self._coalitions)]
        team_of = env.worlds.robots["team"][0]
        for task in np.flatnonzero(tasks["done_at"] != NOBODY).tolist():
            if not self._coalitions[task]:
                self._order.append(task)
                self._coalitions[task] = np.flatnonzero(team_of == tasks[task]["done_by"]).tolist()

    def plan(self) -> CoalitionPlan | None:
        """Return what was done as a plan; None if not everything was that must be."""
        left = [task for task, robots in enumerate(self._coalitions) if not robots]
        if not all(self._may_lack[task] for task in left):
            return None
        return plan_of_lists([*self._order, *left], self._coalitions)


def plan_from_play(
    mission: Mission, player: Player, deadline: float = math.inf
) -> CoalitionPlan | None:
    """Return the plan of a player's play; None if that does not complete, or not in time.

    `deadline` is what `time.perf_counter` then shows.
    """
    env, log = stage_for(player, mission, mission), CoalitionLog(mission)
    while env.is_running[0] and time.perf_counter() < deadline:
        env.step(decision_of(player, env, env.view()))
        log.note(env)
    return log.plan()
