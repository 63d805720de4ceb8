"""What can go wrong at the boundary: each error says where, what and what to do next."""

from __future__ import annotations

import copyreg
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any


class TeamformerError(Exception):
    """A user's mistake or a broken file; the command line prints it without a traceback.

    `hint` is the next step to take; empty when the message already says it.
    """

    def __init__(self, message: str, hint: str = "") -> None:
        super().__init__(message)
        self.hint = hint
        if hint:
            self.add_note(f"hint: {hint}")  # who calls from Python sees it under the message

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle what it holds, whatever a subclass is made from; else pools of processes hang."""
        made = (type(self), *self.args)
        return copyreg.__newobj__, made, vars(self)  # type: ignore[attr-defined]


@dataclass(frozen=True)
class Problem:
    """One thing wrong with a mission.

    `where` is the path into the mission's tree, such as `("tasks", 3, "needs")`. `line` is where
    that is in the mission's file, None if it comes from none.
    """

    where: tuple[str | int, ...]
    message: str
    line: int | None = field(default=None, compare=False)

    @property
    def path(self) -> str:
        """Return where it is, as `tasks[3].needs`; empty for the mission as a whole."""
        parts = (f"[{key}]" if isinstance(key, int) else f".{key}" for key in self.where)
        return "".join(parts).removeprefix(".")


class MissionError(TeamformerError):
    """A mission that cannot be run; `problems` holds everything wrong with it at once."""

    def __init__(self, problems: Sequence[Problem], lines: Sequence[str] = ()) -> None:
        super().__init__("\n".join(lines or [problem.message for problem in problems]))
        self.problems = tuple(problems)


class UndoableError(TeamformerError):
    """A mission that is as it should be, but that nobody can do in full: no user's mistake."""


class RecordError(TeamformerError):
    """A record file that cannot be read."""


class ReaderGoneError(Exception):
    """Who read our output has left, as `head` does when it has seen enough; no mistake at all."""
