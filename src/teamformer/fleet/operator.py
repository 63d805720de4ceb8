"""An operator who adds a task, or calls one off, and is told when that is accepted."""

from __future__ import annotations

from teamformer.fleet.messages import (
    EVERYBODY,
    CallOff,
    Message,
    Notice,
    Offer,
    Receipt,
    TaskFact,
)

COPIES = 3
"""Robots that must hold a task before it is accepted, never fewer because others seem dead."""

AGAIN = 0.5
"""Seconds between two offers."""


class Operator:
    """Says one thing until enough robots have said that they hold it: a task, or that it is off."""

    def __init__(self, task: TaskFact, robots: int, calls_off: bool = False) -> None:
        self.task, self.calls_off = task, calls_off
        self.needed = min(COPIES, robots)
        self.holders: set[int] = set()

    @property
    def is_accepted(self) -> bool:
        """Say whether what was said is accepted."""
        return len(self.holders) >= self.needed

    def offer(self) -> Notice:
        """Return what to say, again and again."""
        return Notice(EVERYBODY, CallOff(self.task.key) if self.calls_off else Offer(self.task))

    def hear(self, message: Message) -> None:
        """Count a robot that holds what was said."""
        if message.body == Receipt(self.task.key, self.calls_off):
            self.holders.add(message.sender)
