"""The world of simulated bodies: walking, turning, serving, by hand."""

from __future__ import annotations

import pytest

from fleets import pair
from small_worlds import make, robot, task
from teamformer.fleet.bodies.body import Command
from teamformer.fleet.bodies.world import FleetWorld
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.mission.parts.plane import Plane


def test_a_robot_is_in_a_cell_until_it_is_in_the_next() -> None:
    world = FleetWorld(FleetMission(make([robot("a", 0, speed=0.5)], [task("a", 3)])))
    world.command(0, Command(1, (3, 0), 0))
    for now, x in [(1.9, 0), (2.0, 1), (5.9, 2), (6.0, 3), (9.0, 3)]:
        world.advance(now)
        assert world.report(0).x == x


def test_who_turns_round_in_a_cell_stays_in_it() -> None:
    world = FleetWorld(FleetMission(make([robot("a", 0)], [task("a", 9)])))
    world.command(0, Command(1, (9, 0), 0))
    world.advance(2.5)
    world.command(0, Command(2, (2, 0), 0))
    for now in (2.6, 3.1, 9.0):
        world.advance(now)
        assert world.report(0)[:3] == (2, 0, 2)


def test_ways_go_round_walls() -> None:
    grid = Grid(3, 3, ("...", ".@.", "..."))
    world = FleetWorld(FleetMission(make([robot("a", 0, 1)], [task("a", 2, 1)], grid)))
    world.command(0, Command(1, (2, 1), 0))
    world.advance(3.99)
    assert world.place(0) != (2, 1)
    world.advance(4.0)
    assert world.place(0) == (2, 1)


def test_a_plane_is_crossed_straight_on() -> None:
    mission = Mission(
        "field",
        Plane(9.0, 9.0),
        ("a",),
        (Robot("r", (0.0, 0.0), {"a": 1}, 0.5),),
        (Task("t", (3.0, 4.0), {"a": 1}),),
    )
    world = FleetWorld(FleetMission(mission))
    world.command(0, Command(1, (3.0, 4.0), 0))
    world.advance(5.0)
    assert world.place(0) == pytest.approx((1.5, 2.0))
    world.command(0, Command(2, (3.0, 4.0), 0))  # going on loses nothing
    world.advance(10.0)
    assert world.place(0) == (3.0, 4.0)


def at_work() -> FleetWorld:
    """Return both robots of the pair standing at their task."""
    world = FleetWorld(pair())
    for number in (0, 1):
        world.command(number, Command(1, (6, 0), 0))
    world.advance(6.0)
    return world


def test_a_task_is_done_when_a_team_has_worked_for_its_whole_duration() -> None:
    world = at_work()
    world.command(0, Command(1, (6, 0), 0, 0, True))
    world.advance(9.0)
    assert world.done == {}  # b is not at work
    world.command(1, Command(1, (6, 0), 0, 0, True))
    world.advance(10.9)
    assert not world.report(0).is_done
    assert world.advance(11.0) == {0, 1}
    assert world.done[0].at == 11.0
    assert world.done[0].robots == (0, 1)
    assert world.report(1).is_done


@pytest.mark.parametrize("how", ["crash", "stop", "other team"])
def test_a_service_that_breaks_off_begins_anew(how: str) -> None:
    world = at_work()
    working = Command(1, (6, 0), 0, 0, True)
    for number in (0, 1):
        world.command(number, working)
    world.advance(7.5)
    if how == "crash":
        world.kill(1)
        world.revive(1)
    else:
        world.command(
            1, working._replace(serve=how != "stop", team=1 if how == "other team" else 0)
        )
    world.advance(8.0)
    world.command(1, working)
    world.advance(9.9)
    assert world.done == {}
    world.advance(10.0)
    assert world.done[0].at == 10.0


def test_who_cannot_move_stays_until_it_is_let_go() -> None:
    world = FleetWorld(pair())
    world.command(0, Command(1, (6, 0), 0))
    world.advance(2.0)
    world.hold_fast(0)
    world.advance(9.0)
    assert world.place(0) == (2, 0)
    world.let_go(0)
    world.advance(13.0)
    assert world.place(0) == (6, 0)
