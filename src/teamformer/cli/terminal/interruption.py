"""What SIGINT (Ctrl-C) and SIGTERM do to a command at work: end it once, but not as it writes."""

from __future__ import annotations

import os
import signal
import sys
from threading import Timer
from types import FrameType, TracebackType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

SIGNALS = (signal.SIGINT, signal.SIGTERM)

AGAIN = 0.1
"""Seconds until a signal is sent again that came where Python lets no error out."""


class Interruption:
    """Have the first SIGINT or SIGTERM in a `with` block raise KeyboardInterrupt, and no other.

    After `hold` the block runs to its end first, so that a result is written whole. A process
    that ignores SIGINT, as a job in the background does, goes on to ignore it. What is raised while
    Python clears an object away gets lost, so it is raised once more.
    """

    def __init__(self) -> None:
        self._is_held = False
        self._has_come = False
        self._waits = False
        self._before: dict[signal.Signals, Any] = {}
        self._tell_lost: Callable[[sys.UnraisableHookArgs], object] = sys.unraisablehook

    def hold(self) -> None:
        """Have an interruption wait for the end of the block from now on."""
        self._is_held = True

    def __enter__(self) -> Interruption:
        for number in SIGNALS:
            before = signal.getsignal(number)
            if before is not signal.SIG_IGN:
                self._before[number] = before
                signal.signal(number, self._come)
        self._tell_lost, sys.unraisablehook = sys.unraisablehook, self._send_again
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, _: TracebackType | None
    ) -> None:
        sys.unraisablehook = self._tell_lost
        for number, before in self._before.items():
            signal.signal(number, before)
        if self._has_come and signal.SIGINT in self._before:  # the process is about to end
            signal.signal(signal.SIGINT, signal.SIG_IGN)
        if self._waits and kind is None:
            raise KeyboardInterrupt

    def _send_again(self, lost: sys.UnraisableHookArgs) -> None:
        """Send a signal again whose KeyboardInterrupt got lost; tell of other lost errors."""
        if not issubclass(lost.exc_type, KeyboardInterrupt):
            self._tell_lost(lost)
            return
        self._has_come = False
        number = signal.SIGINT if signal.SIGINT in self._before else signal.SIGTERM
        Timer(AGAIN, os.kill, (os.getpid(), number)).start()

    def _come(self, number: int, frame: FrameType | None) -> None:
        if self._has_come:
            return
        self._has_come, self._waits = True, self._is_held
        if not self._is_held:
            raise KeyboardInterrupt
