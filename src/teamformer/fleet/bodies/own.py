"""A user's own body: what goes wrong in it is told by file and line, as a user's mistake is."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from teamformer.base.errors import TeamformerError
from teamformer.base.own_code import telling_where
from teamformer.fleet.bodies.body import Command, Report, charge_of

HINT = "see docs/how-to/robots.md for what a body offers"


class OwnBody:
    """A body that somebody else wrote.

    Raises `TeamformerError` for what is no body, where it raises anything, and for a report that is
    none.
    """

    def __init__(self, name: str, make: Callable[[], Any]) -> None:
        self._name = name
        with telling_where(f"--body {name} cannot be made"):
            self._body = make()
        for method in ("command", "report", "close"):
            if not callable(getattr(self._body, method, None)):
                raise TeamformerError(f"--body {name} is no body: it has no '{method}'", HINT)

    def command(self, command: Command) -> None:
        """Take up a command."""
        with telling_where(f"body '{self._name}' failed"):
            self._body.command(command)

    def report(self) -> Report | None:
        """Return what it senses now, in plain numbers."""
        with telling_where(f"body '{self._name}' failed"):
            report = self._body.report()
        if report is None:
            return None
        if not isinstance(report, Report):
            what = f"report() returned {type(report).__name__}, not a Report"
            raise TeamformerError(f"body '{self._name}': {what}", HINT)
        x, y, leg, is_done, is_busy, number, carries, load, is_gone = report[:9]
        is_unfit, has_served, needs, charge = report[9:]
        try:
            return Report(
                *(float(x), float(y), int(leg), bool(is_done), bool(is_busy), int(number)),
                *(bool(carries), load and (float(load[0]), float(load[1])), bool(is_gone)),
                bool(is_unfit),
                bool(has_served),
                None if needs is None else tuple(map(float, needs)),
                None if charge is None else charge_of(float(charge)),
            )
        except (TypeError, ValueError, LookupError) as error:
            raise TeamformerError(f"body '{self._name}': report(): {error}", HINT) from None

    def close(self) -> None:
        """Come to a stop."""
        with telling_where(f"body '{self._name}' failed"):
            self._body.close()
