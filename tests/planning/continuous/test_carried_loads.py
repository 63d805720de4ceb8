"""Loads in continuous time: as fast as their slowest carrier, who goes on from where they are."""

from __future__ import annotations

import pytest

from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.plane import Plane
from teamformer.planning.continuous.continuous_mission import pose_mission
from teamformer.planning.continuous.rules import plan_continuous


def movers(ends: str | None = None) -> Mission:
    """Return two movers at x = 0, of whom one goes at half a metre a second, and a crate at 2.

    It goes to x = 8, takes one second to take up and half to unload; a lamp is at x = 9.
    """
    robots = (
        Robot("a", (0.0, 1.0), {"lift": 1, "scan": 1}),
        Robot("b", (0.0, 1.0), {"lift": 1}, speed=0.5),
    )
    tasks = (
        Task("crate", (2.0, 1.0), {"lift": 2}, duration=1.0, to=(8.0, 1.0), unload=0.5),
        Task("lamp", (9.0, 1.0), {"scan": 1}, after=("crate",)),
    )
    return Mission(
        "movers", Plane(10.0, 2.0), ("lift", "scan"), robots, tasks, time="continuous", ends=ends
    )


@pytest.mark.parametrize("method", ["plan", "central", "reactive"])
def test_load_goes_at_the_pace_of_the_slowest_and_the_next_way_begins_where_it_is(
    method: str,
) -> None:
    """b is there after 4 s; 1 s, 12 s for six metres and 0.5 s later it is done, at 17.5 s.

    From x = 8 the lamp is a second away for a.
    """
    made = plan_continuous(pose_mission(movers()), method, 0.2)
    assert made is not None
    stops = {(route.robot, stop.task): stop for route in made.routes for stop in route.stops}
    assert (stops[0, 0].start, stops[1, 0].end) == (4.0, 17.5)
    assert (stops[0, 1].arrive, stops[0, 1].end) == (18.5, 18.5)
    assert made.makespan == 18.5
    assert made.bound <= 18.5


def test_robots_go_home_from_where_loads_were_brought() -> None:
    """b is 16 s from home at x = 8; a is 9 s from home at the lamp."""
    made = plan_continuous(pose_mission(movers(ends="home")), "plan", 0.2)
    assert made is not None
    assert [route.back for route in made.routes] == [18.5 + 9, 17.5 + 16]
