"""The central planner: its plan, and how the plan is played under the step rules."""

from __future__ import annotations

import numpy as np
import pytest

from random_worlds import random_world
from teamformer.model import Grid, Robot, Scenario, Task
from teamformer.policies.central import Central
from teamformer.policies.plan_player import PlanPlayer
from teamformer.policies.scripted import JoinAll
from teamformer.policies.trial import run_trials
from teamformer.scenarios.generate import Spec, generate
from teamformer.sim.env import TeamFormation


def robot(name: str, x: int, cap: str) -> Robot:
    return Robot(name, (x, 0), {cap: 1})


def task(name: str, x: int, *caps: str) -> Task:
    return Task(name, (x, 0), dict.fromkeys(caps, 1))


def corridor(robots: list[Robot], tasks: list[Task], **rules: int) -> Scenario:
    return Scenario("corridor", Grid(20, 1), ("a", "b"), tuple(robots), tuple(tasks), **rules)


def test_two_robots_part_because_they_are_faster_apart() -> None:
    """a.b start in the middle; a's task is 5 to the left, b's 5 to the right, a joint one is here.

    .....A....*....B....   Relaxed: joint task at step 1, then 5 steps: 6.
    Played: joining takes step 1 (the task is done in it), parting takes step 2, walking 3 to 7.
    """
    robots = [robot("r1", 10, "a"), robot("r2", 10, "b")]
    tasks = [task("joint", 10, "a", "b"), task("left", 5, "a"), task("right", 15, "b")]
    central = Central(time_limit=2.0)
    [tally] = run_trials([corridor(robots, tasks)], central)
    [plan] = central.plans
    assert (plan.solution.value, plan.solution.status) == (6, "optimal")
    assert tally.steps == plan.makespan == 7
    assert (tally.joins, tally.splits, tally.illegal_decisions) == (1, 1, 0)
    assert plan.played_by == "schedule"


def test_like_robots_exchange_their_routes() -> None:
    """Robots 1 and 3 are alike; the plan sends 3 away alone, but the rules let robot 1 stay."""
    robots = [robot("r1", 10, "a"), robot("r2", 10, "b"), robot("r3", 10, "a")]
    tasks = [task("here", 10, "a", "b"), task("left", 4, "a", "b"), task("right", 16, "a")]
    scenario = corridor(robots, tasks)
    player = PlanPlayer(scenario, [[0, 2], [0, 1], [0, 1]])
    env = TeamFormation([scenario])
    while env.is_running[0]:
        env.view()
        env.step(player.decide_in(env))
    assert env.tally().status == "completed"
    assert env.tally().illegal_decisions == 0
    # step 1 and 2 join all three, the third parts them, six cells either way
    assert env.tally().steps == 9


@pytest.mark.parametrize("seed", range(3))
def test_never_slower_than_joining_all_and_never_faster_than_its_bound(seed: int) -> None:
    rng = np.random.default_rng(seed)
    scenarios = [generate(Spec(), rng) for _ in range(5)]
    scenarios += [random_world(rng, with_losses=False) for _ in range(15)]
    central = Central(time_limit=0.3)
    tallies = run_trials(scenarios, central, seed=seed)
    join_all = run_trials(scenarios, JoinAll())
    for tally, other, plan in zip(tallies, join_all, central.plans, strict=True):
        assert tally.status == "completed"
        assert tally.illegal_decisions == 0
        assert plan.solution.bound <= tally.steps == plan.makespan <= other.steps


def test_worlds_that_lose_robots_end_all_the_same() -> None:
    rng = np.random.default_rng(9)
    tallies = run_trials([random_world(rng) for _ in range(30)], Central(time_limit=0.1))
    assert {tally.status for tally in tallies} <= {"completed", "infeasible"}


def test_no_time_still_gives_a_plan() -> None:
    scenario = generate(Spec(tasks=20), np.random.default_rng(0))
    central = Central(time_limit=0.0)
    [tally] = run_trials([scenario], central)
    assert tally.status == "completed"
    assert central.plans[0].solution.value is not None


def test_it_has_to_be_given_the_scenarios() -> None:
    with pytest.raises(ValueError, match="scenarios"):
        Central().begin(None, np.random.default_rng(0))
