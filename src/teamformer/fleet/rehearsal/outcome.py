"""How a rehearsal ended."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Outcome:
    """How a rehearsal ended; times in seconds.

    `status` is `ended`; `infeasible` if robots were lost that tasks need, or an accepted task with
    the memory of all who held it, and all others are done; `too late` if a task that must be done
    was not when the mission was over by its `until`; `blocked` if something that can be done
    was not done until the deadline.
    """

    status: str
    makespan: float | None  # when the last task was done that can be
    end: float
    tasks_done: int
    blocked_tasks: tuple[str, ...]
    messages: int
    bytes: int
    received_bytes: int
    robot_seconds: float
    plans: int
    dropped: int  # messages that did not open
