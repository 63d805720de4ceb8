"""Tasks that come after others, and tasks that wait for their time, in steps."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from plain_world import PlainWorld
from random_worlds import random_decision, random_world, with_precedence_and_windows
from teamformer.export.events import events
from teamformer.grid import Grid
from teamformer.mission.rules import ALLOCATIONS
from teamformer.model import Robot, Scenario, Task
from teamformer.policies.central.policy import Central
from teamformer.policies.protocol import Policy
from teamformer.policies.scripted.follow_plan import FollowPlan
from teamformer.policies.scripted.heuristic import Heuristic
from teamformer.policies.scripted.joining import JoinAll, JoinCrew
from teamformer.referee import judge
from teamformer.sim.env import TeamFormation
from teamformer.sim.replay.record import Replay
from teamformer.sim.replay.task_times import lateness, opening_steps
from teamformer.trials.trial import run_trial
from test_step import coalitions_of, compare, shared_order, wanted_by_slot

CORRIDOR = Scenario(
    "corridor",
    Grid(9, 1),
    ("a",),
    (Robot("r", (0, 0), {"a": 1}),),
    (
        Task("near", (2, 0), {"a": 1}, after=("far",)),
        Task("far", (8, 0), {"a": 1}, duration=1),
        Task("timed", (2, 0), {"a": 1}, between=(17.5, 18)),
    ),
    allocation="plan",
)


def played(scenario: Scenario, policy: Policy | None = None) -> Replay:
    return run_trial(scenario, policy or FollowPlan(), "follow-plan").replay


def test_what_comes_after_another_waits_for_it() -> None:
    """Past `near` to `far` in 8 steps and one of service, 6 back; `timed` opens after 18 steps."""
    replay = played(CORRIDOR)
    done = {k: n for n, step in enumerate(replay.steps, 1) for k, _ in step.done}
    assert done == {1: 9, 0: 15, 2: 19}
    assert opening_steps(replay) == [9, 0, 18]
    assert lateness(replay) == {"timed": 1}
    assert [(e.step, e.task) for e in events(replay) if e.kind == "appears"] == [(9, 0), (18, 2)]
    verdict = judge(replay)
    assert verdict.is_legal
    assert verdict.late == {"timed": 1}


def test_central_plans_what_cannot_but_be_late() -> None:
    """8 steps to `far`, which takes 4 and was to be done in 3; 6 back to `near`."""
    far = replace(CORRIDOR.tasks[1], duration=4, between=(0, 3))
    scenario = replace(CORRIDOR, tasks=(CORRIDOR.tasks[0], far))
    replay = played(scenario, Central(time_limit=0.5))
    assert replay.end.makespan == 18
    assert lateness(replay) == {"far": 9}
    assert judge(replay).findings == ()


def test_the_referee_finds_what_was_done_too_early() -> None:
    replay = played(
        replace(CORRIDOR, tasks=(replace(CORRIDOR.tasks[0], after=()), *CORRIDOR.tasks[1:]))
    )
    forged = judge(
        replace(replay, scenario=replace(CORRIDOR, step_limit=replay.scenario.step_limit))
    )
    told = " ".join(finding.message for finding in forged.findings)
    assert "task near cannot be done: it comes after far" in told


@pytest.mark.parametrize("is_plane", [False, True], ids=["grid", "plane"])
def test_the_step_is_what_the_plain_twin_does(is_plane: bool) -> None:
    rng = np.random.default_rng(5)
    for _ in range(40):
        scenario = with_precedence_and_windows(random_world(rng, is_plane=is_plane), rng)
        scenario = replace(scenario, allocation=str(rng.choice(ALLOCATIONS)))
        env, twin = TeamFormation([scenario]), PlainWorld(scenario)
        while env.is_running[0] and env.tally().steps < 60:
            twin.crew_of = env.worlds.robots["crew"][0].tolist()
            twin.list_of = env.worlds.tasks["crew"][0].tolist()
            twin.order = shared_order(env)
            twin.coalitions = coalitions_of(env, twin.order)
            assert sorted(twin.order) == sorted(twin.open)
            view = env.view()
            decision = random_decision(view, rng)
            twin.step(wanted_by_slot(env, view, decision), twin.order)
            env.step(decision)
            compare(env, twin)


@pytest.mark.parametrize(
    ("policy", "allocation", "worlds"),
    [
        (FollowPlan(), "plan", 20),
        (JoinCrew(), "crews", 60),
        (JoinAll(), "nearest", 60),
        (Heuristic(), "paper", 60),
    ],
    ids=ALLOCATIONS[::-1],
)
def test_every_mission_ends_and_its_record_is_legal(
    policy: Any, allocation: str, worlds: int
) -> None:
    rng = np.random.default_rng(3)
    for number in range(worlds):
        scenario = random_world(rng, is_plane=number % 3 == 0)
        scenario = replace(with_precedence_and_windows(scenario, rng), allocation=allocation)
        replay = played(scenario, policy)
        assert replay.end.status in ("completed", "infeasible")
        verdict = judge(replay)
        assert verdict.findings == ()
        assert verdict.late == lateness(replay)


def test_central_plans_what_comes_after_others() -> None:
    """`pair` takes both robots: `s` waits there, and `r` brings what comes before it first."""
    mission = Scenario(
        "before",
        Grid(9, 1),
        ("a", "b"),
        (Robot("r", (0, 0), {"a": 1}), Robot("s", (8, 0), {"b": 1})),
        (
            Task("pair", (6, 0), {"a": 1, "b": 1}, after=("first", "other")),
            Task("first", (2, 0), {"a": 1}, duration=2),
            Task("other", (7, 0), {"b": 1}),
        ),
        allocation="plan",
    )
    replay = run_trial(mission, Central(0.5), "central").replay
    assert judge(replay).is_legal
    assert replay.end.makespan == 2 + 2 + 4 + 1  # the way, the service, the way, joining


def test_central_is_never_slower_than_the_shared_plan() -> None:
    rng = np.random.default_rng(8)
    for _ in range(3):
        mission = with_precedence_and_windows(random_world(rng), rng)
        mission = replace(mission, allocation="plan")
        planned = run_trial(mission, Central(0.5), "central").replay
        assert judge(planned).is_legal
        shared = played(mission).end
        if shared.makespan is not None:
            assert planned.end.makespan is not None
            assert planned.end.makespan <= shared.makespan
