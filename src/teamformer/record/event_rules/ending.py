"""How a mission in continuous time ended, by the events, and what its record says of that."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from teamformer.mission.checks.costs import cost_of, parts_of_ends
from teamformer.mission.checks.windows import latest_end
from teamformer.mission.parts.capabilities import covers
from teamformer.mission.parts.reach import totals_there
from teamformer.record.event_rules.lengths import is_near
from teamformer.record.event_rules.standing import Standing


def wrong_endings(now: Standing, status: str) -> Iterator[str]:
    """Say what a record says otherwise of its ending than the events, the last of which is over."""
    end, truth = now.record.end, now.truth
    if end.status != status:
        yield f"the record says status {end.status}; its last event says {status}"
    is_over = len(now.over) == len(truth.tasks) and all(map(now.is_home, range(len(now.robots))))
    has_failed = any(not truth.tasks[task].optional for task in now.missed)
    is_over &= not has_failed
    if (status == "too late") != has_failed:
        yield f"the record ends {status}, and {'a' if has_failed else 'no'} task is missed"
    if (status == "completed") != is_over:
        yield f"the record ends {status}, and {'all' if is_over else 'not all'} is over"
    if status == "infeasible" and not set(end.blocked_tasks) & set(_blocked(now)):
        yield "the record ends infeasible, and every task can be done"
    if (
        status == "step limit"
        and now.now < now.mission.step_limit
        and not is_near(now.now, now.mission.step_limit)
    ):
        yield f"the record ends at {now.now:g}, and its limit is {now.mission.step_limit:g}"
    ends = {task: now.over[task] for task in sorted(now.done)}
    makespan = now.now if status == "completed" else None
    cost = None
    if truth.cost is not None and makespan is not None:
        off = now.over.keys() - now.done - now.missed
        parts = {
            "makespan": makespan,
            "travel": now.travel,
            **parts_of_ends(truth.tasks, ends, off),
        }
        cost = cost_of(truth.cost, parts)
    late = {truth.tasks[k].name: at - latest_end(truth.tasks[k].between) for k, at in ends.items()}
    facts: dict[str, tuple[Any, Any]] = {
        "makespan": (end.makespan, makespan),
        "tasks_done": (end.tasks_done, len(now.done)),
        "cost": (end.cost, cost),
        "late": (dict(end.late), {name: by for name, by in late.items() if by > 0}),
        "missed": (end.missed, tuple(truth.tasks[task].name for task in sorted(now.missed))),
        "broken_links": (sorted(end.broken_links), sorted(_broken_links(now))),
    }
    if status != "infeasible":
        facts["blocked_tasks"] = (end.blocked_tasks, ())
    for name, (said, found) in facts.items():
        if not _is_same(said, found):
            yield f"the record says {name} {said}; it is {found}"
    bound = now.record.lower_bound
    if (
        bound is not None
        and makespan is not None
        and bound > makespan
        and not is_near(bound, makespan)
    ):
        yield f"the lower bound {bound:g} is above the makespan {makespan:g}"


def _is_same(said: Any, found: Any) -> bool:
    """Say whether two values are the same, numbers but for rounding."""
    if isinstance(said, dict) and isinstance(found, dict):
        return said.keys() == found.keys() and all(_is_same(said[k], found[k]) for k in said)
    if isinstance(said, int | float) and isinstance(found, int | float):
        return is_near(said, found)
    return bool(said == found)


def _blocked(now: Standing) -> list[str]:
    """Return the tasks that the robots which are left, or will be back, cannot do."""
    left = [
        replace(robot, at=now.turns_at(number)[-1].place)
        for number, robot in enumerate(now.truth.robots)
        if not now.robots[number].is_lost or robot.is_due(now.now)
    ]
    have = totals_there(now.truth.world, left)
    return [
        task.name
        for number, task in enumerate(now.truth.tasks)
        if number not in now.over and number not in now.works
        if now.is_quiet or not covers(have(now.place_of(number)), task.needs)
    ]


def _broken_links(now: Standing) -> Iterator[tuple[str, str]]:
    """Yield the links of tasks that are both done whose gap was not kept."""
    number_of = {task.name: number for number, task in enumerate(now.mission.tasks)}
    for number, task in enumerate(now.mission.tasks):
        for name, (least, most) in task.starts.items():
            if not now.done.issuperset((number, number_of[name])):
                continue
            between = now.started[number] - now.started[number_of[name]]
            is_least = between >= least or _is_off(between, least, now.now)
            is_most = between <= most or _is_off(between, most, now.now)
            if not (is_least and is_most):
                yield task.name, name


def _is_off(between: float, gap: float, now: float) -> bool:
    """Say whether a gap is missed only by what sums of times are rounded."""
    return abs(between - gap) <= 1e-9 * max(1.0, now)
