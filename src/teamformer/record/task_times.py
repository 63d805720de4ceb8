"""When the tasks of a record became known, opened and were over, and which were too late."""

from __future__ import annotations

from teamformer.mission.checks.costs import cost_in_steps, judged_by, weighed
from teamformer.mission.checks.windows import latest_end, window_opens
from teamformer.mission.precedence import tasks_before
from teamformer.record.record import Record
from teamformer.world.rules.constants import NEVER


def done_steps(replay: Record) -> dict[int, int]:
    """Return the step in which each task was done, by number."""
    return {
        task: number for number, step in enumerate(replay.steps, start=1) for task, _ in step.done
    }


def cancelled_steps(replay: Record) -> dict[int, int]:
    """Return the step in which each task was called off that was, by number."""
    made = len(replay.steps)
    due = {
        number: task.cancelled
        for number, task in enumerate(replay.scenario.tasks)
        if task.cancelled is not None and task.cancelled <= made
    }
    done = done_steps(replay) if due else {}
    return {number: step for number, step in due.items() if number not in done}


def over_steps(replay: Record) -> dict[int, int]:
    """Return the step in which each task was done or called off, by number."""
    return done_steps(replay) | cancelled_steps(replay)


def known_steps(replay: Record) -> list[int]:
    """Return how many steps were made when each task became known; NEVER if it did not."""
    return [
        NEVER if task.cancelled is not None and task.cancelled <= task.appears else task.appears
        for task in replay.scenario.tasks
    ]


def opening_steps(replay: Record) -> list[int]:
    """Return how many steps were made when each task could begin, had nobody called it off.

    It is known then, its window has begun, and every task that it comes after is over. NEVER if it
    did not get known, or one of these was not over.
    """
    tasks, over = replay.scenario.tasks, over_steps(replay)
    before = tasks_before(tasks)
    return [
        max([known, window_opens(task), *(over.get(k, NEVER) for k in before.get(number, ()))])
        for number, (task, known) in enumerate(zip(tasks, known_steps(replay), strict=True))
    ]


def cost_of_record(replay: Record) -> float | None:
    """Return what a mission cost; None if it has no cost, or is not over."""
    return cost_in_steps(replay.mission, done_steps(replay), replay.end.makespan)


def judged_value(replay: Record) -> float | None:
    """Return what plans of the mission are judged by, the less the better; None if it is not over.

    It is the cost, the mean of makespan and lateness if there are windows, or the makespan.
    """
    weights, makespan = judged_by(replay.mission), replay.end.makespan
    if weights is None or makespan is None:
        return makespan
    return weighed(replay.mission, weights, done_steps(replay), makespan)


def lateness(replay: Record) -> dict[str, float]:
    """Return by how many steps tasks were done after their window, by name, for those that were."""
    tasks, done = replay.scenario.tasks, done_steps(replay)
    by = {tasks[task].name: step - latest_end(tasks[task].between) for task, step in done.items()}
    return {name: steps for name, steps in by.items() if steps > 0}
