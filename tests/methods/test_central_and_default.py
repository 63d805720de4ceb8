"""The central planner is never worse than the default policy, whatever is known of a mission."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from random_worlds import random_world, with_precedence_and_windows, with_surprises
from small_worlds import make, robot, task
from teamformer.bench.jobs import Stopwatch
from teamformer.files.mission_files import read_mission
from teamformer.methods.by_name import Method, Player
from teamformer.methods.central.plan_centrally import plan_centrally
from teamformer.methods.central.policy import Central
from teamformer.methods.coordinators.shared_plan import SharedPlan
from teamformer.mission.model import Mission
from teamformer.record.referee import judge
from teamformer.trials.trial import run_trial, run_trials
from teamformer.world.env import Tally

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
arrivals: {rate: 1, until: 19, needs: 3, duration: 3}
"""
"""Known beforehand, this ends in a plan that takes twice as long as what the robots make of it."""


def beliefs(folder: Path) -> tuple[Mission, int]:
    (folder / "mission.yaml").write_text(BELIEFS)
    return read_mission(folder / "mission.yaml"), 0


def as_seen(_: Path) -> tuple[Mission, int]:
    """No other play is as fast as what the robots make of it, in 20 steps."""
    rng = np.random.default_rng([7, 217])
    return with_surprises(random_world(rng, is_plane=True), rng), 217


def sure(_: Path) -> tuple[Mission, int]:
    """The shared plan meets the bound of 22 steps; all other plays take 27 or more."""
    return random_world(np.random.default_rng([9, 435]), is_plane=True, with_losses=False), 435


@pytest.mark.parametrize("mission", [beliefs, as_seen, sure])
@pytest.mark.thorough
def test_what_the_default_does_better_is_played(
    mission: Callable[[Path], tuple[Mission, int]], tmp_path: Path
) -> None:
    source, seed = mission(tmp_path)
    trial = run_trial(source, Central(time_limit=0.25), seed)
    usual = run_trial(source, SharedPlan(), seed).record
    assert usual.end.status == "completed"
    assert trial.plan is not None
    assert (trial.plan.makespan, trial.plan.played_by) == (usual.end.makespan, "plan")
    assert trial.plan.mission.has_surprises == source.has_surprises
    assert (trial.record.truth is not None) == source.has_surprises
    assert trial.record.steps == usual.steps
    assert judge(trial.record).findings == ()


@pytest.mark.thorough
def test_many_missions_at_once_are_played_each_as_is_best(tmp_path: Path) -> None:
    """As they are or as they are seen; also where somebody stands between with a clock."""
    pairs = [mission(tmp_path) for mission in (beliefs, as_seen, sure)]
    missions, seeds = zip(*pairs, strict=True)
    usual = [run_trial(source, SharedPlan(), seed).record.end.steps for source, seed in pairs]
    clock = Stopwatch(Method("central", policy=Central(time_limit=0.25)), len(missions))
    for player in (Central(time_limit=0.25), clock.timed()):
        tallies = run_trials(missions, player, truth_seeds=seeds)
        assert all(tally.status == "completed" for tally in tallies)
        assert all(tally.steps <= best for tally, best in zip(tallies, usual, strict=True))
    assert clock.seconds.sum() > 0


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.thorough
def test_never_worse_than_the_default(seed: int) -> None:
    rng = np.random.default_rng(seed)
    worlds = [random_world(rng, is_plane=bool(n % 2)) for n in range(12)]
    worlds[::3] = [with_surprises(world, rng) for world in worlds[::3]]
    worlds[1::3] = [with_precedence_and_windows(world, rng) for world in worlds[1::3]]
    pairs = zip(run(worlds, Central(time_limit=0.05)), run(worlds, SharedPlan()), strict=True)
    for planned, usual in pairs:
        if usual.status == "completed":
            assert planned.status == "completed"
            assert planned.steps <= usual.steps


def test_where_nobody_is_done_in_time_what_does_most_is_played() -> None:
    """b does three tasks at 0; a is too slow to reach the joint one, at 1, in seven steps."""
    slow = replace(robot("a", 3), speed=0.3)
    tasks = [task("b", 0), task("b", 0), task("b", 0), task("ab", 1)]
    mission = make([slow, robot("b", 3)], tasks, step_limit=7)
    for seconds in (0.0, 0.2):
        end = run_trial(mission, Central(time_limit=seconds)).record.end
        usual = run_trial(mission, SharedPlan()).record.end
        assert (end.status, usual.status) == ("step limit", "step limit")
        assert end.tasks_done >= usual.tasks_done > 0


def test_where_a_plan_does_not_keep_its_promise_others_are_searched_for() -> None:
    """The first search ends with one that promises the bound, and takes 17 steps when played."""
    rng = np.random.default_rng(17)
    world = random_world(rng, with_losses=False, is_plane=True)
    plan = plan_centrally(world, time_limit=20.0, seed=17, workers=1)
    assert (plan.makespan, plan.bound) == (15, 15)


def run(worlds: list[Mission], player: Player) -> list[Tally]:
    return run_trials(worlds, player, seed=5)
