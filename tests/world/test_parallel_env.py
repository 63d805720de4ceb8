"""The PettingZoo environment: its own test, whole trajectories, and what must not be seen."""

from __future__ import annotations

import importlib
import re
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pettingzoo.test import parallel_api_test

from random_worlds import random_world
from teamformer.base.errors import TeamformerError
from teamformer.base.extras import how_to_install
from teamformer.files.drawn.generate import Spec
from teamformer.mission.model import Absence, Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.world.multi_agent.parallel_env import TeamFormationParallel

SPEC = Spec(robots=4, tasks=3, capabilities=3, world=Grid(6, 6), step_limit=60)

CORRIDOR = Mission(
    name="corridor",
    world=Grid(9, 1),
    capabilities=("a", "b"),
    robots=(
        Robot("ann", (0, 0), {"a": 1}),
        Robot("bob", (0, 0), {"b": 1}),
        Robot("cat", (8, 0), {"a": 1}, absences=(Absence(2),)),
    ),
    tasks=(Task("joint", (2, 0), {"a": 1, "b": 1}), Task("far", (8, 0), {"b": 1})),
    step_limit=30,
)

REFERENCE = Path(__file__).parents[2] / "docs" / "reference"
PAGES = [REFERENCE / name for name in ("environment.md", "learners-environments.md")]
TEXT = "".join(page.read_text(encoding="utf-8") for page in PAGES)
EXAMPLES = re.findall(r"```python\n(.*?)```", TEXT, re.DOTALL)


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


def test_the_step_limit_truncates_and_shows_the_last_state() -> None:
    env = TeamFormationParallel(replace(CORRIDOR, step_limit=2))
    env.reset()
    for _ in range(2):
        observations, _, terminations, truncations, _ = env.step({})
    assert (terminations["ann"], truncations["ann"]) == (False, True)
    assert (terminations["cat"], truncations["cat"]) == (True, False)
    assert env.agents == []
    assert observations["ann"]["place"].tolist() == [2.0, 0.0]  # two steps towards `joint`
    assert observations["cat"]["place"].tolist() == [7.0, 0.0]  # seen after one, lost in the next


def test_everybody_terminates_when_a_loss_makes_a_task_impossible() -> None:
    bob = replace(CORRIDOR.robots[1], absences=(Absence(3),))
    env = TeamFormationParallel(replace(CORRIDOR, robots=(CORRIDOR.robots[0], bob)))
    env.reset()
    steps = 0
    while env.agents:
        _, _, terminations, truncations, _ = env.step({})
        steps += 1
    assert steps == 3
    assert terminations == {"ann": True, "bob": True}
    assert truncations == {"ann": False, "bob": False}


def test_a_mission_begins_anew_and_a_spec_draws_other_worlds_of_the_same_sizes() -> None:
    fixed = TeamFormationParallel(CORRIDOR)
    first, _ = fixed.reset()
    fixed.step({"ann": np.array([1, 1])})
    np.testing.assert_equal(fixed.reset()[0], first)
    env = TeamFormationParallel(SPEC)
    commonest = set()
    for seed in range(20):
        observations, _ = env.reset(seed=seed)
        counts = sum(observations[agent]["counts"] for agent in env.agents)
        commonest.add(int(counts.argmax()))
        assert counts in env.action_space("r1")
        assert observations["r1"] in env.observation_space("r1")
    assert commonest == {0, 1, 2}  # four robots, three capabilities: one of them twice


def test_what_is_seen_is_in_its_space_whatever_happens() -> None:
    rng = np.random.default_rng(5)
    for _ in range(25):
        env = TeamFormationParallel(random_world(rng), "original")
        observations, _ = env.reset()
        steps = 0
        while env.agents and steps < 40:
            answers = {}
            for agent in env.agents:
                assert observations[agent] in env.observation_space(agent)
                legal = np.flatnonzero(observations[agent]["action_mask"])
                answers[agent] = int(rng.choice(legal))
            observations, *_ = env.step(answers)
            assert env.state() in env.state_space
            steps += 1


def test_members_are_shown_padded() -> None:
    env = TeamFormationParallel(replace(CORRIDOR, teams=((0, 1),)), "original")
    observations, _ = env.reset()
    seen = observations["bob"]
    assert seen["slot"].tolist() == [0]
    assert seen["member"].tolist() == [0, 1, -1]
    assert seen["member_counts"].tolist() == [[1, 0], [0, 1], [0, 0]]
    # maintain; no join; remove nothing, a, b, but not both
    assert seen["action_mask"].tolist() == [1, 0, 0, 0, 1, 1, 1, 0]


def test_the_state_holds_everything() -> None:
    env = TeamFormationParallel(CORRIDOR)
    env.reset()
    env.step({})
    fleet, work = env.state()[:18].reshape(3, 6), env.state()[18:].reshape(2, 7)
    # slot, x, y, task, brings a, b: each has made a step, two to `joint` and one to it from afar
    assert fleet.tolist() == [[0, 1, 0, 0, 1, 0], [1, 1, 0, 0, 0, 1], [2, 7, 0, 0, 1, 0]]
    # open, done, x, y, service left, needs a, b
    assert work.tolist() == [[1, 0, 2, 0, 0, 1, 1], [1, 0, 8, 0, 0, 0, 1]]
    env.step({})
    fleet = env.state()[:18].reshape(3, 6)  # the third is lost: the others think again
    assert fleet.tolist() == [[0, 2, 0, -1, 1, 0], [1, 2, 0, -1, 0, 1], [-1] * 6]


def test_other_names_of_actions_and_too_many_capabilities_are_refused() -> None:
    with pytest.raises(TeamformerError, match="use counts or original"):
        TeamFormationParallel(SPEC, "wanted")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="17 capabilities"):
        TeamFormationParallel(Spec(capabilities=17), "original")


def test_a_missing_install_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pettingzoo", None)
    monkeypatch.delitem(sys.modules, "teamformer.world.multi_agent.parallel_env")
    with pytest.raises(TeamformerError) as caught:
        importlib.import_module("teamformer.world.multi_agent.parallel_env")
    assert caught.value.hint == how_to_install("env")


def test_the_future_and_the_distance_cannot_be_seen() -> None:
    """Another late task, another loss later, another robot far away: the start looks the same."""
    late = Task("late", (5, 0), {"a": 1}, appears=4)
    mission = replace(CORRIDOR, tasks=(*CORRIDOR.tasks, late))
    other = replace(
        mission,
        tasks=(*CORRIDOR.tasks, replace(late, at=(1, 0), needs={"b": 1})),
        robots=(
            mission.robots[0],
            replace(mission.robots[1], absences=(Absence(5),)),
            replace(mission.robots[2], at=(6, 0), absences=(Absence(2),)),
        ),
    )
    worlds = [TeamFormationParallel(mission), TeamFormationParallel(other)]
    seen = [env.reset()[0] for env in worlds]
    for _ in range(3):
        for agent in ("ann", "bob"):
            np.testing.assert_equal(seen[0][agent], seen[1][agent])
        seen = [env.step(dict.fromkeys(env.agents, np.array([1, 1])))[0] for env in worlds]
    seen = [env.step(dict.fromkeys(env.agents, np.array([1, 1])))[0] for env in worlds]
    with pytest.raises(AssertionError):
        np.testing.assert_equal(seen[0]["ann"], seen[1]["ann"])  # now the late task is known


def without_future(mission: Mission, known_until: int) -> Mission:
    """Return the mission with other late tasks, and without losses and returns, after a step."""
    last = mission.tasks[0]
    tasks = tuple(
        replace(task, at=last.at, needs=last.needs, duration=7, appears=task.appears + 3)
        if task.appears > known_until
        else task
        for task in mission.tasks
    )
    robots = tuple(robot_without_future(robot, known_until) for robot in mission.robots)
    return replace(mission, tasks=tasks, robots=robots)


def robot_without_future(robot: Robot, known_until: int) -> Robot:
    been = [away for away in robot.absences if away.lost <= known_until]
    if been and been[-1].back is not None and been[-1].back > known_until:
        been[-1] = replace(been[-1], back=been[-1].back + 2)
    return replace(robot, absences=tuple(been))


def test_no_view_depends_on_the_future_of_random_worlds() -> None:
    rng = np.random.default_rng(8)
    changed = 0
    for _ in range(40):
        mission, known_until = random_world(rng), int(rng.integers(1, 8))
        other = without_future(mission, known_until)
        changed += mission != other
        worlds = [TeamFormationParallel(world, "original") for world in (mission, other)]
        seen = [env.reset()[0] for env in worlds]
        for _ in range(known_until + 1):
            np.testing.assert_equal(seen[0], seen[1])
            if not worlds[0].agents or not worlds[1].agents:
                break
            answers = {
                agent: int(rng.choice(np.flatnonzero(observation["action_mask"])))
                for agent, observation in seen[0].items()
            }
            seen = [env.step(answers)[0] for env in worlds]
    assert changed > 13


@pytest.mark.parametrize("code", EXAMPLES)
def test_the_examples_print_what_they_say(code: str, capsys: pytest.CaptureFixture[str]) -> None:
    exec(compile(code, "docs/reference", "exec"), {})
    assert capsys.readouterr().out.splitlines() == re.findall(r"print\(.*\)  # (.+)", code)


def test_there_are_examples() -> None:
    assert len(EXAMPLES) == 6


def test_an_answer_with_fractions_is_refused() -> None:
    env = TeamFormationParallel(CORRIDOR)
    env.reset()
    with pytest.raises(ValueError, match="no whole number"):
        env.step({"ann": np.array([1.5, 0])})
