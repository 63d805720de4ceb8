"""A trial: one mission, one method, one seed, run to its end; alone or many side by side."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from teamformer.base.kernels.clock import compiling_seconds, working_seconds
from teamformer.methods.by_name import Method, Player, as_method
from teamformer.methods.central.plays import CentralPlan
from teamformer.methods.seam.protocol import Planner
from teamformer.mission.coordination import Coordinator
from teamformer.mission.model import Mission
from teamformer.mission.truth import draw_truth
from teamformer.planning.bounds.makespan import lower_bound
from teamformer.planning.continuous.mission_bound import bound_in_time
from teamformer.record.record import Record
from teamformer.trials.continuous_trial import run_continuous
from teamformer.trials.memory import refuse_too_large
from teamformer.trials.recorder import Recorder
from teamformer.world.env import Decision, Tally, TeamFormation
from teamformer.world.view import View


@dataclass(frozen=True)
class PlayedTrial:
    """A finished trial: its record, and what the clock said (which the record never holds).

    The seconds are apart: `planning_seconds` are of plans and orders, `decision_seconds` of
    the policy, `compiling_seconds` of compiling, in a first run, and `simulating_seconds` of all
    else in `total_seconds`. `is_interrupted` says that Ctrl-C was pressed, be it in the very last
    step.
    """

    record: Record
    planning_seconds: float
    decision_seconds: float
    total_seconds: float
    compiling_seconds: float = 0.0
    is_interrupted: bool = False
    plan: CentralPlan | None = None  # where the central planner decided

    @property
    def simulating_seconds(self) -> float:
        """Return the seconds that neither planning, deciding nor compiling took."""
        told = self.planning_seconds + self.decision_seconds + self.compiling_seconds
        return max(0.0, self.total_seconds - told)


def run_trial(
    mission: Mission,
    player: Player,
    seed: int = 0,
    lower_bound: float | None = None,
    on_step: Callable[[Tally], None] | None = None,
    truth: Mission | None = None,
    keeps_interrupted: bool = False,
) -> PlayedTrial:
    """Run one trial and record it.

    Ctrl-C raises KeyboardInterrupt; if `keeps_interrupted`, it ends the trial with what was done
    so far.

    `player` is a method, or a policy or a coordinator by itself. `truth` is what an uncertain
    mission really is; left out, it is drawn by the seed. A policy that is told everything is told
    that too, so that for it nothing is uncertain.

    `lower_bound` is what is known of the mission; a planner that has proven more raises it.
    `on_step` is called after each step, for a display of progress. Raises `TeamformerError` for a
    mission that is too large for the memory.
    """
    method, begun, compiled = as_method(player), time.perf_counter(), compiling_seconds()
    refuse_too_large(mission, method)
    truth = draw_truth(mission, seed) if truth is None else truth
    if mission.time == "continuous":
        ran = run_continuous(mission, method, truth, on_step, keeps_interrupted)
        return PlayedTrial(
            ran.record(mission, seed, lower_bound),
            planning_seconds=ran.planning_seconds,
            decision_seconds=0.0,
            total_seconds=ran.total_seconds,
            compiling_seconds=ran.compiling_seconds,
            is_interrupted=ran.is_interrupted,
        )
    play, is_interrupted = _Play(mission, method, truth), False
    try:
        play.begin(seed)
        play.go_on(on_step)
    except KeyboardInterrupt:
        if not keeps_interrupted:
            raise
        is_interrupted = True
    env, recorder = play.stage or _recorded(TeamFormation([mission], truths=[truth]))
    plan = next(iter(method.policy.plans), None) if isinstance(method.policy, Planner) else None
    return PlayedTrial(
        recorder.finish(method.name, seed, _best_bound(lower_bound, plan)),
        planning_seconds=play.planning + env.planning_seconds,
        decision_seconds=play.deciding,
        total_seconds=time.perf_counter() - begun,
        compiling_seconds=compiling_seconds() - compiled,
        is_interrupted=is_interrupted,
        plan=plan,
    )


class _Play:
    """A trial as it is played, and the seconds that it has taken; Ctrl-C may break it off."""

    def __init__(self, mission: Mission, method: Method, truth: Mission) -> None:
        self._mission, self._method, self._truth = mission, method, truth
        self.planning = self.deciding = 0.0
        self.stage: tuple[TeamFormation, Recorder] | None = None  # None until the method has begun

    def begin(self, seed: int) -> None:
        """Have the method plan, and set the stage for it."""
        asked = working_seconds()
        try:
            begin(self._method, [self._mission], [self._truth], seed)
        finally:
            self.planning = working_seconds() - asked
        self.stage = _recorded(_stage([self._mission], self._method, [self._truth]))

    def go_on(self, on_step: Callable[[Tally], None] | None) -> None:
        """Play to the end."""
        assert self.stage is not None, "it has begun"
        env, recorder = self.stage
        while env.is_running[0]:
            view = env.view()
            asked = working_seconds()
            decision = decide(env, self._method, view)
            self.deciding += working_seconds() - asked
            env.step(decision)
            recorder.step()
            if on_step is not None:
                on_step(env.tally())


def _recorded(env: TeamFormation) -> tuple[TeamFormation, Recorder]:
    """Return a stage, and who records what happens on it."""
    return env, Recorder(env)


def bound_of(truth: Mission) -> float | None:
    """Return a number of steps, or a time, that no plan can beat; None if nothing is known.

    In continuous time `central` may find a higher one.
    """
    return lower_bound(truth) if truth.time == "steps" else bound_in_time(truth) or None


def run_trials(
    missions: Sequence[Mission],
    player: Player,
    seed: int = 0,
    threads: int = 1,
    truth_seeds: Sequence[int] = (),
) -> list[Tally]:
    """Run one trial of each mission side by side, unrecorded, and return how each ended.

    `truth_seeds` say what uncertain missions really are; left out, `seed` says it of them all.
    """
    method = as_method(player)
    seeds = truth_seeds or [seed] * len(missions)
    truths = [draw_truth(mission, own) for mission, own in zip(missions, seeds, strict=True)]
    begin(method, missions, truths, seed)
    with _stage(missions, method, truths, threads) as env:
        while env.is_running.any():
            env.step(decide(env, method, env.view()))
        return [env.tally(w) for w in range(len(missions))]


def decide(env: TeamFormation, method: Method, view: View) -> Decision:
    """Return what a method decides for the teams of a view."""
    if method.policy is None:
        return env.planned_decision(view)
    return method.policy.decide(view)


def _stage(
    missions: Sequence[Mission], method: Method, truths: Sequence[Mission], threads: int = 1
) -> TeamFormation:
    """Return the worlds that a method plays in, after it has begun."""
    coordinators: Sequence[Coordinator | None] = [method.coordinator] * len(missions)
    if isinstance(method.policy, Planner):
        missions = [plan.mission for plan in method.policy.plans]
        coordinators = [plan.coordinator for plan in method.policy.plans]
    elif method.needs_everything:
        missions = truths
    return TeamFormation(
        missions,
        threads=threads,
        truths=truths,
        coordinator=coordinators,
        new_tasks=method.new_tasks,
        foresight=method.foresight,
    )


def begin(
    method: Method, missions: Sequence[Mission], truths: Sequence[Mission], seed: int
) -> None:
    """Start a method; only a policy that says so is told more than its views."""
    policy, rng = method.policy, np.random.default_rng(seed)
    if isinstance(policy, Planner):
        policy.plan(truths, missions, rng)
    elif policy is not None:
        policy.begin(truths if policy.needs_everything else None, rng)


def _best_bound(known: float | None, plan: CentralPlan | None) -> float | None:
    """Return the highest bound that holds for every policy."""
    proven = None if plan is None else plan.bound
    return max((bound for bound in (known, proven) if bound is not None), default=None)
