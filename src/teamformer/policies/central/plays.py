"""Plays of plans and rules through the simulator, of which the fastest is the central plan."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from functools import cache

import numpy as np

from teamformer.model import Scenario
from teamformer.planning.relaxation.solve import Solution
from teamformer.policies.central.plan_from_play import CoalitionLog
from teamformer.policies.central.plan_player import PlanPlayer
from teamformer.policies.learned.any_fleet import teamformer_any
from teamformer.policies.protocol import Policy
from teamformer.policies.scripted.heuristic import Heuristic
from teamformer.policies.scripted.joining import JoinAll
from teamformer.rules.constants import NOBODY
from teamformer.sim.arrays import NEVER, Array
from teamformer.sim.env import TeamFormation

Script = list[dict[int, tuple[Array, int]]]
"""For each step and slot, the counts wanted and the task named."""

Curve = tuple[tuple[float, int], ...]

DEFAULT = "teamformer"
"""The name of the default policy."""

SIMPLE_RULES: tuple[tuple[str, Policy], ...] = (("join-all", JoinAll()), ("heuristic", Heuristic()))
"""Rules that the plan must not be slower than."""

SIMPLE = 0.15
"""Share of the time that the play of a simple rule may take."""

DEFAULT_SECONDS = 5.0
"""What the play of the default policy may take, however little time is left.

That is far more than it takes in small missions, where so much is uncertain that every step makes
another plan.
"""

MARGIN = 0.1
"""Seconds kept back at the end, besides what the last plays take."""


@dataclass(frozen=True)
class CentralPlan:
    """What the planner found for a scenario.

    `solution` is the relaxed schedule, in which joining is free; no policy is faster than `bound`.
    `makespan` is what the plan takes under the step rules, None if it does not end. `played_by`
    says where the plan comes from: `search` (with forming counted), `schedule` (the relaxed one),
    `plan` (the shared one), `teamformer` (the default policy) or a simple rule. `curve` holds each
    improvement as (seconds, makespan). `is_first` says that there was no time to improve the first
    plan. With `is_as_seen` the script is for the mission as the robots see it, who do not know all.
    """

    solution: Solution
    bound: int
    makespan: int | None
    played_by: str
    script: Script
    curve: Curve = ()
    is_first: bool = False
    is_as_seen: bool = False


class Plays:
    """What has been played of one scenario, and the time that is left.

    `seen` is what the robots see of it; the scenario itself where nothing is uncertain.
    """

    def __init__(self, scenario: Scenario, seen: Scenario, begun: float, time_limit: float) -> None:
        self.begun = begun
        self.makespan: int | None = None
        self.limit = time_limit
        self._scenario, self._seen = scenario, seen
        self._played_by, self._script, self._is_as_seen = "", Script(), False
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
        """Play the simple rules that the plan must not be slower than."""
        for name, rule in SIMPLE_RULES:
            until = self.seconds + SIMPLE * max(1.0, self.limit)
            self.add(name, rule, until=min(until, self._end))

    def add_default(self, is_shared_plan_played: bool) -> None:
        """Play what the default policy does, which the plan must not be slower than either.

        What it does with the beliefs of the robots may be better than what it does when it knows
        all.
        """
        until = max(self.limit, self.seconds + DEFAULT_SECONDS)
        if not is_shared_plan_played:
            self.add(DEFAULT, default_policy(), until=until)
        if self._seen.has_surprises:
            self.add(DEFAULT, default_policy(), until=until, is_as_seen=True)

    @property
    def _end(self) -> float:
        """Return the second at which time is up; without a limit there is none."""
        return self.limit or math.inf

    def add(
        self,
        name: str,
        player: PlanPlayer | Policy,
        until: float | None = None,
        log: CoalitionLog | None = None,
        is_as_seen: bool = False,
    ) -> None:
        """Play a plan or a policy, and keep its decisions if it is the fastest so far.

        What is done is noted in `log`. With `is_as_seen` nobody knows more than the robots do.

        Once there is a play to show, others end early: when they are no faster, or at the second
        `until`, when time is up if left out.
        """
        played = self._seen if is_as_seen else self._scenario
        env = TeamFormation([played], truths=[self._scenario])
        env.view()  # the shared plan is made here
        if not isinstance(player, PlanPlayer):
            player.begin(None, np.random.default_rng(0))
        begun = self.seconds
        end = self._end if until is None else until
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
            self.makespan = tally.steps
            self._played_by, self._script, self._is_as_seen = name, script, is_as_seen
            self._curve.append((self.seconds, tally.steps))
        elif self.makespan is None:
            self._played_by, self._script, self._is_as_seen = name, script, is_as_seen
        if player is not default_policy():  # which is never played last
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
            solution=solution,
            bound=bound,
            makespan=self.makespan,
            played_by=self._played_by,
            script=script,
            curve=tuple(curve),
            is_first=is_first,
            is_as_seen=self._is_as_seen,
        )


@cache
def default_policy() -> Policy:
    """Return what `run` and all other verbs play unless they are told otherwise."""
    return teamformer_any()


def _step(env: TeamFormation, player: PlanPlayer | Policy) -> dict[int, tuple[Array, int]]:
    """Let a player make a step; return what it decided."""
    view = env.view()
    decision = player.decide_in(env) if isinstance(player, PlanPlayer) else player.decide(view)
    named = [NOBODY] * len(view.slot) if decision.task is None else decision.task.tolist()
    slots = view.slot.tolist()
    made = {s: (decision.wanted[row].copy(), named[row]) for row, s in enumerate(slots)}
    env.step(decision)
    return made
