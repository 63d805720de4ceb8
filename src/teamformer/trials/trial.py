"""A trial: one scenario, one policy, one seed, run to its end; alone or many side by side."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from teamformer.model import Scenario
from teamformer.policies.central.plays import CentralPlan
from teamformer.policies.protocol import InHindsight, Planner, Policy
from teamformer.sim.env import Tally, TeamFormation
from teamformer.sim.replay.record import Replay
from teamformer.trials.recorder import Recorder
from teamformer.truth import draw_truth


@dataclass(frozen=True)
class Trial:
    """A finished trial: its record, and what the clock said (which the record never holds).

    `is_interrupted` says that Ctrl-C was pressed, be it in the very last step.
    """

    replay: Replay
    decision_seconds: float
    total_seconds: float
    is_interrupted: bool = False
    plan: CentralPlan | None = None  # where the central planner decided


def run_trial(
    scenario: Scenario,
    policy: Policy,
    name: str,
    seed: int = 0,
    lower_bound: int | None = None,
    on_step: Callable[[Tally], None] | None = None,
) -> Trial:
    """Run one trial and record it; Ctrl-C ends it with what was done so far.

    The seed says what an uncertain mission really is. A policy that is told everything is told
    that too, so that for it nothing is uncertain.

    `lower_bound` is what is known of the scenario; a planner that has proven more raises it.
    `on_step` is called after each step, for a display of progress.
    """
    begun = time.perf_counter()
    deciding = 0.0
    truth = draw_truth(scenario, seed)
    played = truth if policy.needs_everything else scenario
    env, recorder = _recorded(played, truth)
    is_interrupted = False
    try:
        asked = time.perf_counter()
        [chosen] = begin_trials(policy, [truth], [scenario], np.random.default_rng(seed))
        deciding += time.perf_counter() - asked
        if chosen is not played:
            env, recorder = _recorded(chosen, truth)
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
    replay = recorder.finish(name, seed, _best_bound(lower_bound, plan))
    return Trial(replay, deciding, time.perf_counter() - begun, is_interrupted, plan)


def run_trials(
    scenarios: Sequence[Scenario],
    policy: Policy,
    seed: int = 0,
    threads: int = 1,
    truth_seeds: Sequence[int] = (),
) -> list[Tally]:
    """Run one trial of each scenario side by side, unrecorded, and return how each ended.

    `truth_seeds` say what uncertain missions really are; left out, `seed` says it of them all.
    """
    seeds = truth_seeds or [seed] * len(scenarios)
    truths = [draw_truth(scenario, own) for scenario, own in zip(scenarios, seeds, strict=True)]
    played = begin_trials(policy, truths, scenarios, np.random.default_rng(seed))
    with TeamFormation(played, threads=threads, truths=truths) as env:
        while env.is_running.any():
            env.step(policy.decide(env.view()))
        return [env.tally(w) for w in range(len(scenarios))]


def _best_bound(known: int | None, plan: CentralPlan | None) -> int | None:
    """Return the highest bound that holds for every policy."""
    proven = None if plan is None else plan.bound
    return max((bound for bound in (known, proven) if bound is not None), default=None)


def begin_trials(
    policy: Policy,
    truths: Sequence[Scenario],
    seen: Sequence[Scenario],
    rng: np.random.Generator,
) -> Sequence[Scenario]:
    """Start a policy; only one that says so is told more than its views.

    Return what it decides in, for each mission: what it really is, or what the robots see of it.
    """
    if isinstance(policy, InHindsight):
        return policy.begin_in(truths, seen, rng)
    policy.begin(truths if policy.needs_everything else None, rng)
    return truths if policy.needs_everything else seen


def _recorded(scenario: Scenario, truth: Scenario) -> tuple[TeamFormation, Recorder]:
    """Return an environment of one world and what writes it down."""
    env = TeamFormation([scenario], truths=[truth])
    return env, Recorder(env)
