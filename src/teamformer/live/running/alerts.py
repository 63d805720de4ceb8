"""What an operator should know of a fleet: one list, which pages and the terminal show."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

ALL, END = "all", "end"
"""The keys of alerts that are about all robots, and about the end of the mission."""


class Alert(NamedTuple):
    """Something that is so, or has happened: since when, why, and what to do about it."""

    key: str  # what it is about
    what: str
    why: str
    do: str
    since: float | None = None  # a moment in seconds; None if it is so from when it is found

    @property
    def is_return(self) -> bool:
        """Say whether a robot is there again, rather than something being wrong."""
        return self.key.startswith("back ")

    def text(self) -> str:
        """Return it as a sentence."""
        return f"{self.what}: {self.why}; {self.do}"


def robot_key(robot: int) -> str:
    """Return the key of alerts that a robot is not there, or not fit."""
    return f"robot {robot}"


def back_key(robot: int) -> str:
    """Return the key of alerts that a robot is there again."""
    return f"back {robot}"


class Alerts:
    """The alerts that hold, in the order of their beginnings; no clock: every moment is said.

    A robot that was not there, or not fit, and is again, is an alert of its own until that is
    acknowledged.
    """

    def __init__(self, names: Sequence[str]) -> None:
        self.held: tuple[Alert, ...] = ()
        self.acknowledged: frozenset[str] = frozenset()
        self._names = names

    def find(self, found: Sequence[Alert], now: float) -> tuple[list[Alert], list[Alert]]:
        """Take in what is so now; return the alerts that are new, and those that hold no more.

        Of several alerts of one key the first holds.
        """
        before = {alert.key: alert for alert in self.held}
        first = {alert.key: alert for alert in reversed(found)}
        after = {key: self._since(alert, before.get(key), now) for key, alert in first.items()}
        for alert in self._returns(before, after, now):
            after[alert.key] = alert
        self.held = tuple(sorted(after.values(), key=lambda alert: (alert.since or 0, alert.key)))
        both = after.keys() & before.keys()
        is_same = {key for key in both if after[key].what == before[key].what}
        new = [alert for alert in self.held if alert.key not in is_same]
        self.acknowledged &= is_same
        return new, [alert for key, alert in before.items() if key not in after]

    def acknowledge(self, key: str) -> None:
        """Note that somebody has seen an alert."""
        self.acknowledged |= {alert.key for alert in self.held if alert.key == key}

    def clear(self) -> None:
        """Forget all: the mission is over."""
        self.held, self.acknowledged = (), frozenset()

    def _since(self, alert: Alert, known: Alert | None, now: float) -> Alert:
        """Return an alert with when it began; another one of the same key begins anew."""
        if alert.since is not None:
            return alert
        is_known = known is not None and known.what == alert.what
        return alert._replace(since=known.since if known and is_known else now)

    def _returns(
        self, before: dict[str, Alert], after: dict[str, Alert], now: float
    ) -> list[Alert]:
        """Return the robots that are there again, or were and nobody has acknowledged it."""
        returns = list[Alert]()
        for robot, name in enumerate(self._names):
            gone, back = before.get(robot_key(robot)), before.get(back_key(robot))
            if {robot_key(robot), ALL} & after.keys():
                continue
            if gone is not None:
                why = f"it was not there, or not fit, for {now - (gone.since or now):.0f} s"
                do = "nothing: plans count on it again"
                returns.append(Alert(back_key(robot), f"{name} is back", why, do, now))
            elif back is not None and back.key not in self.acknowledged:
                returns.append(back)
        return returns
