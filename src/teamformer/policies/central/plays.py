"""Plays of plans and rules through the simulator, of which the fastest is the central plan."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass

from teamformer.model import Scenario
from teamformer.planning.relaxation.solve import Solution
from teamformer.policies.central.plan_from_play import CoalitionLog
from teamformer.policies.central.plan_player import PlanPlayer
from teamformer.policies.protocol import Policy
from teamformer.policies.scripted.heuristic import Heuristic
from teamformer.policies.scripted.joining import JoinAll
from teamformer.rules.constants import NOBODY
from teamformer.sim.arrays import NEVER, Array
from teamformer.sim.env import TeamFormation

Script = list[dict[int, tuple[Array, int]]]
"""For each step and slot, the counts wanted and the task named."""

Curve = tuple[tuple[float, int], ...]

SIMPLE_RULES: tuple[tuple[str, Policy], ...] = (("join-all", JoinAll()), ("heuristic", Heuristic()))
"""Rules that the plan must not be slower than."""

SIMPLE = 0.15
"""Share of the time that the play of a simple rule may take."""

MARGIN = 0.1
"""Seconds kept back at the end, besides what the last plays take."""


@dataclass(frozen=True)
class CentralPlan:
    """What the planner found for a scenario.

    `solution` is the relaxed schedule, in which joining is free; no policy is faster than `bound`.
    `makespan` is what the plan takes under the step rules, None if it does not end. `played_by`
    says where the plan comes from: `search` (with forming counted), `schedule` (the relaxed one),
    `plan` (the shared one) or a simple rule. `curve` holds each improvement as (seconds,
    makespan). `is_first` says that there was no time to improve the first plan.
    """

    solution: Solution
    bound: int
    makespan: int | None
    played_by: str
    script: Script
    curve: Curve = ()
    is_first: bool = False


class Plays:
    """What has been played of one scenario, and the time that is left."""

    def __init__(self, scenario: Scenario, begun: float, time_limit: float) -> None:
        self.begun = begun
        self.makespan: int | None = None
        self.limit = time_limit
        self._scenario = scenario
        self._played_by, self._script = "", Script()
        self._curve: list[tuple[float, int]] = []
        self._longest = 0.0  # seconds that a play took

    @property
    def seconds(self) -> float:
        """Return the seconds since planning began."""
        return time.perf_counter() - self.begun

    @property
    def seconds_left(self) -> float:
        """Return the seconds until it is time for the last plays."""
        return max(0.0, self.limit - self.seconds - MARGIN - 1.5 * self._longest)

    def add_simple_rules(self) -> None:
        """Play the rules that the plan must not be slower than."""
        for name, rule in SIMPLE_RULES:
            self.add(name, rule, most_seconds=SIMPLE * max(1.0, self.limit))

    def add(
        self,
        name: str,
        player: PlanPlayer | Policy,
        most_seconds: float = math.inf,
        log: CoalitionLog | None = None,
    ) -> None:
        """Play a plan or a policy, and keep its decisions if it is the fastest so far.

        What is done is noted in `log`.

        Once there is a play to show, others end early: when they are no faster, when time is up,
        or after `most_seconds`.
        """
        env = TeamFormation([self._scenario])
        env.view()  # the shared plan is made here
        begun = self.seconds
        end = begun + most_seconds if self.limit == 0 else min(begun + most_seconds, self.limit)
        most = NEVER if self.makespan is None else self.makespan
        script: Script = []
        while env.is_running[0] and len(script) < most:
            if self.makespan is not None and self.seconds > end:
                return
            script.append(_step(env, player))
            if log is not None:
                log.note(env)
        tally = env.tally()
        if tally.status == "completed" and tally.steps < most:
            self.makespan, self._played_by, self._script = tally.steps, name, script
            self._curve.append((self.seconds, tally.steps))
        elif self.makespan is None:
            self._played_by, self._script = name, script
        self._longest = max(self._longest, self.seconds - begun)

    def report(
        self,
        solution: Solution,
        bound: int,
        searched: list[tuple[float, int]],
        is_first: bool = False,
    ) -> CentralPlan:
        """Return the best play; what the search expected in between is in its curve."""
        script = [line for line in self._script if line]  # nobody decides while nobody is left
        curve: list[tuple[float, int]] = []
        for seconds, steps in sorted(self._curve + searched):
            is_better = not curve or steps < curve[-1][1]
            if is_better and self.makespan is not None and steps >= self.makespan:
                curve.append((round(seconds, 3), steps))
        return CentralPlan(
            solution, bound, self.makespan, self._played_by, script, tuple(curve), is_first
        )


def _step(env: TeamFormation, player: PlanPlayer | Policy) -> dict[int, tuple[Array, int]]:
    """Let a player make a step; return what it decided."""
    view = env.view()
    decision = player.decide_in(env) if isinstance(player, PlanPlayer) else player.decide(view)
    named = [NOBODY] * len(view.slot) if decision.task is None else decision.task.tolist()
    slots = view.slot.tolist()
    made = {s: (decision.wanted[row].copy(), named[row]) for row, s in enumerate(slots)}
    env.step(decision)
    return made
