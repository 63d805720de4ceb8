"""Whether a plan is due, and can be carried out."""

from __future__ import annotations

from collections.abc import Sequence

from teamformer.mission.coordination import IDLE, TAKEN_OVER
from teamformer.mission.parts.capabilities import describe, missing, total
from teamformer.record.event_rules.lengths import is_near
from teamformer.record.event_rules.names import need
from teamformer.record.event_rules.settling import heard
from teamformer.record.event_rules.standing import Standing
from teamformer.world.continuous.events import Event


def take_plan(now: Standing, event: Event) -> None:
    """Take in a plan."""
    plan = event.plan
    assert plan is not None, "it has been read"
    own = [why for why in plan.reasons if why != TAKEN_OVER]
    known = {*now.news, *([IDLE] if IDLE in plan.reasons else [])}
    need(bool(plan.reasons) and known.issuperset(own), _wrong_reasons(now, own))
    if IDLE not in own:
        need(set(heard(now)) <= set(own), _wrong_reasons(now, own))
    is_foreseen = now.record.method == "central" or not now.record.heeds  # by who plans in advance
    tasks = [row.task for row in plan.tasks]
    need(len(set(tasks)) == len(tasks), "the plan has a task twice")
    for task, robots, end in plan.tasks:
        name = now.names.task(task)
        need(task not in now.over, f"the plan has {name}, which is over")
        need(now.is_open(task) or is_foreseen, f"the plan has {name}, which is not open")
        need(list(robots) == sorted(set(robots)), f"the robots of {name} are not in order")
        for robot in robots:
            it = now.robots[robot]
            need(not it.is_lost, f"the plan has {now.names.robot(robot)} do {name}: it is lost")
        sure = now.mission.tasks[task].needs
        have = total(now.mission.robots[robot].can for robot in robots)
        lacks = missing(have, sure)
        need(not robots or not lacks, f"the plan's team of {name} lacks {describe(lacks)}")
        due = now.now if end is None else end
        need(due >= now.now or is_near(due, now.now), f"the plan expects {name} to end at {due:g}")
    now.go_by(plan)
    now.news = {}
    now.plans += 1


def _wrong_reasons(now: Standing, own: Sequence[str]) -> str:
    said, news = ", ".join(own) or "none", ", ".join(now.news) or "none"
    return f"the plan says as its reason: {said}; the news is: {news}"
