"""Plans: that they give open tasks to robots that can do them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence, Set
from itertools import pairwise

from teamformer.mission.model import Mission
from teamformer.mission.parts.capabilities import Counts, covers, total
from teamformer.record.record import Record, SharedPlanMade
from teamformer.record.referee.plans.moments import News
from teamformer.record.referee.rules.finding import PlaceSearch
from teamformer.record.referee.rules.teams import gets_there
from teamformer.record.referee.rules.truth import NeedsKnown
from teamformer.record.referee.rules.verdict import Notes


def judge_plans(
    record: Record, knowledge: NeedsKnown, search: PlaceSearch, news: Sequence[News], notes: Notes
) -> None:
    """Check that plans give open tasks to robots that can do them."""
    orders = dict(record.orders)
    for steps, plan in record.plans:
        served = news[steps].served if steps < len(news) else {}
        _check_plan(record, knowledge, steps, plan, orders.get(steps, ()), notes)
        _check_order(record, steps, plan, orders.get(steps, ()), served, notes)
    for steps, scouts in record.scouts:
        _check_scouts(record, knowledge, search, steps, scouts, orders.get(steps, ()), notes)


def _robots_left(mission: Mission, steps: int) -> set[int]:
    return {
        number
        for number, robot in enumerate(mission.robots)
        if not any(
            away.lost <= steps < (steps + 1 if away.back is None else away.back)
            for away in robot.absences
        )
    }


def _check_plan(
    record: Record,
    knowledge: NeedsKnown,
    steps: int,
    plan: SharedPlanMade,
    order: Sequence[int],
    notes: Notes,
) -> None:
    when, left = f"the plan made after {steps} steps", _robots_left(record.true_mission, steps)
    if len(plan.coalitions) != len(order):
        notes.note(f"{when} has {len(plan.coalitions)} coalitions for {len(order)} open tasks")
    for task, coalition in zip(order, plan.coalitions, strict=False):
        name, needs = record.mission.tasks[task].name, knowledge.needs(task, steps)
        if not set(coalition) <= left or not _is_in_order(coalition):
            what = "a robot twice, not in order or one that is lost"
            notes.note(f"{when} has {what} in the coalition of {name}")
        if coalition and not _can_do(record, coalition, task, needs):
            notes.note(f"{when} has a coalition for task {name} that cannot do it")


def _check_order(
    record: Record,
    steps: int,
    plan: SharedPlanMade,
    order: Sequence[int],
    served: Mapping[int, Set[int]],
    notes: Notes,
) -> None:
    """Check that what is served comes first, by who serves it, and what nobody does yet last.

    In between tasks are behind those that they come after.
    """
    when = f"the plan made after {steps} steps"
    rows = dict(zip(order, plan.coalitions, strict=False))
    for task, robots in served.items():
        if set(rows.get(task, robots)) != robots:
            name = record.mission.tasks[task].name
            notes.note(f"{when} has others do task {name} than those who serve it")
    waiting = sorted({task for task, robots in rows.items() if not robots} - served.keys())
    first, last = list(order[: len(served)]), list(order[len(order) - len(waiting) :])
    if first != sorted(served) or last != waiting:
        notes.note(f"{when} does not begin with what is served and end with what has to wait")
    planned = [record.mission.tasks[task] for task in order[: len(order) - len(waiting)]]
    later, before = {wanted.name for wanted in planned}, _all_before(record.mission, steps)
    for wanted in planned:
        later.discard(wanted.name)
        if later & before[wanted.name]:
            notes.note(f"{when} has task {wanted.name} before one that it comes after")


def _all_before(mission: Mission, steps: int) -> dict[str, set[str]]:
    """Return the tasks that come before each, by name, those before these included.

    A task that is called off in one of the first `steps` steps comes before none.
    """
    cancelled = {task.name: task.cancelled for task in mission.tasks}
    called_off = {name for name, step in cancelled.items() if step is not None and step <= steps}
    before = {task.name: set(task.after) - called_off for task in mission.tasks}
    is_longer = True
    while is_longer:
        longer = {name: names.union(*(before[n] for n in names)) for name, names in before.items()}
        is_longer, before = longer != before, longer
    return before


def _is_in_order(numbers: Sequence[int]) -> bool:
    return all(one < other for one, other in pairwise(numbers))


def _check_scouts(
    record: Record,
    knowledge: NeedsKnown,
    search: PlaceSearch,
    steps: int,
    scouts: Sequence[tuple[int, int]],
    order: Sequence[int],
    notes: Notes,
) -> None:
    """Check that robots that are left look, each at an open task that is not all known."""
    when, left = f"the plan made after {steps} steps", _robots_left(record.true_mission, steps)
    robots = [robot for robot, _ in scouts]
    if record.foresight != "scouting" or not scouts:
        notes.note(f"the record has scouts from after {steps} steps, and nobody is one")
    if steps not in dict(record.plans):
        notes.note(f"the record has scouts from after {steps} steps, when no plan was made")
    if not set(robots) <= left or not _is_in_order(robots):
        notes.note(f"{when} has a scout twice, not in order or one that is lost")
    for _, task in scouts:
        is_known = knowledge.is_shown(task, steps) and search.is_found(task, steps)
        if task not in order or is_known:
            name = record.mission.tasks[task].name
            notes.note(f"{when} has somebody look at task {name}, of which all is known")


def _can_do(record: Record, numbers: Iterable[int], task: int, needs: Counts) -> bool:
    world, at = record.true_mission.world, record.true_mission.tasks[task].at
    robots = (record.mission.robots[robot] for robot in numbers)
    near = (robot.can for robot in robots if gets_there(world, robot, at))
    return covers(total(near), needs)
