"""Ways to coordinate robots, by name, and a coordinator that plans anything that can be done."""

from __future__ import annotations

import numpy as np

from teamformer.methods.by_name import Method
from teamformer.methods.coordinators.crews import Crews
from teamformer.methods.coordinators.shared_plan import SharedPlan
from teamformer.methods.scripted.join_fitting import JoinFitting
from teamformer.mission.coordination import Coordinator, Known, Plan
from teamformer.mission.parts.capabilities import covers, total
from teamformer.mission.parts.reach import can_reach
from teamformer.world.env import TeamFormation

COORDINATIONS = ("paper", "crews", "plan")


def coordinator(name: str) -> Coordinator | None:
    """Return the coordinator of a name; none for the paper's order and allocator."""
    return {"paper": None, "crews": Crews(), "plan": SharedPlan()}[name]


def method_of(name: str, foresight: str = "scouting") -> Method:
    """Return a method by which tasks are told in this way; by the paper's, `join-fitting`."""
    if name == "paper":
        return Method("join-fitting", policy=JoinFitting(), foresight=foresight)
    found = SharedPlan(scouts=foresight == "scouting") if name == "plan" else coordinator(name)
    return Method(name, coordinator=found, foresight=foresight)


def play_by_plan(env: TeamFormation) -> None:
    """Play coordinated worlds to their end, as their plans want."""
    while env.is_running.any():
        env.step(env.planned_decision(env.view()))


class RandomPlans:
    """Plans anything that robots can do: any order, any able coalitions, scouts anywhere.

    Some optional tasks are left out.
    """

    def __init__(self, seed: int) -> None:
        self._rng = np.random.default_rng(seed)

    def update(self, known: Known, plan: Plan | None) -> Plan:
        """Return a random plan."""
        rng, mission = self._rng, known.mission
        order = [
            int(task)
            for task in rng.permutation(known.possible_tasks)
            if not mission.tasks[task].optional or rng.random() < 0.6
        ]
        coalitions = []
        for task in order:
            at = mission.tasks[task].at
            near = [r for r in known.robots if can_reach(mission.world, mission.robots[r], at)]
            chosen: list[int] = []
            for robot in rng.permutation(near).tolist():
                needs = mission.tasks[task].needs
                if covers(total(mission.robots[r].can for r in chosen), needs) and chosen:
                    break
                chosen.append(robot)
            coalitions.append(tuple(sorted(chosen)))
        unseen = sorted((known.unseen_needs | known.unseen_places) & set(known.open_tasks))
        scouts = [
            (robot, int(rng.choice(unseen)))
            for robot in known.robots
            if unseen and rng.random() < 0.2
        ]
        return Plan(tuple(order), tuple(coalitions), scouts=tuple(scouts))
