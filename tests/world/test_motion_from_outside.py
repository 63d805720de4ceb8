"""Steps whose motion comes from outside: the phases around it stay what they are."""

from __future__ import annotations

import numpy as np
import pytest

from random_worlds import random_decision, random_world
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.plane import Plane
from teamformer.world.env import Decision, TeamFormation
from teamformer.world.rules.constants import NOBODY


def test_a_step_in_two_parts_is_the_whole_step() -> None:
    """One environment walks by itself; another is told where the first one's teams have gone."""
    rng = np.random.default_rng(0)
    missions = [random_world(rng, is_plane=True, with_losses=False) for _ in range(60)]
    whole, parts = TeamFormation(missions), TeamFormation(missions)
    for _ in range(60):
        if not whole.is_running.any():
            break
        decision = random_decision(whole.view(), rng)
        whole.step(decision)
        parts.view()
        parts.start_step(decision)
        parts.finish_step(places_of(whole))
        assert [whole.tally(w) for w in range(60)] == [parts.tally(w) for w in range(60)]
        assert (whole.rewards == parts.rewards).all()
    is_team = whole.worlds.teams["size"] > 0
    assert (is_team == (parts.worlds.teams["size"] > 0)).all()
    assert (whole.worlds.teams["task"][is_team] == parts.worlds.teams["task"][is_team]).all()


def places_of(env: TeamFormation) -> np.ndarray:
    """Return the team's place at every slot of a robot in it: (worlds, robots, 2)."""
    slots = env.worlds.robots["team"]
    teams = np.take_along_axis(env.worlds.teams, np.maximum(slots, 0), axis=1)
    return np.stack([teams["x"], teams["y"]], axis=-1)


def one_robot(duration: int = 0) -> Mission:
    """A robot at the left edge of a field of four metres; a task in its middle."""
    robot = Robot("r", (0.0, 1.0), {"a": 1}, speed=0.5)
    task = Task("t", (2.0, 1.0), {"a": 1}, duration)
    return Mission("field", Plane(4.0, 2.0), ("a",), (robot,), (task,))


def carry(env: TeamFormation, x: float, y: float) -> None:
    env.start_step(Decision(env.view().counts))
    env.finish_step(np.array([[[x, y]]]))


def test_a_task_is_done_within_the_arrival_radius_and_not_beyond() -> None:
    env = TeamFormation([one_robot()])
    carry(env, 2.0, 1.051)
    assert env.tally().tasks_done == 0
    carry(env, 2.03, 1.04)  # 0.05 away
    assert env.tally().status == "completed"


def test_a_service_ends_when_the_team_is_carried_away() -> None:
    env = TeamFormation([one_robot(duration=2)])
    carry(env, 2.0, 1.0)
    assert env.view().is_serving.tolist() == [True]
    carry(env, 2.3, 1.0)
    assert env.view().is_serving.tolist() == [False]
    assert env.worlds.tasks["server"][0].tolist() == [NOBODY]
    for _ in range(3):
        carry(env, 2.0, 1.0)
    assert env.tally().status == "completed"
    assert env.tally().steps == 5


def test_what_lies_outside_the_plane_counts_as_at_its_edge() -> None:
    env = TeamFormation([one_robot()])
    carry(env, -0.2, 7.0)
    assert env.view().place.tolist() == [[0.0, 2.0]]


def test_places_must_be_there_for_all_teams() -> None:
    env = TeamFormation([one_robot()])
    env.start_step(Decision(env.view().counts))
    with pytest.raises(ValueError, match="places has \\(1, 2\\), not \\(1, 1, 2\\)"):
        env.finish_step(np.zeros((1, 2)))
    with pytest.raises(ValueError, match="no finite place"):
        env.finish_step(np.full((1, 1, 2), np.nan))
