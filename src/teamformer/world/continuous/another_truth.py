"""The same past, and another truth from now on: something befalls a mission, or it is one future.

Nothing is played again. What goes on ends when it does by the other truth, and what is to come from
outside is put on the agenda anew.
"""

from __future__ import annotations

from teamformer.mission.model import Mission
from teamformer.mission.parts.shifts import rotas_of
from teamformer.mission.parts.zones import loads_at_zones, rooms_of
from teamformer.world.continuous.body import CARRYING, SERVING, TeamWork, turning
from teamformer.world.continuous.delays import StandingStill
from teamformer.world.continuous.moving import ARRIVE, EXPECT, FINISH, FULL, LOOK, WAKE
from teamformer.world.continuous.world import PhysicalWorld

FROM_INSIDE = (ARRIVE, FINISH, EXPECT, LOOK, WAKE, FULL)
"""What is on the agenda because of what has happened in the world."""


def under(world: PhysicalWorld, mission: Mission, truth: Mission) -> PhysicalWorld:
    """Return a fork of a world to which from now on happens what another truth says.

    Its tasks are those of the world; others may come behind all that have appeared. What has
    happened so far must be the same in both.
    """
    twin, before = world.fork(), world.truth
    twin.mission, twin.truth, twin.still = mission, truth, StandingStill(truth.robots)
    twin.rotas, twin.may_queue = rotas_of(truth.robots), loads_at_zones(rooms_of(mission))
    twin.agenda = [entry for entry in world.agenda if entry[1] in FROM_INSIDE]
    twin.put_what_is_to_come()
    for task, work in twin.works.items():
        if work.part == SERVING and truth.tasks[task].duration != before.tasks[task].duration:
            _last_otherwise(twin, task, work)
    for robot, (one, other) in enumerate(zip(truth.robots, before.robots, strict=True)):
        if one.delays != other.delays:
            _walk_on(twin, robot)
    if twin.maybe:
        for robot in range(len(twin.bodies)):
            twin.plan_looks(robot)
    return twin


def _last_otherwise(world: PhysicalWorld, task: int, work: TeamWork) -> None:
    """Let a service that goes on end when it really does."""
    event, now = (task, work.event), world.now
    world.agenda = [e for e in world.agenda if e[1] not in (FINISH, EXPECT) or e[2:] != event]
    real, wanted = world.truth.tasks[task], world.mission.tasks[task]
    carried = world.carried(task, work.robots)
    believed = work.expected - carried - wanted.unload
    work.all_done = work.begun + (real.duration + carried + real.unload)
    work.end = work.all_done if real.to is None else work.begun + real.duration
    world.put(work.end, FINISH, *event)
    if believed < work.begun + real.duration:
        world.put(max(believed, now), EXPECT, *event)


def _walk_on(world: PhysicalWorld, robot: int) -> None:
    """Have a robot go on by a way whose times are worked out anew, with its team if it carries."""
    body = world.bodies[robot]
    work = world.works.get(body.work)
    if work is not None and work.part == CARRYING:
        world.carry(body.work, turning(work.way, world.now, world.is_plane), work.event)
    elif work is None and body.is_walking and not body.is_lost:
        stub = turning(body.way, world.now, world.is_plane)
        world.go(robot, stub, body.way[-1].place, body.since)
