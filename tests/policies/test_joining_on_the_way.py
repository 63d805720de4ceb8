"""Joining on the way: for large tasks it saves steps, and small ones see nothing of it."""

from __future__ import annotations

from dataclasses import replace

from teamformer.policies.scripted.joining import JoinAtTask, JoinCrew
from teamformer.scenarios.named_settings import world_of
from teamformer.trials.trial import run_trials


def steps(policy: JoinAtTask, setting: str, worlds: int) -> list[int]:
    scenarios = [replace(world_of(setting, seed), allocation="crews") for seed in range(worlds)]
    tallies = run_trials(scenarios, policy)
    assert all(tally.status == "completed" for tally in tallies)
    return [tally.steps for tally in tallies]


def test_it_saves_steps_where_tasks_need_fifty_robots() -> None:
    at_task = steps(JoinAtTask(), "100N20T-C100-R50", worlds=8)
    on_the_way = steps(JoinCrew(), "100N20T-C100-R50", worlds=8)
    assert sum(on_the_way) < sum(at_task)


def test_it_changes_nothing_where_tasks_need_eight_at_most() -> None:
    assert steps(JoinCrew(), "8N20T-C8", worlds=8) == steps(JoinAtTask(), "8N20T-C8", worlds=8)
