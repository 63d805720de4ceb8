"""An operator who adds a task and is told when it is accepted."""

from __future__ import annotations

from teamformer.fleet.messages import EVERYBODY, Message, Notice, Offer, Receipt, TaskFact

COPIES = 3
"""Robots that must hold a task before it is accepted, never fewer because others seem dead."""

AGAIN = 0.5
"""Seconds between two offers."""


class Operator:
    """Offers one task until enough robots have said that they hold it."""

    def __init__(self, task: TaskFact, robots: int) -> None:
        self.task = task
        self.needed = min(COPIES, robots)
        self.holders: set[int] = set()

    @property
    def is_accepted(self) -> bool:
        """Say whether the task is accepted."""
        return len(self.holders) >= self.needed

    def offer(self) -> Notice:
        """Return what to say, again and again."""
        return Notice(EVERYBODY, Offer(self.task))

    def hear(self, message: Message) -> None:
        """Count a robot that holds the task."""
        if type(message.body) is Receipt and message.body.key == self.task.key:
            self.holders.add(message.sender)
