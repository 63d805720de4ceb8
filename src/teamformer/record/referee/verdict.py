"""What the referee says of a record."""

from __future__ import annotations

from dataclasses import dataclass, field

MOST_FINDINGS = 200


@dataclass(frozen=True)
class Finding:
    """Something that breaks the rules; step 0 is the start and the record as a whole.

    In continuous time `step` is the moment.
    """

    step: float
    message: str


@dataclass(frozen=True)
class Verdict:
    """All findings by step; a legal record has none.

    `steps` are those that were made, in continuous time the events.
    """

    findings: tuple[Finding, ...]
    steps: int
    tasks_done: int
    cost: float | None = None  # of a mission that has one, if all of it is done
    late: dict[str, float] = field(default_factory=dict)
    """By how much tasks were done after their window, which breaks no rule."""

    @property
    def is_legal(self) -> bool:
        """Say whether nothing was found."""
        return not self.findings


@dataclass
class Notes:
    """Collects findings while a record is judged."""

    step: int = 0
    findings: list[Finding] = field(default_factory=list)

    def note(self, message: str) -> None:
        """Write down what breaks the rules in the step that is being judged."""
        if len(self.findings) < MOST_FINDINGS:
            where = f"step {self.step}: " if self.step else ""
            self.findings.append(Finding(self.step, where + message))
