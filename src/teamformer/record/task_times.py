"""When the tasks of a record became known, opened and were over, and which were too late.

In steps a moment is a number of steps made; in continuous time it is in the mission's unit.
"""

from __future__ import annotations

from teamformer.mission.checks.costs import cost_in_steps, judged_by, weighed
from teamformer.mission.checks.windows import latest_end, window_opens
from teamformer.mission.model import Task
from teamformer.mission.precedence import tasks_before
from teamformer.record.record import Record
from teamformer.world.rules.constants import NEVER


def done_steps(record: Record) -> dict[int, float]:
    """Return the step in which each task was done, or the moment, by number."""
    if record.is_continuous:
        return _first_of(record, "done")
    return {
        task: number for number, step in enumerate(record.steps, start=1) for task, _ in step.done
    }


def cancelled_steps(record: Record) -> dict[int, float]:
    """Return the step in which each task was called off that was, or the moment, by number."""
    if record.is_continuous:
        return _first_of(record, "cancel")
    made = len(record.steps)
    due = {
        number: task.cancelled
        for number, task in enumerate(record.mission.tasks)
        if task.cancelled is not None and task.cancelled <= made
    }
    over = done_steps(record).keys() | missed_tasks(record).keys() if due else set()
    return {number: step for number, step in due.items() if number not in over}


def missed_tasks(record: Record) -> dict[int, tuple[float, str]]:
    """Return when each task was missed that was, and why, by number."""
    if record.is_continuous:
        return {it.task: (it.at, it.why) for it in record.events if it.kind == "missed"}
    steps = enumerate(record.steps, start=1)
    return {task: (number, why) for number, step in steps for task, why in step.missed}


def missed_weight(record: Record) -> float:
    """Return the weights of the optional tasks that were missed, added up."""
    tasks = record.true_mission.tasks
    return sum(tasks[task].weight for task in missed_tasks(record) if tasks[task].optional)


def _first_of(record: Record, kind: str) -> dict[int, float]:
    """Return when events of a kind first happened to each task, by number."""
    return {it.task: it.at for it in reversed(record.events) if it.kind == kind}


def over_steps(record: Record) -> dict[int, float]:
    """Return the step in which each task was done, called off or missed, or the moment."""
    missed = {task: at for task, (at, _) in missed_tasks(record).items()}
    return done_steps(record) | cancelled_steps(record) | missed


def known_steps(record: Record) -> list[float]:
    """Return how many steps were made when each task became known, or the moment; NEVER if not."""
    if record.is_continuous:
        appeared, tasks = _first_of(record, "appear"), enumerate(record.mission.tasks)
        return [appeared.get(number, NEVER if task.appears else 0) for number, task in tasks]
    return [appears_after(task) for task in record.mission.tasks]


def appears_after(task: Task) -> int:
    """Return how many steps are made when a task becomes known; NEVER if it does not."""
    is_called_off = task.cancelled is not None and task.cancelled <= task.appears
    return NEVER if is_called_off else int(task.appears)


def opening_steps(record: Record) -> list[int]:
    """Return how many steps were made when each task could begin, had nobody called it off.

    That is for records in steps. It is known then, its window has begun, and every task that it
    comes after is over. NEVER if it
    did not get known, or one of these was not over.
    """
    tasks, over = record.mission.tasks, over_steps(record)
    before = tasks_before(tasks)
    return [
        int(max([known, window_opens(task), *(over.get(k, NEVER) for k in before.get(number, ()))]))
        for number, (task, known) in enumerate(zip(tasks, known_steps(record), strict=True))
    ]


def cost_of_record(record: Record) -> float | None:
    """Return what a mission cost; None if it has no cost, or is not over."""
    if record.is_continuous:
        return record.end.cost
    off = cancelled_steps(record)
    return cost_in_steps(record.true_mission, done_steps(record), record.end.makespan, off)


def judged_value(record: Record) -> float | None:
    """Return what plans of the mission are judged by, the less the better; None if it is not over.

    It is the cost, the mean of makespan and lateness if there are windows, or the makespan.
    """
    weights, makespan = judged_by(record.true_mission), record.end.makespan
    if record.end.cost is not None:
        return record.end.cost
    if weights is None or makespan is None:
        return makespan
    off = cancelled_steps(record)
    return weighed(record.true_mission, weights, done_steps(record), makespan, off)


def lateness(record: Record) -> dict[str, float]:
    """Return by how much tasks were done after their window, by name, for those that were."""
    if record.is_continuous:
        return dict(record.end.late)
    tasks, done = record.mission.tasks, done_steps(record)
    by = {tasks[task].name: step - latest_end(tasks[task].between) for task, step in done.items()}
    return {name: steps for name, steps in by.items() if steps > 0}
