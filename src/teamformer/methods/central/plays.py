"""Plays of plans and rules through the simulator, of which the fastest is the central plan."""

from __future__ import annotations

import math
import time
from collections.abc import Iterable
from dataclasses import dataclass

from teamformer.base.array_types import Array
from teamformer.methods.central.plan_from_play import CoalitionLog
from teamformer.methods.central.plan_player import PlanPlayer
from teamformer.methods.central.players import Player, decision_of, is_coordinator, stage_for
from teamformer.methods.coordinators.on_command import OnCommand
from teamformer.methods.coordinators.replayed import Replayed
from teamformer.methods.scripted.heuristic import Heuristic
from teamformer.methods.scripted.joining import JoinAll
from teamformer.methods.seam.protocol import Policy
from teamformer.mission.checks.costs import judged_by, weighed
from teamformer.mission.checks.optional import has_optional
from teamformer.mission.coordination import Coordinator
from teamformer.mission.keys.task_keys import SMALLEST_WEIGHT
from teamformer.mission.model import Mission
from teamformer.planning.problem.coalition_plan import CoalitionPlan, routes_of
from teamformer.planning.relaxation.solve import RelaxedSolution
from teamformer.world.env import TeamFormation
from teamformer.world.rules.constants import NEVER, NOBODY

Script = list[dict[int, tuple[Array, int]]]
"""For each step and slot, the counts wanted and the task named."""

Curve = tuple[tuple[float, int], ...]

Rank = tuple[float, int]
"""What a play costs, infinite if it does not do all tasks, and less the more of them it does."""

WORST: Rank = (math.inf, 1)
"""The rank of a play that nobody waited for."""

SIMPLE_RULES: tuple[tuple[str, Policy], ...] = (("join-all", JoinAll()), ("heuristic", Heuristic()))
"""Rules that the plan must not be slower than."""

SIMPLE = 0.15
"""Share of the time that the play of a simple rule may take."""

BELIEVED_SECONDS = 5.0
"""What the play of the default by beliefs may take, however little time is left.

That is far more than it takes in small missions, where so much is uncertain that every step makes
another plan.
"""

LOOK = 20
"""Every so many steps of a play in a mission with a cost it is asked whether it is beaten."""

MARGIN = 0.1
"""Seconds kept back at the end, besides what the last plays take."""


@dataclass(frozen=True)
class CentralPlan:
    """What the planner found for a mission.

    `solution` is the relaxed schedule, in which joining is free; no policy is faster than `bound`.
    `makespan` is what the plan takes under the step rules, None if it does not end. `played_by`
    says where the plan comes from: `search` (with forming counted), `schedule` (the relaxed one),
    `plan` (the shared one, or `crews`) or a simple rule. `curve` holds each improvement as
    (seconds, makespan). `is_first` says that there was no time to improve the first plan. The
    script is played in `mission`, by `coordinator` if there is one.
    """

    solution: RelaxedSolution
    bound: int
    makespan: int | None
    played_by: str
    script: Script
    mission: Mission
    coordinator: Coordinator | None = None
    curve: Curve = ()
    is_first: bool = False


class Plays:
    """What has been played of one mission, and the time that is left."""

    def __init__(self, mission: Mission, begun: float, time_limit: float) -> None:
        self.begun = begun
        self.makespan: int | None = None
        self.best_plan: tuple[Rank, CoalitionPlan] | None = None
        self._cost = math.inf  # of the best play: its makespan, if that alone counts
        self._weights, self._may_miss = judged_by(mission), has_optional(mission)
        self.limit = time_limit
        self._source = self._mission = mission
        self._played_by, self._script = "", Script()
        self._coordinator: Coordinator | None = None
        self._tasks_done = -1  # of the best play
        self._curve: list[tuple[float, int]] = []
        self._longest = 0.0  # seconds that the play of a plan took

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
            until = self.seconds + SIMPLE * max(1.0, self.limit)
            self.add(name, rule, until=min(until, self._end))

    def add_as_believed(self, name: str, default: Coordinator, believed: Mission) -> None:
        """Play the default as by robots that know only what they believe of the mission.

        That may be better than what the default does when it knows all.
        """
        until = max(self.limit, self.seconds + BELIEVED_SECONDS)
        self.add(name, default, until=until, mission=believed)

    @property
    def _end(self) -> float:
        """Return the second at which time is up; without a limit there is none."""
        return self.limit or math.inf

    def add_plan(self, name: str, plan: CoalitionPlan) -> Rank:
        """Play a plan; the plan whose play is the best is kept in `best_plan`."""
        begun, order = self.seconds, plan.order.tolist()
        routes = routes_of(plan, len(self._source.robots))
        rank = self.add(name, PlanPlayer(self._source, routes, order))
        self._longest = max(self._longest, self.seconds - begun)
        if self.best_plan is None or rank < self.best_plan[0]:
            self.best_plan = rank, plan
        return rank

    def add(
        self,
        name: str,
        player: Player,
        until: float | None = None,
        log: CoalitionLog | None = None,
        mission: Mission | None = None,
    ) -> Rank:
        """Play a plan, a policy or a coordinator, and keep what it decides if it is the best.

        That is the fastest or, in a mission with windows or a cost, the one that costs least.

        Until one does all tasks, that is the one that does most. Returns what it is compared by.

        What is done is noted in `log`. With a `mission` it is played by robots that know no more
        than that: it is the mission with what is uncertain left open.

        Once there is a play to show, others end early: when they are no better, or at the second
        `until`, when time is up if left out.
        """
        mission = mission or self._source
        env = stage_for(player, mission, self._source)
        end = self._end if until is None else until
        goes_by_steps = self._weights is None and not self._may_miss
        most = NEVER if self.makespan is None or not goes_by_steps else self.makespan
        script: Script = []
        while env.is_running[0] and len(script) < most:
            if self.makespan is not None and self.seconds > end:
                return WORST
            if self._weights and len(script) % LOOK == 0 and self._cost_at_least(env) > self._cost:
                return WORST
            script.append(_step(env, player))
            if log is not None:
                log.note(env)
        tally = env.tally()
        cost = self._cost_of(env) if tally.status == "completed" else math.inf
        is_fastest = cost < self._cost
        if is_fastest:
            self.makespan, self._cost = tally.steps, cost
            self._curve.append((self.seconds, tally.steps))
        does_more = self.makespan is None and tally.tasks_done > self._tasks_done
        if is_fastest or does_more:
            self._tasks_done = tally.tasks_done
            self._played_by, self._script, self._mission = name, script, mission
            self._coordinator = _again(player, env)
        return cost, -tally.tasks_done

    def _cost_of(self, env: TeamFormation) -> float:
        """Return what a play that is over costs: its makespan, if that alone counts.

        Without a cost nothing outweighs what is missed.
        """
        steps, off = env.tally().steps, env.called_off()
        cost = price_of_missed(self._source, env.missed())
        if self._weights is None:
            return cost + steps
        return cost + weighed(self._source, self._weights, env.ends(), steps, off)

    def _cost_at_least(self, env: TeamFormation) -> float:
        """Return what a play costs if all that is not done is done at once; weights count here."""
        assert self._weights is not None
        steps, ends = env.tally().steps, env.ends()
        soonest = {task: ends.get(task, steps) for task in range(len(self._source.tasks))}
        return weighed(self._source, self._weights, soonest, steps)

    def is_proven(self, bound: int) -> bool:
        """Say whether nothing can be better than the best play."""
        is_bounded = self._weights is None and not self._may_miss
        return is_bounded and self.makespan == bound

    def report(
        self,
        solution: RelaxedSolution,
        bound: int,
        searched: list[tuple[float, int]],
        is_first: bool = False,
    ) -> CentralPlan:
        """Return the best play; what the search expected in between is in its curve."""
        script = [line for line in self._script if line]  # nobody decides while nobody is left
        curve: list[tuple[float, int]] = []
        is_curve = self._weights is None and not self._may_miss
        for seconds, steps in sorted(self._curve + searched) if is_curve else ():
            is_better = not curve or steps < curve[-1][1]
            if is_better and self.makespan is not None and steps >= self.makespan:
                curve.append((round(seconds, 3), steps))
        return CentralPlan(
            solution=solution,
            bound=bound,
            makespan=self.makespan,
            played_by=self._played_by,
            script=script,
            mission=self._mission,
            coordinator=self._coordinator,
            curve=tuple(curve),
            is_first=is_first,
        )


def price_of_missed(mission: Mission, missed: Iterable[int]) -> float:
    """Return what it costs that tasks are missed, where no cost says it: more than all else does.

    Of two plans that miss tasks of different weights in all, the lighter ones cost less.
    """
    if mission.cost is not None:
        return 0.0
    weight = sum(mission.tasks[task].weight for task in missed)
    return weight * (mission.step_limit + 1) / SMALLEST_WEIGHT


def _again(player: Player, env: TeamFormation) -> Coordinator | None:
    """Return the coordinator by which the script of a play is played again."""
    if isinstance(player, PlanPlayer):
        return OnCommand(player.left_out)
    return Replayed(env.plans(), player) if is_coordinator(player) else None


def _step(env: TeamFormation, player: Player) -> dict[int, tuple[Array, int]]:
    """Let a player make a step; return what it decided."""
    view = env.view()
    decision = decision_of(player, env, view)
    named = [NOBODY] * len(view.slot) if decision.task is None else decision.task.tolist()
    slots = view.slot.tolist()
    made = {s: (decision.wanted[row].copy(), named[row]) for row, s in enumerate(slots)}
    env.step(decision)
    return made
