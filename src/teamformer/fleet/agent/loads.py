"""Where loads lie and hidden tasks are, as far as a robot can find out."""

from __future__ import annotations

from teamformer.fleet.agent.knowledge import Knowledge
from teamformer.fleet.bodies.body import Report


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
    way it is the place where the load was first.
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
    if here == task.to:
        return knowledge.see_load(key, (task.x, task.y))
    return knowledge.see_load(key, mission.ways.next_place(here, task.to, mission.sight or 1.0))
