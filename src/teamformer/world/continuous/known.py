"""What everybody knows of a world in continuous time, as coordinators are told it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from teamformer.mission.coordination import Known
from teamformer.mission.model import Mission, Robot, Task, as_believed
from teamformer.mission.parts.capabilities import Counts, covers, total
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.zones import zones_by_name
from teamformer.mission.truth import expected_needs
from teamformer.world.continuous.body import FORMING
from teamformer.world.continuous.world import PhysicalWorld
from teamformer.world.rules.constants import NOBODY


def known_of(world: PhysicalWorld, news: tuple[str, ...], foresight: str = "scouting") -> Known:
    """Return what everybody knows now; `foresight` says what tasks are believed to need."""
    bodies = world.bodies
    there = [robot for robot, body in enumerate(bodies) if not body.is_lost]
    free = [_free(world, robot) for robot in range(len(bodies))]
    known_tasks = world.appeared - world.over.keys()
    served = world.under_way
    unseen = frozenset(world.unseen & known_tasks)
    return Known(
        mission=believed(world, _needs(world, there, unseen, foresight)),
        now=world.now,
        open_tasks=tuple(sorted(known_tasks - served)),
        places=tuple(place for place, _, _ in free),
        teams=tuple((robot,) for robot in there),
        free_at=tuple(at for _, at, _ in free),
        under_way=tuple(sorted((task, world.expected_end(task)) for task in served)),
        unseen_needs=unseen,
        unseen_places=frozenset(world.maybe.keys() & known_tasks),
        news=news,
        came_from=tuple(came_from for _, _, came_from in free),
        started=dict(world.started),
        over=frozenset(world.over),
        left=tuple(_left(world, robot, at) for robot, (_, at, _) in enumerate(free)),
        charging=world.charging_now(),
        loading={
            task: _lifted(world, task) for task in world.at_work.served if _is_load(world, task)
        },
        unloading=frozenset([*world.at_work.unloaded, *world.at_work.queue]),
    )


def believed(world: PhysicalWorld, needs: Mapping[int, Counts]) -> Mission:
    """Return the mission as it is believed to be, with these needs of tasks that are not known."""
    mission = world.mission
    over = {mission.tasks[task].name for task in world.over}
    tasks = tuple(
        _believed_task(task, world.place_of(number), needs.get(number), over)
        for number, task in enumerate(mission.tasks)
    )
    robots = tuple(_believed_robot(robot) for robot in mission.robots)
    zones = zones_by_name(mission, world.lies)
    return as_believed(mission, arrivals=None, tasks=tasks, robots=robots, zones=zones)


def _believed_task(task: Task, place: Place, needs: Counts | None, over: set[str]) -> Task:
    """Return a task at its place, after those only that are not over, with nothing left open."""
    after = tuple(name for name in task.after if name not in over)
    needs = task.needs if needs is None else needs
    is_sure = task.lasts is None and not task.may_need and not task.within
    if is_sure and after == task.after and place == task.at:
        return task
    return replace(task.once_known(place, needs, task.duration), after=after)


def _is_load(world: PhysicalWorld, task: int) -> bool:
    return world.mission.tasks[task].to is not None


def _lifted(world: PhysicalWorld, task: int) -> float:
    """Return when a load is believed to be taken up."""
    work = world.works[task]
    carried = world.carried(task, work.robots)
    return work.expected - carried - world.mission.tasks[task].unload


def _left(world: PhysicalWorld, robot: int, moment: float) -> float:
    """Return what a robot will have left, in units of time that it is believed to walk."""
    own = world.mission.robots[robot]
    return world.left_then(robot, moment) * own.speed / own.expected_speed


def _believed_robot(robot: Robot) -> Robot:
    if robot.breaks is None and robot.delays is None:
        return robot
    return robot.as_expected


def _needs(
    world: PhysicalWorld, there: list[int], unseen: frozenset[int], foresight: str
) -> dict[int, Counts]:
    """Return what tasks are believed to need that may need more than is sure.

    What they really need is known of those that somebody has seen. No more is expected of the
    others than the robots that are there can bring.
    """
    able = total(world.mission.robots[robot].can for robot in there)
    needs: dict[int, Counts] = {}
    for number, task in enumerate(world.mission.tasks):
        if not task.may_need:
            continue
        if number in unseen or number not in world.appeared:
            expected = expected_needs(task, foresight)
            needs[number] = expected if covers(able, expected) else task.needs
        else:
            needs[number] = world.truth.tasks[number].needs
    return needs


def _free(world: PhysicalWorld, robot: int) -> tuple[Place, float, Place]:
    """Return where and when a robot is free, and where it comes from then."""
    body = world.bodies[robot]
    if body.work != NOBODY:
        task, work = body.work, world.works[body.work]
        real = world.truth.tasks[task]
        place = world.place_of(task) if real.to is None or work.part == FORMING else real.to
        return place, world.expected_end(task), place
    if body.is_charging:
        return body.way[0].place, world.events[body.charge].until or world.now, body.came_from
    at, place = world.next_place(robot)
    return place, max(world.now, at), body.came_from
