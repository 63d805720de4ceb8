"""What the central planner makes of one scenario: plans, their plays, and the best of these."""

from __future__ import annotations

import math
import time
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, replace
from itertools import chain

from teamformer.model import Scenario
from teamformer.planning.bounds.makespan import earliest_starts, lower_bound
from teamformer.planning.bounds.route_cover import raise_by_routes
from teamformer.planning.relaxation.problem import Relaxed, relax
from teamformer.planning.relaxation.solve import Solution, solve
from teamformer.planning.teams.facts import Situation, situation_in_hindsight
from teamformer.planning.teams.plan import TeamPlan, routes_of
from teamformer.planning.teams.shared_plan import HOT
from teamformer.planning.teams.solve import (
    BestPlan,
    first_search,
    from_best,
    from_coalitions,
    improve,
    plan_from_schedule,
    start_search,
)
from teamformer.planning.teams.threshold_search import ThresholdSearch
from teamformer.policies.central.plan_from_play import CoalitionLog, plan_from_play
from teamformer.policies.central.plan_player import PlanPlayer
from teamformer.policies.protocol import Policy
from teamformer.policies.scripted.follow_plan import FollowPlan
from teamformer.policies.scripted.heuristic import Heuristic
from teamformer.policies.scripted.joining import JoinAll, JoinCrew
from teamformer.rules.constants import FAR, NOBODY
from teamformer.sim.arrays import NEVER, Array
from teamformer.sim.env import TeamFormation

Script = list[dict[int, tuple[Array, int]]]
"""For each step and slot, the counts wanted and the task named."""

Curve = tuple[tuple[float, int], ...]

RELAXING = 0.3
"""Share of the time for the relaxed schedule and its proof, on one thread."""

BOUNDING = 0.2
"""Share of the time for a bound by routes, on the other."""

AT_ONCE = 5e7
"""What a bound may look at in one go for each second that it has: a tenth of them."""

SIMPLE_RULES: tuple[tuple[str, Policy], ...] = (("join-all", JoinAll()), ("heuristic", Heuristic()))
"""Rules that the plan must not be slower than."""

SIMPLE = 0.15
"""Share of the time that the play of a simple rule may take."""

CREW_SECONDS = 6e-6
"""What planning crews may take, for each task times robots and tasks: twice what it does take.

It is not begun with less time left, as it cannot be stopped.
"""

FEW_CAPABILITIES = 8
"""With more, planning crews takes longer in proportion."""

SHARED_SECONDS = 2e-4
"""What making the shared plan may take, likewise; it cannot be stopped either."""

FOLLOWED: tuple[tuple[str, str, Policy], ...] = (
    ("crews", "crews", JoinCrew()),
    ("join-all", "paper", JoinAll()),
)
"""Names, allocations and rules whose plays the search may begin at, whatever the scenario's are."""

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


def plan_centrally(
    scenario: Scenario, time_limit: float, seed: int = 0, workers: int = 2
) -> CentralPlan:
    """Return the best plan found in `time_limit` seconds; the first one if that is 0.

    The shared plan and simple rules are played too, so that the plan is never slower than theirs.
    """
    plays = _Plays(scenario, time.perf_counter(), time_limit)
    shared = CoalitionLog(scenario)
    if _has_time_for_shared_plan(scenario, time_limit):
        plays.add("plan", FollowPlan(), log=shared)  # the first play is never cut short
    situation = situation_in_hindsight(scenario)
    search = _start(scenario, situation, seed)
    if search is not None:
        plays.add("search", _player(scenario, search.best))
        _restart(search, shared.plan(search.problem))
    for name, rule in SIMPLE_RULES:
        plays.add(name, rule, most_seconds=SIMPLE * max(1.0, time_limit))
    if search is None or time_limit == 0:
        solution = solve(scenario, plays.seconds_left, seed=seed, workers=workers)
        bound, searched = solution.bound, []
    else:
        for name, allocation, followed in FOLLOWED:
            _follow(name, replace(scenario, allocation=allocation), followed, search, plays)
        solution, best = _improve(scenario, situation, search, plays, seed, workers)
        plays.add("search", _player(scenario, best.plan))
        bound, searched = best.bound, best.curve
    if time_limit > 0 and solution.schedule is not None:
        plays.add(
            "schedule", PlanPlayer(scenario, solution.schedule.routes, solution.schedule.order)
        )
    return plays.report(solution, bound, searched, is_first=time_limit == 0)


def _start(scenario: Scenario, situation: Situation, seed: int) -> ThresholdSearch | None:
    """Return a search at a first plan; None if some task can never be done."""
    if (earliest_starts(relax(scenario)) >= FAR).any():
        return None
    return first_search(situation, seed)


def _has_time_for_shared_plan(scenario: Scenario, time_limit: float) -> bool:
    """Say whether the scenario has a shared plan, and time to make and play it."""
    tasks = len(scenario.tasks)
    seconds = SHARED_SECONDS * tasks * (tasks + len(scenario.robots))
    return scenario.allocation == "plan" and seconds <= max(1.0, time_limit)


def _restart(search: ThresholdSearch, plan: TeamPlan | None) -> None:
    """Let a search go on from a plan if there is one."""
    if plan is not None:
        search.begin(plan)


def _follow(
    name: str, scenario: Scenario, rule: Policy, search: ThresholdSearch, plays: _Plays
) -> None:
    """Let the search begin at what a rule does; leave it if time is short."""
    tasks, kinds = len(scenario.tasks), max(1.0, len(scenario.capabilities) / FEW_CAPABILITIES)
    if plays.seconds_left < CREW_SECONDS * kinds * tasks * (tasks + len(scenario.robots)):
        return
    plan = plan_from_play(scenario, search.problem, rule, plays.begun + plays.limit)
    if plan is not None:
        search.begin(plan)
        plays.add(name, _player(scenario, plan))


def _improve(
    scenario: Scenario,
    situation: Situation,
    search: ThresholdSearch,
    plays: _Plays,
    seed: int,
    workers: int,
) -> tuple[Solution, BestPlan]:
    """Search until it is time for the last plays, from coalitions on one thread.

    The other proves a bound and then searches on from the best plan. The main thread only waits,
    so that Ctrl-C reaches it.
    """
    best = BestPlan(plays.begun, search)
    deadline = time.perf_counter() + plays.seconds_left
    with ThreadPoolExecutor(min(workers, 2)) as pool:
        bounding = pool.submit(_raise_bound, scenario, relax(scenario), best, deadline)
        relaxing = pool.submit(_relax_and_search, scenario, situation, best, deadline, seed)
        work: list[Future[None]] = [bounding]
        if workers > 1:  # begins when the bound is through
            work.append(pool.submit(improve, best, search, deadline, from_best(best)))
        try:
            solution = relaxing.result()
            for done in work:
                done.result()
        finally:
            best.stop()
    return solution, best


def _raise_bound(scenario: Scenario, problem: Relaxed, best: BestPlan, deadline: float) -> None:
    """Prove what can be proven in a share of the time."""
    begun = time.perf_counter()
    seconds = BOUNDING * max(0.0, deadline - begun)

    def is_over() -> bool:
        return best.is_over or time.perf_counter() - begun >= seconds

    best.raise_bound(lower_bound(scenario))
    largest = AT_ONCE * seconds
    raise_by_routes(scenario, problem, best.bound, best.raise_bound, is_over, largest)


def _relax_and_search(
    scenario: Scenario, situation: Situation, best: BestPlan, deadline: float, seed: int
) -> Solution:
    """Solve the relaxed problem, then search from its coalitions and from others."""
    seconds = RELAXING * max(0.0, deadline - time.perf_counter())
    solution = solve(scenario, seconds, seed=seed, workers=1)
    best.raise_bound(solution.bound)
    starts = from_coalitions(situation.problem, best, seed)
    if solution.schedule is not None:
        start = plan_from_schedule(situation.problem, solution.schedule)
        starts = chain([(start, HOT)], starts)
    improve(best, start_search(situation, seed + 1), deadline, starts)
    return solution


def _player(scenario: Scenario, plan: TeamPlan) -> PlanPlayer:
    return PlanPlayer(scenario, routes_of(plan, len(scenario.robots)), plan.order.tolist())


class _Plays:
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
