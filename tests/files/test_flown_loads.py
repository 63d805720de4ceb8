"""A mission in steps has loads, or robots that fly over obstacles, but not both."""

from __future__ import annotations

from dataclasses import replace

import pytest

from teamformer.base.errors import MissionError
from teamformer.mission.checks.rules import rules_not_played
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Grid

DRONE = Robot("drone", (0, 0), {"a": 1}, moves="air")
BEHIND = Task("load", (0, 1), {"a": 1}, to=(2, 1))
LOAD = Task("load", (1, 0), {"a": 1}, to=(1, 1))
WALLED = Mission("yard", Grid(3, 2, ("...", "..@")), ("a",), (DRONE,), (LOAD,))


def test_loads_and_flights_over_obstacles_are_refused_together() -> None:
    (problem,) = rules_not_played(WALLED)
    assert problem.where == ("tasks", 0, "to")
    assert problem.message == (
        "task 'load' has a load and robot 'drone' flies: on a map with obstacles a mission cannot "
        "have both yet; drop moves: air of 'drone', or drop to and unload"
    )


def test_what_only_robots_that_fly_can_reach_gets_no_load() -> None:
    """The drone would get there; that no way leads there is not the fault."""
    with pytest.raises(MissionError) as caught:
        replace(WALLED, world=Grid(3, 2, (".@.", ".@.")), tasks=(BEHIND,))
    assert str(caught.value) == (
        "nobody can bring the load of task 'load' from [0, 1] to [2, 1]: no way leads there on the "
        "ground, and robots do not fly loads over obstacles yet; move one of the two or open the "
        "map, and drop moves: air"
    )


def test_each_alone_is_played() -> None:
    walker = replace(DRONE, moves="ground")
    assert list(rules_not_played(replace(WALLED, robots=(walker,)))) == []
    assert list(rules_not_played(replace(WALLED, tasks=(replace(LOAD, to=None),)))) == []
    assert list(rules_not_played(replace(WALLED, world=Grid(3, 2)))) == []
