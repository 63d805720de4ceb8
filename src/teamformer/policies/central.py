"""The central planner: knows everything, plans first, and then plays its plan."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from teamformer.model import Scenario
from teamformer.planning.optimal import Solution, solve
from teamformer.policies.plan_player import PlanPlayer
from teamformer.policies.scripted import JoinAll
from teamformer.sim.arrays import NEVER, NOBODY, Array
from teamformer.sim.env import Decision, TeamFormation
from teamformer.sim.view import View

Script = list[dict[int, tuple[Array, int]]]
"""For each step and slot, the counts wanted and the task named."""


@dataclass(frozen=True)
class CentralPlan:
    """What the planner found for a scenario.

    `solution` is the relaxed schedule, in which joining is free. `makespan` is what its play under
    the step rules takes, None if it does not end; `played_by` says whose play is the fastest: the
    schedule's, or that of a simple rule where forming costs the schedule more than it gains.
    """

    solution: Solution
    makespan: int | None
    played_by: str
    script: Script


class Central:
    """Plans with OR-Tools for up to `time_limit` seconds a scenario, then plays what it found.

    The relaxed schedule is played through the simulator beforehand, as is joining all on the way;
    the faster play becomes the script that `decide` reads out.
    """

    needs_everything = True

    def __init__(self, time_limit: float = 10.0, workers: int = 2) -> None:
        self.time_limit = time_limit
        self.workers = workers
        self.plans: list[CentralPlan] = []

    def begin(self, everything: Sequence[Scenario] | None, rng: np.random.Generator) -> None:
        """Plan every scenario."""
        if everything is None:
            raise ValueError("the central planner has to be given the scenarios")
        seed = int(rng.integers(2**31))
        self.plans = [self._plan(scenario, seed) for scenario in everything]
        self._steps = np.zeros(len(self.plans), dtype=np.int64)

    def decide(self, view: View) -> Decision:
        """Read the next line of each world's script."""
        wanted = view.counts.copy()
        named = np.full(len(wanted), NOBODY, dtype=np.int32)
        for row, (w, slot) in enumerate(zip(view.world.tolist(), view.slot.tolist(), strict=True)):
            script = self.plans[w].script
            if self._steps[w] < len(script):
                counts, named[row] = script[self._steps[w]][slot]
                wanted[row, : len(counts)] = counts  # others in the batch may know more
        self._steps[np.unique(view.world)] += 1
        return Decision(wanted, named)

    def _plan(self, scenario: Scenario, seed: int) -> CentralPlan:
        solution = solve(scenario, self.time_limit, seed=seed, workers=self.workers)
        plays = {"join-all": _play(scenario, JoinAll())}
        if solution.schedule is not None:
            player = PlanPlayer(scenario, solution.schedule.routes)
            plays["schedule"] = _play(scenario, player)
        best = min(plays, key=lambda name: plays[name][0] or NEVER)
        makespan, script = plays[best]
        return CentralPlan(solution, makespan, best, script)


def _play(scenario: Scenario, player: PlanPlayer | JoinAll) -> tuple[int | None, Script]:
    """Return the makespan of a play, None if it does not complete, and its decisions."""
    env = TeamFormation([scenario])
    script: Script = []
    while env.is_running[0]:
        view = env.view()
        decision = player.decide_in(env) if isinstance(player, PlanPlayer) else player.decide(view)
        named = [NOBODY] * len(view.slot) if decision.task is None else decision.task.tolist()
        slots = view.slot.tolist()
        script.append({s: (decision.wanted[row].copy(), named[row]) for row, s in enumerate(slots)})
        env.step(decision)
    tally = env.tally()
    return (tally.steps if tally.status == "completed" else None), script
