"""The compiled step against its plain twin, and what worlds keep under random play."""

from __future__ import annotations

import numpy as np
import pytest

from blocked_worlds import blocked_worlds
from coordinations import RandomPlans
from random_worlds import random_decision, random_world, with_fractions
from teamformer.methods.by_name import Player
from teamformer.methods.coordinators.crews import Crews
from teamformer.methods.coordinators.shared_plan import SharedPlan
from teamformer.methods.scripted.heuristic import Heuristic
from teamformer.methods.scripted.join_fitting import JoinFitting
from teamformer.methods.scripted.joining import JoinAll
from teamformer.world.env import Decision, TeamFormation
from teamformer.world.rules.constants import NOBODY
from twins import Twin


@pytest.mark.parametrize("is_plane", [False, True], ids=["grid", "plane"])
@pytest.mark.parametrize("part", range(4))
def test_step_is_what_the_plain_twin_does(part: int, is_plane: bool) -> None:
    """Under the paper's order, under the shared plan, and under plans that may be any."""
    rng = np.random.default_rng(part)
    for number in range(60):
        chosen = rng.choice(["paper", "random", "random", "plan"])
        coordinator = {"paper": None, "random": RandomPlans(number), "plan": SharedPlan()}[chosen]
        mission = random_world(rng, is_plane=is_plane)
        mission = with_fractions(mission, rng) if part == 3 else mission
        new_tasks = str(rng.choice(["resolve", "nearest"]))
        env = TeamFormation([mission], coordinator=coordinator, new_tasks=new_tasks)
        twin = Twin(env)
        while env.is_running[0] and env.tally().steps < 40:
            view = env.view()
            if rng.random() < 0.05:  # nonsense now and then: it must count as maintain
                nonsense = rng.integers(0, 4, size=view.counts.shape)
                decision = Decision(nonsense)
            elif coordinator is not None and rng.random() < 0.6:
                decision = env.planned_decision(view)
            else:
                decision = random_decision(view, rng)
            if rng.random() < 0.3:  # names of tasks, open ones and such that mean nothing
                named = rng.integers(-1, len(mission.tasks) + 1, len(view.slot))
                decision = Decision(decision.wanted, named)
            twin.step(view, decision)


def check_promises(env: TeamFormation, was_done: np.ndarray) -> None:
    """Every robot in one team, counts add up, nobody in a wall, done stays done."""
    worlds = env.worlds
    for w in range(len(env.missions)):
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
            assert env.missions[w].world.is_free((float(team["x"]), float(team["y"])))
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


PLAYERS = pytest.mark.parametrize(
    "player",
    [Heuristic(), JoinAll(), JoinFitting(), Crews(), SharedPlan()],
    ids=["heuristic", "join-all", "join-fitting", "crews", "plan"],
)


@PLAYERS
@pytest.mark.thorough
def test_nothing_blocks_whatever_happened_before(player: Player) -> None:
    """Many worlds, some in a state that random decisions have brought about."""
    count = 30 if isinstance(player, SharedPlan) else 150  # a plan takes a while
    assert blocked_worlds(player, count, seed=11) == []


@PLAYERS
def test_nothing_blocks_on_planes(player: Player) -> None:
    count = 10 if isinstance(player, SharedPlan) else 50
    assert blocked_worlds(player, count, seed=13, is_plane=True) == []


@pytest.mark.slow
@PLAYERS
def test_nothing_blocks_in_ten_thousand_worlds(player: Player) -> None:
    assert blocked_worlds(player, count=10_000, seed=12) == []
    assert blocked_worlds(player, count=5000, seed=14, is_plane=True) == []


def test_threads_and_batches_change_nothing() -> None:
    rng = np.random.default_rng(3)
    missions = [random_world(rng, is_plane=w % 3 == 0) for w in range(37)]
    batch, threaded = TeamFormation(missions), TeamFormation(missions, threads=4)
    alone = [TeamFormation([mission]) for mission in missions]
    policy = JoinAll()
    while batch.is_running.any():
        batch.step(policy.decide(batch.view()))
        threaded.step(policy.decide(threaded.view()))
        for env in alone:
            if env.is_running[0]:
                env.step(policy.decide(env.view()))
    for w, env in enumerate(alone):
        assert batch.tally(w) == threaded.tally(w) == env.tally()
        tasks = len(missions[w].tasks)
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
