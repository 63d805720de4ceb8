"""Processes that work for this one: they end with it, however it ends, and when it says so."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
import traceback
from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import contextmanager
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import Any, TypeVar

from teamformer.base.errors import TeamformerError

Job = TypeVar("Job")
Result = TypeVar("Result")

ANSWERED = 0.1
"""Seconds after which an interruption is answered at the latest."""


class WorkerDiedError(TeamformerError):
    """A worker process died while it had a job; it was short of memory, or somebody ended it."""


def work_in_processes(
    function: Callable[[Job], Result],
    jobs: Iterable[Job],
    workers: int,
    is_interrupted: Callable[[], object] = lambda: False,
) -> Generator[tuple[int, Result], None, None]:
    """Call a function with each job in processes of their own; yield job numbers and results.

    Results come in the order in which they are done. A job is taken from `jobs` when a process is
    free for it. This process has no threads for it and shares no locks with the workers, so it can
    end them at any moment: when the iterator is closed, when a job raises (the same error is raised
    here), and when `is_interrupted`, which is asked every 0.1 s, says so (`KeyboardInterrupt`).
    Raises `WorkerDiedError` if a worker dies.
    """
    waiting = enumerate(jobs)
    working: dict[Connection, int] = {}
    started: list[BaseProcess] = []
    try:
        with _held_back_ctrl_c():
            pipes = [_start(function, started) for _ in range(workers)]
        for pipe in pipes:
            _give(pipe, waiting, working)
        while working:
            ready = wait(working, ANSWERED)
            if is_interrupted():
                raise KeyboardInterrupt
            done = [_take(pipe, working) for pipe in ready if isinstance(pipe, Connection)]
            for pipe, _, _ in done:
                _give(pipe, waiting, working)
            yield from ((number, result) for _, number, result in done)
        for pipe in pipes:
            pipe.close()  # nothing comes any more: they leave
    except BaseException:
        for process in started:
            process.terminate()
        raise
    finally:
        for process in started:
            process.join()


def _start(function: Callable[[Any], Any], started: list[BaseProcess]) -> Connection:
    """Start a worker; return the pipe to it."""
    context = multiprocessing.get_context("spawn")
    here, there = context.Pipe()
    process = context.Process(target=_work, args=(function, there), daemon=True)
    process.start()
    started.append(process)
    there.close()
    return here


def _give(
    pipe: Connection, waiting: Iterator[tuple[int, Any]], working: dict[Connection, int]
) -> None:
    """Give the next job to a worker, if there is one."""
    for number, job in waiting:
        try:
            pipe.send(job)
        except OSError:
            raise _died() from None
        working[pipe] = number
        return


def _take(pipe: Connection, working: dict[Connection, int]) -> tuple[Connection, int, Any]:
    """Take what a worker has made of its job; return its pipe, the job's number, the result."""
    try:
        result, error = pipe.recv()
    except (EOFError, OSError):
        raise _died() from None
    if error is not None:
        raise error
    return pipe, working.pop(pipe), result


def _died() -> WorkerDiedError:
    hint = "was memory short? run the same again with fewer --workers"
    return WorkerDiedError("a worker process died", hint)


def _work(function: Callable[[Any], Any], pipe: Connection) -> None:
    """Do jobs until the pipe is closed."""
    _end_with_parent()
    while True:
        try:
            job = pipe.recv()
        except EOFError:
            return
        try:
            pipe.send((function(job), None))
        except Exception as error:  # (it is raised again where the result is awaited)
            error.add_note("".join(traceback.format_exception(error)))
            pipe.send((None, error))


def _end_with_parent() -> None:
    """End with the parent however it ends, and leave Ctrl-C to it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_end_after, args=(parent.sentinel,), daemon=True).start()


def _end_after(sentinel: Any) -> None:
    wait([sentinel])
    os._exit(1)


@contextmanager
def _held_back_ctrl_c() -> Iterator[None]:
    """Have Ctrl-C wait; processes that are started meanwhile never hear of it."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
