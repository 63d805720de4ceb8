"""Processes that work for another leave when all is done, and are ended when it is given up."""

from __future__ import annotations

import multiprocessing
import os
import signal
import time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing.context import SpawnContext
from multiprocessing.process import BaseProcess

import pytest

from teamformer.trials.worker_processes import begin_worker, ending

SPAWN: SpawnContext = multiprocessing.get_context("spawn")


def working(pool: ProcessPoolExecutor) -> list[BaseProcess]:
    """Have one process of a pool begin, and return it."""
    assert pool.submit(os.getpid).result() != os.getpid()
    return list(pool._processes.values())


def test_who_has_nothing_left_to_do_leaves_by_itself() -> None:
    pool = ProcessPoolExecutor(1, SPAWN, begin_worker)
    with ending(pool):
        processes = working(pool)
    assert [process.exitcode for process in processes] == [0]


def give_up(pool: ProcessPoolExecutor, processes: list[BaseProcess]) -> None:
    """Have a process begin with what takes ten minutes, and press Ctrl-C."""
    with ending(pool):
        processes += working(pool)
        pool.submit(time.sleep, 600)
        raise KeyboardInterrupt


def test_who_is_at_work_is_ended_when_it_is_given_up() -> None:
    processes: list[BaseProcess] = []
    with pytest.raises(KeyboardInterrupt):
        give_up(ProcessPoolExecutor(1, SPAWN, begin_worker), processes)
    for process in processes:
        process.join()
    assert [process.exitcode for process in processes] == [-signal.SIGTERM]
