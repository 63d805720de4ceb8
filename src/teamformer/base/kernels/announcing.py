"""Says that compiling begins, or that a call takes long, so that nobody takes the wait for a fault.

It is said where compiling happens, so whatever compiles says so: verbs, scripts and notebooks.
"""

from __future__ import annotations

import functools
import os
import sys
import time
from collections.abc import Callable
from threading import Timer
from typing import ParamSpec, TypeVar

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")

QUIET = "TEAMFORMER_QUIET"
"""The variable of the environment that, if it is set, has nothing said."""

PAUSE = 5.0
"""Seconds without compiling after which what was said is said again."""

LONG = 2.0
"""Seconds after which a call is said to take long."""

PARTS = {
    "planning": "the planner",
    "methods": "the policy",
    "world": "the simulator",
    "learning": "the training",
}
"""By folder of the package, what it is that one has to wait for."""

WAITING = "waiting for another process, which compiles the same ..."


class Announcer:
    """Says what is compiled, each part once while compiling goes on."""

    def __init__(self) -> None:
        self._said: set[str] = set()
        self._ended = 0.0

    def begin(self, module: str, is_kept: bool) -> None:
        """Say that a function of a module is being compiled."""
        folder = module.removeprefix("teamformer.").split(".")[0]
        self.say(_announcement(PARTS.get(folder, "kernels"), is_kept))

    def end(self) -> None:
        """Note that nothing is compiled any more for now."""
        self._ended = _now()

    def say(self, text: str) -> None:
        """Say something on stderr, unless that was said while the same went on."""
        if _now() - self._ended > PAUSE:
            self._said.clear()
        if text not in self._said and sys.stderr is not None and not os.environ.get(QUIET):
            print(text, file=sys.stderr, flush=True)
        self._said.add(text)
        self._ended = _now()


def _announcement(part: str, is_kept: bool) -> str:
    if is_kept:
        return f"compiling {part}, on the first run only (a minute, more if busy) ..."
    return (
        f"compiling {part}, at every run, as there is no folder to keep it in (a minute, more if "
        "busy); set NUMBA_CACHE_DIR to a folder that you may write to ..."
    )


def _now() -> float:
    return time.monotonic()


ANNOUNCER = Announcer()


def says_if_long(function: Callable[Arguments, Result]) -> Callable[Arguments, Result]:
    """Return a function that says on stderr, once a call takes long, that it is at work."""

    @functools.wraps(function)
    def said(*args: Arguments.args, **kwargs: Arguments.kwargs) -> Result:
        text = f"teamformer.{function.__name__} is at work; it takes more than {LONG:g} seconds ..."
        timer = Timer(LONG, ANNOUNCER.say, [text])
        timer.daemon = True
        timer.start()
        try:
            return function(*args, **kwargs)
        finally:
            timer.cancel()

    return said
