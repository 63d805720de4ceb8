"""Processes that work for this one: they end with it, however it ends, and when it says so."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing.connection import wait
from typing import Any


def begin_worker() -> None:
    """End with the parent however it ends, and leave Ctrl-C to it; for each worker's start."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_end_with, args=(parent.sentinel,), daemon=True).start()


@contextmanager
def ending(pool: ProcessPoolExecutor) -> Iterator[None]:
    """Let processes leave by themselves when all is done; end them if it is given up before.

    To end a process that is about to leave by itself would close pipes that are written to.
    """
    try:
        yield
    except BaseException:
        _end_all(pool)
        raise
    pool.shutdown()


def _end_all(pool: ProcessPoolExecutor) -> None:
    """End all processes, whatever they are at."""
    pool.shutdown(wait=False, cancel_futures=True)
    for child in multiprocessing.active_children():
        child.terminate()
    pool.shutdown()


def _end_with(sentinel: Any) -> None:
    wait([sentinel])
    os._exit(1)
