"""A simulated body that another process holds: commands there, reports back, over the network."""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import Protocol

from msgspec import DecodeError, Struct, ValidationError
from msgspec.msgpack import Decoder, Encoder

from teamformer.fleet.bodies.body import Command, Report

AGAIN = 0.3
"""Seconds until a command is sent once more: it may have been lost."""

SILENCE = 3.0
"""Seconds without a command after which a body stops: it has no mind any more."""


class BodyCommand(Struct, array_like=True):
    """A command on its way to the body of a robot."""

    robot: int
    leg: int
    place: tuple[float, float] | None
    task: int
    team: int
    serve: bool
    charge: bool = False


class Line(Protocol):
    """Carries orders to bodies and reports back."""

    def send_body(self, key: str, data: bytes) -> None:
        """Send an order or a report."""

    def listen_to_body(self, key: str) -> None:
        """Take what is sent under a key from now on."""

    def receive_body(self) -> Sequence[bytes]:
        """Return what has come."""


encode = Encoder().encode
decode_order = Decoder(BodyCommand).decode
Load = tuple[float, float] | None
Needs = tuple[float, ...] | None
decode_report = Decoder(
    tuple[float, float, int, bool, bool, int, bool, Load, bool, bool, bool, Needs, float | None]
).decode


class RemoteBody:
    """The mind's end of the line to a simulated body."""

    def __init__(self, line: Line, robot: int) -> None:
        self._line, self._robot = line, robot
        self._command = Command()
        self._sent = float("-inf")
        self._report: Report | None = None
        line.listen_to_body(f"reports/{robot}")

    def command(self, command: Command) -> None:
        """Send a command, again and again."""
        now = time.monotonic()
        if command != self._command or now - self._sent > AGAIN:
            self._command, self._sent = command, now
            order = BodyCommand(self._robot, *command[:5], command.charge)
            self._line.send_body("orders", encode(order))

    def report(self) -> Report | None:
        """Return the newest report that has come; None before the first."""
        for data in self._line.receive_body():
            self._take(data)
        return self._report

    def _take(self, data: bytes) -> None:
        """Take in a report; an older one is left."""
        try:
            report = Report(*decode_report(data))
        except (DecodeError, ValidationError):
            return
        if self._report is None or report.number >= self._report.number:
            self._report = report

    def close(self) -> None:
        """Stop."""
        self.command(
            self._command._replace(leg=self._command.leg + 1, place=None, serve=False, charge=False)
        )
