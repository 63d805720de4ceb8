"""Robots that fly in continuous time: each robot takes its own way."""

from __future__ import annotations

import pytest

from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.planning.continuous.continuous_mission import pose_mission
from teamformer.trials.planned import plan_mission

WALL = Grid(5, 3, ("..@..", "..@..", "....."))


def survey(ends: str | None = None) -> Mission:
    """A drone and a cart left of a wall, a task for both behind it: 2 cells over it, 6 around."""
    robots = (
        Robot("drone", (1, 0), {"a": 1}, 0.5, moves="air"),
        Robot("cart", (1, 0), {"b": 1}, 2.0),
    )
    task = Task("t", (3, 0), {"a": 1, "b": 1}, 1.0)
    return Mission("m", WALL, ("a", "b"), robots, (task,), time="continuous", ends=ends)


def test_ways_are_by_robot() -> None:
    mission = pose_mission(survey("home"))
    rest = mission.clock.rest
    ways = rest.ways[rest.pace, rest.origin, 0]
    assert ways.tolist() == [2 / 0.5, 6 / 2.0]
    assert rest.home[:, 0].tolist() == [2 / 0.5, 6 / 2.0]


@pytest.mark.parametrize("method", ["plan", "central", "reactive"])
def test_a_plan_flies(method: str) -> None:
    """There after 4 and 3, done at 5, and back after 4 more of the drone."""
    made = plan_mission(survey("home"), method, 2.0)
    assert made is not None
    assert made.makespan == pytest.approx(9.0)
