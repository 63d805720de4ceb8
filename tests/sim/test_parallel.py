"""The PettingZoo environment: its own test, whole trajectories, and what must not be seen."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from pettingzoo.test import parallel_api_test

from teamformer.model import Grid, Robot, Scenario, Task
from teamformer.scenarios.generate import Spec
from teamformer.sim.parallel import TeamFormationParallel

SPEC = Spec(robots=4, tasks=3, capabilities=3, world=Grid(6, 6), step_limit=60)

CORRIDOR = Scenario(
    name="corridor",
    world=Grid(9, 1),
    capabilities=("a", "b"),
    robots=(
        Robot("ann", (0, 0), {"a": 1}),
        Robot("bob", (0, 0), {"b": 1}),
        Robot("cat", (8, 0), {"a": 1}, lost=2),
    ),
    tasks=(Task("joint", (2, 0), {"a": 1, "b": 1}), Task("far", (8, 0), {"b": 1})),
    step_limit=30,
)


@pytest.mark.parametrize("actions", ["counts", "original"])
def test_it_passes_the_test_of_pettingzoo(actions: Any) -> None:
    parallel_api_test(TeamFormationParallel(SPEC, actions), num_cycles=300)


def trajectory(seed: int, actions: Any) -> list[Any]:
    """Return everything that comes out of a whole trial under seeded random actions."""
    env = TeamFormationParallel(SPEC, actions)
    observations, _ = env.reset(seed=seed)
    rng = np.random.default_rng(seed)
    record: list[Any] = [observations]
    while env.agents:
        answers: dict[str, Any] = {}
        for agent in env.agents:
            if actions == "original":
                legal = np.flatnonzero(observations[agent]["action_mask"])
                answers[agent] = int(rng.choice(legal))
            else:
                answers[agent] = rng.integers(0, 2, size=3)
        observations, *rest = env.step(answers)
        record += [observations, *rest]
    return record


@pytest.mark.parametrize("actions", ["counts", "original"])
def test_same_seed_same_trajectory(actions: Any) -> None:
    one, other = trajectory(3, actions), trajectory(3, actions)
    np.testing.assert_equal(one, other)
    with pytest.raises(AssertionError):
        np.testing.assert_equal(one, trajectory(4, actions))


def test_the_lowest_robot_decides_and_lost_robots_leave() -> None:
    env = TeamFormationParallel(CORRIDOR)
    env.reset()
    join, maintain = np.array([1, 1]), np.array([0, 1])
    _, rewards, terminations, _, _ = env.step({"ann": join, "bob": maintain, "cat": [1, 0]})
    # ann and bob: -2 a step, +1 for a team that is just what `joint` needs; cat has half of it
    assert rewards == {"ann": -1.0, "bob": -1.0, "cat": -1.5}
    assert not any(terminations.values())
    # now ann speaks for both; bob asks for a split in vain
    observations, rewards, terminations, _, _ = env.step({"ann": join, "bob": maintain})
    assert terminations == {"ann": False, "bob": False, "cat": True}
    assert rewards["cat"] == 0.0
    assert env.agents == ["ann", "bob"]
    assert observations["bob"]["counts"].tolist() == [1, 1]
    _, rewards, _, _, _ = env.step({"ann": join})
    assert rewards == {"ann": 8.0, "bob": 8.0}  # joint is done: +7, and the fit of 1


def test_everybody_ends_together() -> None:
    env = TeamFormationParallel(CORRIDOR)
    env.reset()
    steps = 0
    while env.agents:
        answers = dict.fromkeys(env.agents, np.array([1, 1]))
        _, _, terminations, truncations, _ = env.step(answers)
        steps += 1
    assert steps == 9  # joined in 1, joint in 3, six more cells to far
    assert all(terminations.values())
    assert not any(truncations.values())


def test_the_step_limit_truncates() -> None:
    env = TeamFormationParallel(replace(CORRIDOR, step_limit=2))
    env.reset()
    for _ in range(2):
        _, _, terminations, truncations, _ = env.step({})
    assert (terminations["ann"], truncations["ann"]) == (False, True)
    assert (terminations["cat"], truncations["cat"]) == (True, False)
    assert env.agents == []


def test_the_future_and_the_distance_cannot_be_seen() -> None:
    """Another late task, another loss later, another robot far away: the start looks the same."""
    late = Task("late", (5, 0), {"a": 1}, appears=4)
    scenario = replace(CORRIDOR, tasks=(*CORRIDOR.tasks, late))
    other = replace(
        scenario,
        tasks=(*CORRIDOR.tasks, replace(late, at=(1, 0), needs={"b": 1})),
        robots=(
            scenario.robots[0],
            replace(scenario.robots[1], lost=5),
            replace(scenario.robots[2], at=(6, 0), lost=2),
        ),
    )
    worlds = [TeamFormationParallel(scenario), TeamFormationParallel(other)]
    seen = [env.reset()[0] for env in worlds]
    for _ in range(3):
        for agent in ("ann", "bob"):
            np.testing.assert_equal(seen[0][agent], seen[1][agent])
        seen = [env.step(dict.fromkeys(env.agents, np.array([1, 1])))[0] for env in worlds]
    seen = [env.step(dict.fromkeys(env.agents, np.array([1, 1])))[0] for env in worlds]
    with pytest.raises(AssertionError):
        np.testing.assert_equal(seen[0]["ann"], seen[1]["ann"])  # now the late task is known
