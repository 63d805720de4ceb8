"""The central planner: its plan, and how the plan is played under the step rules."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np
import pytest

from random_worlds import random_world
from teamformer.files.drawn.generate import Spec, generate
from teamformer.methods.central.plan_from_play import plan_from_play
from teamformer.methods.central.plan_player import PlanPlayer
from teamformer.methods.central.policy import Central
from teamformer.methods.coordinators.shared_plan import SharedPlan
from teamformer.methods.scripted.joining import JoinAll
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.planning.problem.coalition_plan import CoalitionPlan, routes_of
from teamformer.planning.problem.relaxed_problem import relax
from teamformer.planning.steps.arc_search import TeamArcs
from teamformer.planning.steps.situation import situation_in_hindsight
from teamformer.trials.trial import run_trials
from teamformer.world.env import TeamFormation


def robot(name: str, x: int, cap: str) -> Robot:
    return Robot(name, (x, 0), {cap: 1})


def task(name: str, x: int, *caps: str) -> Task:
    return Task(name, (x, 0), dict.fromkeys(caps, 1))


def corridor(robots: list[Robot], tasks: list[Task], **rules: int) -> Mission:
    return Mission("corridor", Grid(20, 1), ("a", "b"), tuple(robots), tuple(tasks), **rules)


def test_two_robots_part_because_they_are_faster_apart() -> None:
    """a.b start in the middle; a's task is 5 to the left, b's 5 to the right, a joint one is here.

    .....A....*....B....   Relaxed: joint task at step 1, then 5 steps: 6.
    Played: joining takes step 1 (the task is done in it), parting takes step 2, walking 3 to 7.
    """
    robots = [robot("r1", 10, "a"), robot("r2", 10, "b")]
    tasks = [task("joint", 10, "a", "b"), task("left", 5, "a"), task("right", 15, "b")]
    central = Central(time_limit=10.0)  # more than it takes, even on a busy machine
    [tally] = run_trials([corridor(robots, tasks)], central)
    [plan] = central.plans
    assert (plan.solution.value, plan.solution.status) == (6, "optimal")
    assert tally.steps == plan.makespan == 7
    assert (tally.joins, tally.splits, tally.illegal_decisions) == (1, 1, 0)
    assert plan.played_by == "plan"  # the default parts them too, and is played first


def test_like_robots_exchange_their_routes() -> None:
    """Robots 1 and 3 are alike; the plan sends 3 away alone, but the rules let robot 1 stay."""
    robots = [robot("r1", 10, "a"), robot("r2", 10, "b"), robot("r3", 10, "a")]
    tasks = [task("here", 10, "a", "b"), task("left", 4, "a", "b"), task("right", 16, "a")]
    mission = corridor(robots, tasks)
    player = PlanPlayer(mission, [[0, 2], [0, 1], [0, 1]])
    env = TeamFormation([mission])
    while env.is_running[0]:
        env.view()
        env.step(player.decide_in(env))
    assert env.tally().status == "completed"
    assert env.tally().illegal_decisions == 0
    # step 1 and 2 join all three, the third parts them, six cells either way
    assert env.tally().steps == 9


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.thorough
def test_never_slower_than_joining_all_and_never_faster_than_its_bound(seed: int) -> None:
    rng = np.random.default_rng(seed)
    missions = [generate(Spec(), rng) for _ in range(5)]
    missions += [random_world(rng, with_losses=False) for _ in range(10)]
    missions += [random_world(rng, with_losses=False, is_plane=True) for _ in range(5)]
    central = Central(time_limit=0.6)  # what is played is cut short when time is up
    tallies = run_trials(missions, central, seed=seed)
    join_all = run_trials(missions, JoinAll())
    for tally, other, plan in zip(tallies, join_all, central.plans, strict=True):
        assert tally.status == "completed"
        assert tally.illegal_decisions == 0
        assert plan.solution.bound <= plan.bound <= tally.steps == plan.makespan <= other.steps


def test_never_slower_than_the_shared_plan() -> None:
    rng = np.random.default_rng(3)
    missions = [generate(Spec(robots=6, tasks=8, requirements=2), rng) for _ in range(3)]
    tallies = run_trials(missions, Central(time_limit=0.0))
    shared = run_trials(missions, SharedPlan())
    for tally, other in zip(tallies, shared, strict=True):
        assert tally.status == "completed"
        assert tally.steps <= other.steps


@pytest.mark.thorough
def test_worlds_that_lose_robots_end_all_the_same() -> None:
    rng = np.random.default_rng(9)
    tallies = run_trials([random_world(rng) for _ in range(30)], Central(time_limit=0.1))
    assert {tally.status for tally in tallies} <= {"completed", "infeasible"}


def test_no_time_gives_the_first_plan_and_says_so() -> None:
    mission = generate(Spec(tasks=20), np.random.default_rng(1))
    first, later = Central(time_limit=0.0), Central(time_limit=1.0)
    [tally] = run_trials([mission], first)
    [better] = run_trials([mission], later)
    assert tally.status == better.status == "completed"
    assert (first.plans[0].is_first, later.plans[0].is_first) == (True, False)
    assert better.steps <= tally.steps == first.plans[0].makespan


def test_the_curve_falls_to_what_is_played() -> None:
    mission = generate(Spec(8, 20, 8), np.random.default_rng(1))
    central = Central(time_limit=1.0)
    [tally] = run_trials([mission], central)
    seconds, makespans = zip(*central.plans[0].curve, strict=True)
    assert list(seconds) == sorted(seconds)
    assert list(makespans) == sorted(set(makespans), reverse=True)
    assert makespans[-1] == tally.steps


def test_the_time_limit_is_kept() -> None:
    mission = generate(Spec(20, 40, 8, world=Grid(20, 20)), np.random.default_rng(2))
    central = Central(time_limit=1.0)
    run_trials([generate(Spec(), np.random.default_rng(0))], central)  # compiles
    begun = time.process_time()  # of two threads; a busy machine makes it less, not more
    central.begin([mission], np.random.default_rng(0))
    assert time.process_time() - begun < 2 * 1.25
    assert central.plans[0].makespan is not None


@pytest.mark.parametrize("seed", range(20))
def test_a_plan_takes_no_longer_than_the_search_promised(seed: int) -> None:
    """It may be done sooner: who has nothing left to do goes where its next task is."""
    mission = generate(Spec(6, 8, 3), np.random.default_rng(seed))
    found = TeamArcs(situation_in_hindsight(mission), seed).plan_anew(3000)
    assert found is not None
    assert found.makespan - 1 <= play(mission, found.plan) <= found.makespan


def test_robots_that_the_rules_cannot_part_go_on_together() -> None:
    """a and ab are wanted on the left, b and another ab on the right: 2a.b and a.2b.

    Whichever of these counts the team asks to keep, robots 1 and 2 would stay, and nobody else.
    So the four go to the left together, 5 steps, and then 10 to the right.
    """
    robots = [robot("r1", 10, "a"), robot("r2", 10, "b")]
    robots += [Robot(f"r{n}", (10, 0), {"a": 1, "b": 1}) for n in (3, 4)]
    tasks = [Task("left", (5, 0), {"a": 2, "b": 1}), Task("right", (15, 0), {"a": 1, "b": 2})]
    mission = replace(corridor(robots, tasks), teams=((0, 1, 2, 3),))
    player = PlanPlayer(mission, [[0], [1], [0], [1]])
    env = TeamFormation([mission])
    while env.is_running[0]:
        env.view()
        env.step(player.decide_in(env))
    tally = env.tally()
    assert (tally.status, tally.steps, tally.splits) == ("completed", 15, 0)


@pytest.mark.parametrize("is_plane", [False, True])
def test_a_play_becomes_a_plan(is_plane: bool) -> None:
    """Also on planes, where who does a task stands anywhere within the arrival radius of it."""
    rng = np.random.default_rng(3)
    worlds = [random_world(rng, False, False, is_plane) for _ in range(25)]
    for mission in worlds:
        problem = relax(mission)
        plan = plan_from_play(mission, JoinAll())
        assert plan is not None
        for task, size in enumerate(plan.size.tolist()):
            has = problem.counts[plan.coalition[task, :size]].sum(axis=0)
            assert (has >= problem.needs[task]).all()
        assert play(mission, plan) > 0


def play(mission: Mission, plan: CoalitionPlan) -> int:
    player = PlanPlayer(mission, routes_of(plan, len(mission.robots)), plan.order.tolist())
    env = TeamFormation([mission])
    while env.is_running[0]:
        env.view()
        env.step(player.decide_in(env))
    assert env.tally().status == "completed"
    assert env.tally().illegal_decisions == 0
    return env.tally().steps


def test_it_has_to_be_given_the_missions() -> None:
    with pytest.raises(ValueError, match="missions"):
        Central().begin(None, np.random.default_rng(0))
