"""The compiled step against its plain twin, and what worlds keep under random play."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from blocked_worlds import blocked_worlds
from plain_world import PlainWorld
from random_worlds import random_decision, random_world, with_fractions
from teamformer.mission.rules import ALLOCATIONS
from teamformer.policies.protocol import Policy
from teamformer.policies.scripted.follow_plan import FollowPlan
from teamformer.policies.scripted.heuristic import Heuristic
from teamformer.policies.scripted.join_fitting import JoinFitting
from teamformer.policies.scripted.joining import JoinAll, JoinCrew
from teamformer.rules.constants import NOBODY
from teamformer.sim.env import Decision, TeamFormation
from teamformer.sim.view import View


def compare(env: TeamFormation, twin: PlainWorld) -> None:
    teams = env.worlds.teams[0]
    assert sorted(np.flatnonzero(teams["size"]).tolist()) == sorted(twin.teams)
    for slot, team in twin.teams.items():
        record = teams[slot]
        assert np.flatnonzero(env.worlds.robots["team"][0] == slot).tolist() == team.robots
        assert (record["x"], record["y"]) == team.at
        assert record["task"] == (NOBODY if team.task is None else team.task)
        assert bool(record["is_detour"]) == team.is_detour
        assert record["serves"] == len(team.serving)
        assert record["credit"] == pytest.approx(team.credit, abs=1e-6)
        assert in_thousandths(env, env.worlds.has[0, slot]) == twin.has(team)
    done = {int(k): int(s) for k, s in enumerate(env.worlds.tasks["done_at"][0]) if s != NOBODY}
    assert done == twin.done
    tally = env.tally()
    assert (tally.joins, tally.splits) == (twin.joins, twin.splits)
    assert tally.illegal_decisions == twin.illegal


def shared_order(env: TeamFormation) -> list[int]:
    return [int(k) for k in env.worlds.order[0, : env.worlds.count["open"][0]]]


def coalitions_of(env: TeamFormation, order: list[int]) -> dict[int, set[int]]:
    """Return who does each open task by the shared plan; nothing under other allocations."""
    by_task = env.worlds.coalition[0]
    return {k: set(np.flatnonzero(by_task[k]).tolist()) for k in order if len(by_task)}


def in_thousandths(env: TeamFormation, counts: np.ndarray) -> list[int]:
    """Return the counts of a team, which arrays hold in units, as its twin has them."""
    scenario = env.scenarios[0]
    units = [scenario.units.get(cap, 1000) for cap in scenario.capabilities]
    return (counts * units).tolist()


def wanted_by_slot(env: TeamFormation, view: View, decision: Decision) -> dict[int, list[int]]:
    wanted = (in_thousandths(env, counts) for counts in decision.wanted)
    return dict(zip(view.slot.tolist(), wanted, strict=True))


def step_both(env: TeamFormation, twin: PlainWorld, view: View, decision: Decision) -> None:
    """Make a step in the compiled world and in its twin, which is told the plans; compare them."""
    twin.crew_of = env.worlds.robots["crew"][0].tolist()
    twin.list_of = env.worlds.tasks["crew"][0].tolist()
    twin.order = shared_order(env)
    twin.coalitions = coalitions_of(env, twin.order)
    scouted = env.worlds.robots["scouts"][0].tolist()
    twin.scouts = {robot: task for robot, task in enumerate(scouted) if task != NOBODY}
    twin.step(wanted_by_slot(env, view, decision), twin.order)
    env.step(decision)
    compare(env, twin)


@pytest.mark.parametrize("is_plane", [False, True], ids=["grid", "plane"])
@pytest.mark.parametrize("part", range(4))
def test_step_is_what_the_plain_twin_does(part: int, is_plane: bool) -> None:
    rng = np.random.default_rng(part)
    for _ in range(100):
        allocation = str(rng.choice(ALLOCATIONS))
        scenario = random_world(rng, is_plane=is_plane)
        scenario = with_fractions(scenario, rng) if part == 3 else scenario
        scenario = replace(scenario, allocation=allocation)
        env, twin = TeamFormation([scenario]), PlainWorld(scenario)
        twin.order = shared_order(env)
        twin.coalitions = coalitions_of(env, twin.order)
        compare(env, twin)
        while env.is_running[0] and env.tally().steps < 40:
            view = env.view()
            if rng.random() < 0.05:  # nonsense now and then: it must count as maintain
                nonsense = rng.integers(0, 4, size=view.counts.shape)
                decision = Decision(nonsense)
            else:
                decision = random_decision(view, rng)
            step_both(env, twin, view, decision)


def check_promises(env: TeamFormation, was_done: np.ndarray) -> None:
    """Every robot in one team, counts add up, nobody in a wall, done stays done."""
    worlds = env.worlds
    for w in range(len(env.scenarios)):
        slots = worlds.robots["team"][w]
        sizes = worlds.teams["size"][w]
        lost, back = worlds.robots["lost"][w], worlds.robots["back"][w]
        alive = np.flatnonzero(slots != NOBODY)
        assert sizes.sum() == len(alive)
        count = worlds.rules["robots"][w]
        steps = worlds.count["steps"][w]
        assert ((slots == NOBODY) == ((lost <= steps) & (steps < back)))[:count].all()
        for slot in np.flatnonzero(sizes):
            members = np.flatnonzero(slots == slot)
            assert members[0] == slot
            assert len(members) == sizes[slot]
            assert (worlds.has[w, slot] == worlds.brings[w, members].sum(axis=0)).all()
            team = worlds.teams[w, slot]
            assert env.scenarios[w].world.is_free((float(team["x"]), float(team["y"])))
    done = worlds.tasks["done_at"] != NOBODY
    assert (done | ~was_done).all()
    assert not (done & worlds.tasks["is_open"]).any()
    was_done[:] = done


def test_worlds_keep_their_promises_under_random_decisions() -> None:
    rng = np.random.default_rng(7)
    env = TeamFormation([random_world(rng, is_plane=w % 3 == 0) for w in range(150)])
    was_done = env.worlds.tasks["done_at"] != NOBODY
    for _ in range(40):
        env.step(random_decision(env.view(), rng))
        check_promises(env, was_done)
    assert env.worlds.count["illegal"].sum() == 0


POLICIES = pytest.mark.parametrize(
    "policy",
    [Heuristic(), JoinAll(), JoinFitting(), JoinCrew(), FollowPlan()],
    ids=["heuristic", "join-all", "join-fitting", "crews", "plan"],
)
RULES = pytest.mark.parametrize("allocation", ALLOCATIONS)


@POLICIES
@RULES
def test_nothing_blocks_whatever_happened_before(policy: Policy, allocation: str) -> None:
    """Many worlds, some in a state that random decisions have brought about."""
    count = 30 if allocation == "plan" else 150  # a plan takes a while
    assert blocked_worlds(policy, allocation, count, seed=11) == []


@POLICIES
@RULES
def test_nothing_blocks_on_planes(policy: Policy, allocation: str) -> None:
    count = 10 if allocation == "plan" else 50
    assert blocked_worlds(policy, allocation, count, seed=13, is_plane=True) == []


@pytest.mark.slow
@POLICIES
@RULES
def test_nothing_blocks_in_ten_thousand_worlds(policy: Policy, allocation: str) -> None:
    assert blocked_worlds(policy, allocation, count=10_000, seed=12) == []
    assert blocked_worlds(policy, allocation, count=5000, seed=14, is_plane=True) == []


def test_threads_and_batches_change_nothing() -> None:
    rng = np.random.default_rng(3)
    scenarios = [random_world(rng, is_plane=w % 3 == 0) for w in range(37)]
    batch, threaded = TeamFormation(scenarios), TeamFormation(scenarios, threads=4)
    alone = [TeamFormation([scenario]) for scenario in scenarios]
    policy = JoinAll()
    while batch.is_running.any():
        batch.step(policy.decide(batch.view()))
        threaded.step(policy.decide(threaded.view()))
        for env in alone:
            if env.is_running[0]:
                env.step(policy.decide(env.view()))
    for w, env in enumerate(alone):
        assert batch.tally(w) == threaded.tally(w) == env.tally()
        tasks = len(scenarios[w].tasks)
        for env_tasks in (threaded.worlds.tasks[w], env.worlds.tasks[0]):
            assert (env_tasks["done_at"][:tasks] == batch.worlds.tasks["done_at"][w, :tasks]).all()


def test_reset_brings_the_start_back() -> None:
    rng = np.random.default_rng(4)
    env = TeamFormation([random_world(rng, is_plane=w % 3 == 0) for w in range(20)])
    policy = JoinAll()

    def play() -> list[object]:
        while env.is_running.any():
            env.step(policy.decide(env.view()))
        return [env.tally(w) for w in range(20)]

    first = play()
    env.reset()
    assert env.is_running.all()
    assert play() == first
