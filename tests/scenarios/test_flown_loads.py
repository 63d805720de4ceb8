"""A mission in steps has loads, or robots that fly over obstacles, but not both."""

from __future__ import annotations

from dataclasses import replace

from teamformer.grid import Grid
from teamformer.mission.rules import rules_not_played
from teamformer.model import Robot, Scenario, Task

DRONE = Robot("drone", (0, 0), {"a": 1}, moves="air")
LOAD = Task("load", (1, 0), {"a": 1}, to=(1, 1))
WALLED = Scenario("yard", Grid(3, 2, ("...", "..@")), ("a",), (DRONE,), (LOAD,))


def test_loads_and_flights_over_obstacles_are_refused_together() -> None:
    (problem,) = rules_not_played(WALLED)
    assert problem.where == ("tasks", 0, "to")
    assert "drop to and unload, or moves: air" in problem.message


def test_each_alone_is_played() -> None:
    walker = replace(DRONE, moves="ground")
    assert list(rules_not_played(replace(WALLED, robots=(walker,)))) == []
    assert list(rules_not_played(replace(WALLED, tasks=(replace(LOAD, to=None),)))) == []
    assert list(rules_not_played(replace(WALLED, world=Grid(3, 2)))) == []
