"""Where loads lie and hidden tasks are, as far as a robot can find out."""

from __future__ import annotations

from teamformer.fleet.agent.knowledge import Knowledge
from teamformer.fleet.bodies.body import Report
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.messages import TaskFact
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.roads import Roads


def note_place(knowledge: Knowledge, key: int, report: Report, is_at: bool) -> bool:
    """Note where a task is whose place was not known; say whether that is news.

    `is_at` says that the robot stands where the task was believed to be.
    """
    if key in knowledge.over:
        return False
    if report.load is not None:
        return knowledge.find(key, report.load)
    return is_at and report.is_gone and knowledge.rule_out(key)


def note_load(knowledge: Knowledge, key: int, report: Report, is_sought: bool) -> bool:
    """Note where the load of a task lies by what a body senses; say whether that is news.

    `is_sought` says that the robot stands where the load was believed to lie, and that no robot
    says that it carries the load. If the load is gone, those who carried it on can no longer tell
    where they set it down. So the next place to look is further on its way; after the end of the
    way it is the place where the load was first. On roads it may have come by other movers' ways.
    """
    task = knowledge.tasks[key]
    assert task.to is not None
    if report.carries or key in knowledge.over:
        return False
    if report.load is not None:
        return knowledge.see_load(key, report.load)
    if not (is_sought and report.is_gone):
        return False
    here, mission = knowledge.place_of(key), knowledge.mission
    if isinstance(mission.source.world, Roads):
        places = _places_on_roads(mission, task)
        return knowledge.see_load(key, places[(places.index(here) + 1) % len(places)])
    if here == task.to:
        return knowledge.see_load(key, (task.x, task.y))
    return knowledge.see_load(key, mission.ways.next_place(here, task.to, mission.sight or 1.0))


def _places_on_roads(mission: FleetMission, task: TaskFact) -> list[Place]:
    """Return where to look for a load: on its way by each mover first, then at all other places."""
    world, to = mission.source.world, task.to
    assert isinstance(world, Roads), "the caller has looked"
    assert to is not None, "it is a load"
    at = (task.x, task.y)
    movers = [mover for mover in world.times if world.leads(mover, at, to)]
    found = [at, *(place for it in movers for place, _ in mission.ways.stages(at, to, it))]
    found += [(number, 0) for number in range(len(world.places))]
    return [place for place in dict.fromkeys(found) if mission.can_do_at(task, place)]
