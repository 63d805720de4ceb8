"""When a vehicle is told the same once more, and when that is given up for a while."""

from __future__ import annotations

from collections import Counter

AGAIN = 1.5
"""Seconds until what a vehicle does not show is sent once more."""

UNANSWERED = 8
"""How often a vehicle is told the same and shows nothing of it, until that is given up."""

FAILURES = 3
"""How often a vehicle may fail at the same thing, until that is given up."""

REST = 30.0
"""Seconds for which a vehicle is unfit after it was given up; each time twice as long, until it
has served a task."""

LONGEST_REST = 600.0


class Tries:
    """How often a vehicle was told something in vain; `what` are words such as `drop crate`."""

    def __init__(self) -> None:
        self.rest = REST  # how long the next one is
        self._sent: dict[str, float] = {}
        self._unanswered: Counter[str] = Counter()
        self._failed: Counter[str] = Counter()
        self._until: dict[str, float] = {}  # when the rest is over of what was given up
        self._unheard: set[str] = set()  # what of it the vehicle showed nothing of

    def is_due(self, what: str, now: float) -> bool:
        """Say whether something is to be sent: it never was, or some time ago.

        What the vehicle failed at too often is left for the rest; what it shows nothing of is not.
        """
        is_left = what not in self._unheard and now < self._until.get(what, now)
        return not is_left and now - self._sent.get(what, float("-inf")) > AGAIN

    def send(self, what: str, now: float) -> bool:
        """Note that something is sent; say whether it is now given up."""
        if now >= self._until.get(what, now):
            self._take_up(what)
        self._sent[what] = now
        self._unanswered[what] += 1
        if what in self._unheard:
            self._until[what] = max(self._until[what], now + REST)
        elif self._unanswered[what] >= UNANSWERED:
            self._unheard.add(what)
            self._give_up(what, now)
            return True
        return False

    def answer(self, what: str) -> None:
        """Note that the vehicle shows something of what it was told."""
        self._sent.pop(what, None)
        self._unanswered.pop(what, None)
        if what in self._unheard:
            self._take_up(what)

    def fail(self, what: str, now: float) -> bool:
        """Note that the vehicle has failed at something; say whether it is now given up."""
        self.answer(what)
        self._sent[what] = now
        self._failed[what] += 1
        is_over = self._failed[what] >= FAILURES
        if is_over:
            self._give_up(what, now)
        return is_over

    def succeed(self, what: str) -> None:
        """Note that the vehicle has done something."""
        self.answer(what)
        self._take_up(what)
        self._failed.pop(what, None)

    def recover(self) -> None:
        """Note that the vehicle has served a task: it is fit, and the next rest is a short one."""
        self.rest = REST
        self._until.clear()
        self._unheard.clear()

    def rests(self, now: float) -> bool:
        """Say whether something was given up lately, so that the vehicle is unfit."""
        return any(now < until for until in self._until.values())

    def _give_up(self, what: str, now: float) -> None:
        self._until[what] = now + self.rest
        self.rest = min(2 * self.rest, LONGEST_REST)
        self._failed.pop(what, None)

    def _take_up(self, what: str) -> None:
        """Try again what was given up."""
        if self._until.pop(what, None) is not None:
            self._unanswered.pop(what, None)
        self._unheard.discard(what)
