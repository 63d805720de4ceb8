"""Why a robot did what it did: its story, worked out from the record alone."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from teamformer.capabilities import describe, missing, total
from teamformer.export.events import events
from teamformer.export.moments import (
    FORMING,
    IDLE,
    LOST,
    NOBODY,
    SERVING,
    WAITING,
    Moment,
    moments,
)
from teamformer.model import Scenario
from teamformer.sim.replay.record import Replay
from teamformer.sim.replay.task_times import opening_steps


@dataclass(frozen=True)
class Chapter:
    """What a robot did from the end of one step to the end of another, and why."""

    begun: int
    ended: int
    what: str
    why: str


def explain(replay: Replay, robot: int) -> list[Chapter]:
    """Return the story of a robot, a chapter for each thing that it did."""
    seen = list(moments(replay))
    chapters: list[Chapter] = []
    doing: tuple[str, int] | None = None
    begun = 0
    for moment in seen[1:]:
        now = (moment.phase[robot], moment.pursued[robot])
        if now != doing and doing is not None:
            chapters.append(_chapter(replay, seen, robot, begun, moment.step - 1, doing))
            begun = moment.step - 1
        doing = now
    if doing is not None:
        chapters.append(_chapter(replay, seen, robot, begun, seen[-1].step, doing))
    return chapters


def _chapter(
    replay: Replay, seen: list[Moment], robot: int, begun: int, ended: int, doing: tuple[str, int]
) -> Chapter:
    phase, task = doing
    scenario, moment = replay.scenario, seen[begun + 1]
    name = "" if task == NOBODY else scenario.tasks[task].name
    mates = _mates(scenario, moment, robot)
    what = {
        LOST: "lost",
        IDLE: "idle",
        FORMING: f"forms {mates}" if mates else "forms a team",
        SERVING: f"serves {name}",
        WAITING: f"waits at {name}",
    }.get(phase, f"walks to {name}" if name else "walks, while plans are made anew")
    if mates and phase not in (LOST, FORMING):
        what = f"{what}, {mates}"
    return Chapter(begun, ended, what, _why(replay, moment, robot, phase, task))


def _why(replay: Replay, moment: Moment, robot: int, phase: str, task: int) -> str:
    if phase == WAITING:
        return _why_waiting(replay.mission, moment, robot, task)
    if phase == IDLE:
        return _why_idle(replay, moment, robot)
    if phase == SERVING:
        return "its team brings all that the task needs"
    if phase in (LOST, FORMING) or task == NOBODY:
        return ""
    return "; ".join(filter(None, (_why_task(replay, moment, robot, task), _plan(replay, moment))))


def _why_waiting(scenario: Scenario, moment: Moment, robot: int, task: int) -> str:
    mates = _team(moment, robot)
    short = missing(total(scenario.robots[mate].can for mate in mates), scenario.tasks[task].needs)
    if not short:
        return "its team brings all that the task needs"
    coming = [
        scenario.robots[other].name
        for other, goal in enumerate(moment.task)
        if goal == task and other not in mates and set(short) & set(scenario.robots[other].can)
    ]
    who = ", ".join(coming) or "nobody on the way"
    return f"lacks {describe(short)}, which {who} brings"


def _why_idle(replay: Replay, moment: Moment, robot: int) -> str:
    scenario, opens = replay.scenario, opening_steps(replay)
    done = {
        event.task for event in events(replay) if event.kind == "done" and event.step <= moment.step
    }
    is_open = [
        task
        for number, task in enumerate(scenario.tasks)
        if opens[number] < moment.step and number not in done
    ]
    plan = _shared_plan(replay, moment)
    if is_open and plan is not None:
        parts = [robots for task, robots in plan.items() if task not in done]
        if not any(robot in robots for robots in parts):
            return "the plan has nothing left for it"
    can = total(scenario.robots[mate].can for mate in _team(moment, robot))
    useful = [task.name for task in is_open if set(task.needs) & set(can)]
    if not is_open:
        return "no task is open"
    if not useful:
        return "no open task needs what it brings"
    return f"others are to do {', '.join(useful)}"


def _why_task(replay: Replay, moment: Moment, robot: int, task: int) -> str:
    """Return which plan said so: the policy itself, the plan, or the shared order."""
    step = replay.steps[moment.step - 1]
    if moment.team[robot] in step.named:
        return "its policy named the task itself"
    plan = _shared_plan(replay, moment)
    if plan is not None:
        looking = _scouts_of(replay, moment, task).intersection(_team(moment, robot))
        if looking:
            names = ", ".join(replay.scenario.robots[scout].name for scout in sorted(looking))
            return f"the plan has {names} look first what is to be known of it"
        return _in_plan(replay.scenario, plan.get(task, ()))
    orders = [row for row in replay.orders if row[0] < moment.step]
    if orders and task in orders[-1][1]:
        return f"number {orders[-1][1].index(task) + 1} in the order that everybody shares"
    return ""


def _shared_plan(replay: Replay, moment: Moment) -> dict[int, tuple[int, ...]] | None:
    """Return who does which task by the shared plan of a step; None without one.

    Like robots may have exchanged their parts since it was made.
    """
    plans = [row for row in replay.plans if row[0] < moment.step]
    if not plans:
        return None
    made, plan = plans[-1]
    order = [tasks for at, tasks in replay.orders if at <= made][-1]
    played_by = {robot: robot for coalition in plan.coalitions for robot in coalition}
    for step in replay.steps[made : moment.step - 1]:
        for one, other in step.took:
            parts = {robot: part for part, robot in played_by.items()}
            played_by[parts.get(one, one)], played_by[parts.get(other, other)] = other, one
    return {
        task: tuple(played_by[robot] for robot in coalition)
        for task, coalition in zip(order, plan.coalitions, strict=True)
    }


def _scouts_of(replay: Replay, moment: Moment, task: int) -> set[int]:
    """Return who scouts a task by the shared plan of a step, as exchanged since."""
    made = max(at for at, _ in replay.plans if at < moment.step)
    looks = dict(dict(replay.scouts).get(made, ()))
    for step in replay.steps[made : moment.step - 1]:
        for one, other in step.took:
            swapped = {one: looks.pop(other, None), other: looks.pop(one, None)}
            looks |= {robot: at for robot, at in swapped.items() if at is not None}
    return {robot for robot, at in looks.items() if at == task}


def _in_plan(scenario: Scenario, robots: tuple[int, ...]) -> str:
    names = ", ".join(scenario.robots[robot].name for robot in robots)
    together = " together" if len(robots) > 1 else ""
    return f"the plan has {names} do it{together}" if robots else ""


def _plan(replay: Replay, moment: Moment) -> str:
    """Return when the plan that holds was made, and after what, if not at the start."""
    made = max(
        (row[0] for row in (*replay.orders, *replay.plans) if row[0] < moment.step),
        default=0,
    )
    if not made:
        return ""
    causes = [
        event.text(replay.mission)
        for event in events(replay)
        if event.step == made and event.kind in ("appears", "lost", "back", "needs")
    ]
    if any(row[0] == made and "taken over" in row[1].reasons for row in replay.plans):
        causes.append("a longer search was taken over")
    return f"planned anew after step {made}{': ' if causes else ''}{', '.join(causes)}"


def _team(moment: Moment, robot: int) -> list[int]:
    slot = moment.team[robot]
    return [mate for mate, team in enumerate(moment.team) if team == slot and slot != NOBODY]


def _mates(scenario: Scenario, moment: Moment, robot: int) -> str:
    names = [scenario.robots[mate].name for mate in _team(moment, robot) if mate != robot]
    return f"with {', '.join(names)}" if names else ""


def story_lines(replay: Replay, robot: int) -> Iterator[tuple[str, str, str]]:
    """Yield (steps, what, why) of each chapter as texts."""
    for chapter in explain(replay, robot):
        yield f"{chapter.begun + 1}-{chapter.ended}", chapter.what, chapter.why
