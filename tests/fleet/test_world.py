"""The world of simulated bodies: walking, turning, serving, by hand."""

from __future__ import annotations

from dataclasses import replace

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


def hidden_in_a_plane(finding_radius: float) -> FleetMission:
    """Return a robot 5 away from a task that is up to 0.4 off, where 0.3 apart is one place."""
    field = Plane(9.0, 9.0, arrival_radius=0.3, unit=0.2)
    who = (Robot("r", (0.0, 5.0), {"a": 1}),)
    tasks = (Task("t", (5.0, 5.0), {"a": 1}, duration=2.0, within=0.4),)
    mission = Mission("field", field, ("a",), who, tasks, time="continuous")
    return FleetMission(replace(mission, finding_radius=finding_radius))


def test_who_stands_where_a_task_is_sees_it_however_near_it_has_to_be() -> None:
    """On its way to (5, 5) it is at the task in (5.2, 5) once it is within 0.3: from 4.9 on."""
    fleet = hidden_in_a_plane(0.0)
    truth = replace(
        fleet.source, tasks=(fleet.source.tasks[0].once_known((5.2, 5.0), {"a": 1}, 2),)
    )
    world = FleetWorld(fleet, truth)
    world.command(0, Command(1, (5.0, 5.0), 0))
    world.advance(4.89)
    assert (world.report(0).load, world.report(0).is_gone) == (None, True)
    world.advance(4.91)
    assert (world.report(0).load, world.report(0).is_gone) == ((5.2, 5.0), False)


@pytest.mark.parametrize(("radius", "places"), [(0.0, 13), (0.3, 13), (0.51, 9), (0.71, 1)])
def test_places_to_look_count_with_who_stands_a_little_beside_them(
    radius: float, places: int
) -> None:
    """Of 13 places; who is 0.3 beside one surely sees what is within the radius less 0.3 of it."""
    assert len(hidden_in_a_plane(radius).hidden[0]) == places
