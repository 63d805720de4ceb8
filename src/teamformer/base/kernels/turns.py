"""Has several processes compile a function once: one does, and the others wait and take it."""

from __future__ import annotations

import contextlib
import fcntl
import os
import time
from collections.abc import Iterator
from pathlib import Path

from teamformer.base.kernels.announcing import ANNOUNCER, WAITING
from teamformer.base.kernels.clock import begin_compiling, end_compiling

PATIENCE = 2.0  # seconds of waiting before it is told
BETWEEN = 0.02  # seconds between two looks

_mine: set[Path] = set()
"""What this process compiles now: a function that calls itself does not wait for itself."""


@contextlib.contextmanager
def turn(path: Path) -> Iterator[None]:
    """Hold the lock of a file that is to be written; wait until no other process holds it.

    The system gives up the lock of a process that ends, however it does. Where there can be no
    lock, nobody waits. Two processes at once do no harm, as files are put in place whole.
    """
    if path in _mine:
        yield
        return
    lock = path.with_name(f"{path.name}.lock")
    with contextlib.ExitStack() as held:
        with contextlib.suppress(OSError):  # a full disk, or a file system without locks
            handle = os.open(lock, os.O_CREAT | os.O_RDWR, 0o644)
            held.callback(os.close, handle)
            _wait_for(handle)
        _mine.add(path)
        held.callback(_mine.discard, path)
        held.callback(lock.unlink, missing_ok=True)
        yield


def _wait_for(handle: int) -> None:
    """Wait for a lock, which is time that goes by with compiling."""
    begun = time.monotonic()
    begin_compiling()
    try:
        while not _has_taken(handle):
            if time.monotonic() - begun > PATIENCE:
                ANNOUNCER.say(WAITING)
            time.sleep(BETWEEN)
    finally:
        end_compiling()


def _has_taken(handle: int) -> bool:
    """Take a lock if it is free."""
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True
