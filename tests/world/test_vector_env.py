"""The vector environment shows and pays what the PettingZoo environment does, world by world."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from random_worlds import random_world
from teamformer.base.errors import TeamformerError
from teamformer.files.drawn.generate import Spec
from teamformer.mission.model import Absence, Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.world.env import Decision, TeamFormation
from teamformer.world.multi_agent.action_masks import legal_actions_of_rows
from teamformer.world.multi_agent.action_spaces import count_actions, legal_actions
from teamformer.world.multi_agent.drawing import JOINED, TEAM, WALL
from teamformer.world.multi_agent.parallel_env import TeamFormationParallel
from teamformer.world.multi_agent.vector_env import TeamFormationVector

SPEC = Spec(robots=4, tasks=3, capabilities=3, world=Grid(6, 6), step_limit=40)

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


@pytest.mark.parametrize("source", [SPEC, CORRIDOR])
def test_a_world_is_what_the_parallel_environment_has(source: Any) -> None:
    vector = TeamFormationVector(source, worlds=1)
    parallel = TeamFormationParallel(source, actions="original")
    seen, infos = vector.reset(seed=5)
    shown, _ = parallel.reset(seed=5)
    rng = np.random.default_rng(0)
    names = parallel.possible_agents
    for _ in range(3):  # missions
        while True:
            for robot, name in enumerate(names):
                if name in shown:
                    assert shown[name].keys() == seen.keys()
                    for key, array in shown[name].items():
                        assert np.array_equal(array, seen[key][robot]), key
            actions = np.array([rng.choice(np.flatnonzero(row)) for row in vector.action_masks()])
            answers = {name: int(actions[names.index(name)]) for name in parallel.agents}
            shown, rewards, ended, cut, _ = parallel.step(answers)
            seen, paid, is_ended, is_cut, infos = vector.step(actions)
            assert {name: paid[names.index(name)] for name in rewards} == rewards
            if not parallel.agents:
                assert is_ended.all() == any(ended.values())
                assert is_cut.all() == any(cut.values())
                break
            assert not is_ended.any()
            assert not is_cut.any()
        shown, _ = parallel.reset()
        seen, paid, is_ended, is_cut, infos = vector.step(actions)
        assert not paid.any()
        assert not is_ended.any()
        assert not is_cut.any()
        assert infos["is_deciding"].all()  # everybody starts alone


def test_worlds_end_and_start_again_each_by_itself() -> None:
    alone = [TeamFormationVector(SPEC, worlds=1, actions="counts") for _ in range(3)]
    together = TeamFormationVector(SPEC, worlds=3, actions="counts")
    together.reset(seed=1)
    starts = list(together._env.missions)
    for env, mission in zip(alone, starts, strict=True):
        env._env.restart(0, mission, mission)
        env._observe()
    over = np.zeros(3, dtype=bool)
    for _ in range(SPEC.step_limit or 1):
        counts = together._seen["counts"].copy()
        _, rewards, ended, cut, _ = together.step(counts)
        for w, env in enumerate(alone):
            if over[w]:
                continue
            _, own, own_ended, own_cut, _ = env.step(env._seen["counts"].copy())
            robots = slice(4 * w, 4 * w + 4)
            assert (rewards[robots] == own).all()
            assert (ended[robots] == own_ended).all()
            assert (cut[robots] == own_cut).all()
            over[w] = (own_ended | own_cut).any()
    assert over.all()


def test_masks_of_all_teams_are_those_of_each() -> None:
    rng = np.random.default_rng(7)
    for _ in range(40):
        env = TeamFormation([random_world(rng)])
        caps = env.worlds.has.shape[2]
        for _ in range(12):
            if not env.is_running[0]:
                break
            view = env.view()
            masks = np.zeros((len(view.slot), count_actions(caps)), dtype=np.int8)
            legal_actions_of_rows(view, masks)
            for row in range(len(view.slot)):
                assert (masks[row] == legal_actions(view, row)).all()
            joined = view.counts + rng.integers(0, 2, view.counts.shape)
            env.step(Decision(np.where(rng.random((len(joined), 1)) < 0.5, joined, view.counts)))


def test_a_start_is_of_the_same_sizes() -> None:
    env = TeamFormation([CORRIDOR])
    with pytest.raises(ValueError, match="other sizes"):
        env.restart(0, TINY, TINY)
    env.fork()
    env.restart(0, CORRIDOR, CORRIDOR)  # without walls there are no ways to share


TINY = Mission(
    "tiny", Grid(2, 1), ("a",), (Robot("ann", (0, 0), {"a": 1}),), (Task("t", (1, 0), {"a": 1}),)
)


def test_what_cannot_be_asked_is_told() -> None:
    with pytest.raises(TeamformerError, match="worlds is 0"):
        TeamFormationVector(SPEC, worlds=0)
    env = TeamFormationVector(SPEC, actions="counts")
    with pytest.raises(TeamformerError, match="counts have no masks"):
        env.action_masks()
    with pytest.raises(TeamformerError, match="give one number"):
        env.reset(seed=[1])


def test_ended_worlds_start_again_at_once_for_stable_baselines() -> None:
    pytest.importorskip("stable_baselines3")
    from teamformer.world.multi_agent.sb3 import TeamFormationSB3

    env, plain = TeamFormationSB3(TeamFormationVector(TINY)), TeamFormationVector(TINY)
    first = env.reset()
    plain.reset()
    maintain = np.zeros(1, dtype=np.int64)
    seen, rewards, is_over, infos = env.step(maintain)  # a cell to walk, and the task is done
    last, paid, ended, *_ = plain.step(maintain)
    assert rewards.tolist() == paid.tolist() == [8.0]
    assert is_over.tolist() == ended.tolist() == [True]
    assert infos[0]["TimeLimit.truncated"] is False
    for name, array in infos[0]["terminal_observation"].items():
        assert np.array_equal(array, last[name][0])
    assert all(np.array_equal(seen[name], first[name]) for name in first)
    assert np.array_equal(env.env_method("action_masks")[0], plain.action_masks()[0])


def test_who_does_not_decide_can_only_maintain() -> None:
    env = TeamFormationVector(CORRIDOR)
    env.reset(seed=0)
    join = 0b10  # ann wants what bob brings, too
    env.step(np.array([join, 0, 0]))
    masks = env.action_masks()
    assert np.flatnonzero(masks[1]).tolist() == [0]  # bob is in ann's team now
    assert masks[0].sum() > 1


def test_worlds_are_drawn_as_text_and_pixels() -> None:
    """A robot at (0, 0), two together at (2, 1), a task at (1, 1); a wall at (2, 0); y goes up."""
    robots = [Robot("a", (0, 0), {"lift": 1}), Robot("b", (2, 1), {"lift": 1})]
    mission = Mission(
        "drawn",
        Grid(3, 2, ("..@", "...")),
        ("lift",),
        (*robots, replace(robots[1], name="c")),
        (Task("t", (1, 1), {"lift": 3}),),
        teams=((1, 2),),
    )
    env = TeamFormationVector(mission, worlds=2, render_mode="ansi")
    env.reset(seed=1)
    drawn = env.render()
    assert drawn is not None
    assert drawn == (".o2\n1.#\nstep 0: 0 tasks done",) * 2
    pixels = TeamFormationVector(mission, render_mode="rgb_array").render()
    assert pixels is not None
    [picture] = pixels
    assert isinstance(picture, np.ndarray)
    assert picture.shape == (24, 36, 3)
    assert picture[6, 30].tolist() == list(JOINED)
    assert picture[18, 6].tolist() == list(TEAM)
    assert picture[18, 30].tolist() == list(WALL)
    assert TeamFormationVector(mission).render() is None
    with pytest.raises(TeamformerError, match="render_mode is 'human'"):
        TeamFormationVector(mission, render_mode="human")  # type: ignore[arg-type]
