"""A trial: one mission, one method, one seed, run to its end; alone or many side by side."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from teamformer.model import Scenario
from teamformer.policies.central.plays import CentralPlan
from teamformer.policies.protocol import Planner, Policy
from teamformer.sim.env import Tally, TeamFormation
from teamformer.sim.replay.record import Replay
from teamformer.trials.methods import Method, as_method
from teamformer.trials.recorder import Recorder
from teamformer.truth import draw_truth


@dataclass(frozen=True)
class Trial:
    """A finished trial: its record, and what the clock said (which the record never holds).

    The seconds are apart: `planning_seconds` are of plans, crews and orders, `decision_seconds` of
    the policy, `simulating_seconds` of all else. `is_interrupted` says that Ctrl-C was pressed, be
    it in the very last step.
    """

    replay: Replay
    planning_seconds: float
    decision_seconds: float
    total_seconds: float
    is_interrupted: bool = False
    plan: CentralPlan | None = None  # where the central planner decided

    @property
    def simulating_seconds(self) -> float:
        """Return the seconds that neither planning nor deciding took."""
        return max(0.0, self.total_seconds - self.planning_seconds - self.decision_seconds)


def run_trial(
    mission: Scenario,
    method: Method | Policy,
    seed: int = 0,
    lower_bound: int | None = None,
    on_step: Callable[[Tally], None] | None = None,
) -> Trial:
    """Run one trial and record it; Ctrl-C ends it with what was done so far.

    The seed says what an uncertain mission really is. A policy that is told everything is told
    that too, so that for it nothing is uncertain.

    `lower_bound` is what is known of the mission; a planner that has proven more raises it.
    `on_step` is called after each step, for a display of progress.
    """
    method = as_method(method, mission)
    policy, scenario = method.policy, method.apply(mission)
    begun = time.perf_counter()
    planning = deciding = 0.0
    truth = draw_truth(scenario, seed)
    env = TeamFormation([truth if policy.needs_everything else scenario], truths=[truth])
    recorder = Recorder(env)
    is_interrupted = False
    try:
        planning = _seconds(lambda: _begin(policy, [truth], seed))
        while env.is_running[0]:
            view = env.view()
            asked = time.perf_counter()
            decision = policy.decide(view)
            deciding += time.perf_counter() - asked
            env.step(decision)
            recorder.step()
            if on_step is not None:
                on_step(env.tally())
    except KeyboardInterrupt:
        is_interrupted = True
    plan = next(iter(policy.plans), None) if isinstance(policy, Planner) else None
    replay = recorder.finish(method.name, seed, _best_bound(lower_bound, plan))
    seconds = (planning + env.planning_seconds, deciding, time.perf_counter() - begun)
    return Trial(replay, *seconds, is_interrupted, plan)


def run_trials(
    missions: Sequence[Scenario],
    method: Method | Policy,
    seed: int = 0,
    threads: int = 1,
    truth_seeds: Sequence[int] = (),
) -> list[Tally]:
    """Run one trial of each mission side by side, unrecorded, and return how each ended.

    `truth_seeds` say what uncertain missions really are; left out, `seed` says it of them all.
    """
    policy = method.policy if isinstance(method, Method) else method
    scenarios = [as_method(method, mission).apply(mission) for mission in missions]
    seeds = truth_seeds or [seed] * len(scenarios)
    truths = [draw_truth(scenario, own) for scenario, own in zip(scenarios, seeds, strict=True)]
    played = truths if policy.needs_everything else scenarios
    with TeamFormation(played, threads=threads, truths=truths) as env:
        _begin(policy, truths, seed)
        while env.is_running.any():
            env.step(policy.decide(env.view()))
        return [env.tally(w) for w in range(len(scenarios))]


def _best_bound(known: int | None, plan: CentralPlan | None) -> int | None:
    """Return the highest bound that holds for every policy."""
    proven = None if plan is None else plan.bound
    return max((bound for bound in (known, proven) if bound is not None), default=None)


def _begin(policy: Policy, scenarios: Sequence[Scenario], seed: int) -> None:
    """Start a policy; only one that says so is told more than its views."""
    policy.begin(scenarios if policy.needs_everything else None, np.random.default_rng(seed))


def _seconds(work: Callable[[], None]) -> float:
    begun = time.perf_counter()
    work()
    return time.perf_counter() - begun
