"""The central planner is never worse than the default policy, whatever is known of a mission."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from random_worlds import random_world, with_precedence_and_windows, with_surprises
from teamformer.bench.jobs import Clock
from teamformer.model import Scenario
from teamformer.policies import POLICIES
from teamformer.policies.central.planner import plan_centrally
from teamformer.policies.central.policy import Central
from teamformer.policies.protocol import Policy
from teamformer.referee import judge
from teamformer.scenarios.files import read_scenario
from teamformer.sim.env import Tally
from teamformer.trials.registry import load_policy
from teamformer.trials.trial import run_trial, run_trials

BELIEFS = """
teamformer: 1
world: {grid: [2, 5]}
capabilities: [x, weld]
robots:
  - {at: [0, 3], can: [x], delays: 0.9}
  - {at: [1, 0], can: [x]}
tasks:
  - {at: [0, 2], needs: [x], may_need: {x: 0.7}}
  - {at: [1, 1], needs: [x], duration: 1, within: 1.0}
  - {at: [1, 4], needs: [x], duration: [2, 9], within: 6.0}
foresight: scouting
arrivals: {rate: 1, until: 19, needs: 3, duration: 3}
"""
"""Known beforehand, this ends in a plan that takes twice as long as what the robots make of it."""

LOSSES = """
teamformer: 1
world: {plane: [7.34, 10.88], step: 1, arrival_radius: 3.0}
capabilities: [a, x]
robots:
  - {at: [5.21373, 10.806187], can: [a, x], speed: 0.5, lost: [2, 22], back: 9}
  - {at: [5.21373, 10.806187], can: [a, x], speed: 0.5, breaks: {rate: 0.001, repair: [3, 5]}}
  - {at: [5.21373, 10.806187], can: {a: 3}, speed: 0.2, count: 3, name: c,
     lost: [5, 26, 48], back: [15, 37]}
  - {at: [5.21373, 10.806187], can: [a], speed: 0.2, delays: 0.5}
tasks:
  - {at: [6.9, 2.4], needs: {a: 3}, may_need: {a: 1, x: 0.3}}
  - {at: [7.34, 10.88], needs: {a: 2, x: 1}, duration: 7, appears: 7, within: 0.8}
  - {at: [7.34, 10.88], needs: {a: 1, x: 1}, may_need: {a: 0.7, x: 0}}
sensing_radius: 5
allocation: nearest
foresight: absent
finding_radius: 0
arrivals: {rate: 0.05, until: 13, needs: 3}
"""
"""Known beforehand, whatever is tried is over too late: a robot that is needed is lost."""

SURE = """
teamformer: 1
world: {plane: [4, 2]}
capabilities: [lift]
robots:
  - {at: [0, 0.51], can: [lift], count: 2}
  - {at: [0, 0], can: [lift]}
  - {at: [0, 1.51], can: [lift]}
  - {at: [0, 0], can: [lift]}
tasks:
  - {at: [0, 0], needs: {lift: 3}, appears: 7}
  - {at: [0.055, 0], needs: {lift: 2}, duration: 3}
allocation: nearest
"""
"""The search believes in 8 steps, which is the bound, but its play takes 9."""


def default() -> Policy:
    return load_policy("teamformer", POLICIES)


@pytest.mark.parametrize(
    ("text", "seed", "steps"), [(BELIEFS, 0, 49), (LOSSES, 1, 39), (SURE, 0, 8)]
)
def test_what_the_default_does_better_is_played(
    text: str, seed: int, steps: int, tmp_path: Path
) -> None:
    (tmp_path / "mission.yaml").write_text(text)
    scenario = read_scenario(tmp_path / "mission.yaml")
    central = Central(time_limit=0.25)
    trial = run_trial(scenario, central, "central", seed)
    usual = run_trial(scenario, default(), "teamformer", seed).replay
    assert (usual.end.status, usual.end.makespan) == ("completed", steps)
    assert (trial.replay.end.status, trial.replay.end.makespan) == ("completed", steps)
    assert trial.plan is not None
    assert (trial.plan.makespan, trial.plan.played_by) == (steps, "teamformer")
    assert trial.plan.is_as_seen == scenario.has_surprises
    assert (trial.replay.truth is not None) == scenario.has_surprises
    assert trial.replay.steps == usual.steps
    assert judge(trial.replay).findings == ()


def test_many_missions_at_once_are_played_each_as_is_best(tmp_path: Path) -> None:
    """As they are or as they are seen; also where somebody stands between with a clock."""
    scenarios = []
    for number, text in enumerate((BELIEFS, LOSSES, SURE)):
        (tmp_path / f"{number}.yaml").write_text(text)
        scenarios.append(read_scenario(tmp_path / f"{number}.yaml"))
    clock = Clock(Central(time_limit=0.25), len(scenarios))
    for policy in (Central(time_limit=0.25), clock):
        tallies = run_trials(scenarios, policy, truth_seeds=(0, 1, 0))
        assert [tally.steps for tally in tallies] == [49, 39, 8]
    assert clock.seconds.sum() > 0


@pytest.mark.parametrize("seed", range(3))
def test_never_worse_than_the_default(seed: int) -> None:
    rng = np.random.default_rng(seed)
    worlds = [random_world(rng, is_plane=bool(n % 2)) for n in range(12)]
    worlds[::3] = [with_surprises(world, rng) for world in worlds[::3]]
    worlds[1::3] = [with_precedence_and_windows(world, rng) for world in worlds[1::3]]
    pairs = zip(run(worlds, Central(time_limit=0.05)), run(worlds, default()), strict=True)
    for planned, usual in pairs:
        if usual.status == "completed":
            assert planned.status == "completed"
            assert planned.steps <= usual.steps


def test_where_a_plan_does_not_keep_its_promise_others_are_searched_for() -> None:
    """The first search ends with one that promises the bound, and takes 17 steps when played."""
    rng = np.random.default_rng(17)
    world = replace(random_world(rng, with_losses=False, is_plane=True), allocation="nearest")
    plan = plan_centrally(world, time_limit=20.0, seed=17, workers=1)
    assert (plan.makespan, plan.bound) == (15, 15)


def run(worlds: list[Scenario], policy: Policy) -> list[Tally]:
    return run_trials(worlds, policy, seed=5)
