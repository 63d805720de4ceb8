"""Engines: where jobs are run - in this process, in several, or on a Ray cluster."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Generator, Iterable, Iterator, Sequence
from contextlib import closing, contextmanager
from typing import Any, Protocol

from teamformer.base.errors import TeamformerError
from teamformer.base.extras import how_to_install
from teamformer.base.worker_processes import work_in_processes
from teamformer.bench.jobs import Job, run_job
from teamformer.bench.rows import Row

AT_HAND = 4
"""Jobs that wait for each worker on a cluster."""

RAY_ADDRESS = "RAY_ADDRESS"
"""The variable by which Ray is told where its cluster is."""


Batches = Generator[list[Row], None, None]


class Engine(Protocol):
    """Runs jobs, in any order, and yields the rows of each when they are there.

    Closing what it returns ends all that still runs.
    """

    def __call__(self, jobs: Sequence[Job], workers: int) -> Batches:
        """Yield the rows of each job."""


def run_here(jobs: Iterable[Job], workers: int = 1) -> Batches:
    """Run one job after the other in this process."""
    yield from map(run_job, jobs)


def run_in_processes(jobs: Sequence[Job], workers: int) -> Batches:
    """Run jobs in processes of one thread each; with one worker, in this one."""
    workers = min(workers, len(jobs))
    if workers <= 1:
        yield from run_here(jobs)
        return
    with _noted_ctrl_c() as pressed:
        results = work_in_processes(run_job, jobs, workers, lambda: pressed)
        with closing(results):
            yield from (rows for _, rows in results)


@contextmanager
def _noted_ctrl_c() -> Iterator[list[int]]:
    """Note Ctrl-C instead of raising wherever the process is; after one, ignore all others.

    An exception in the midst of anything, inside a lock of the pool for example, leaves what nobody
    can clear away, and a second one comes while the first is being cleared away. Yields a list that
    has an entry once Ctrl-C was pressed.
    """
    pressed: list[int] = []
    if threading.current_thread() is not threading.main_thread():
        yield pressed
        return
    before = signal.signal(signal.SIGINT, lambda number, _: pressed.append(number))
    try:
        yield pressed
    finally:
        if not pressed:
            signal.signal(signal.SIGINT, before)


def run_on_ray(jobs: Sequence[Job], workers: int) -> Batches:
    """Run jobs on a Ray cluster: the one at RAY_ADDRESS; if that is `local`, one started here."""
    try:
        import ray
    except ImportError:
        hint = how_to_install("ray")
        raise TeamformerError(f"{RAY_ADDRESS} needs Ray, which is not installed", hint) from None
    is_ours = not ray.is_initialized()
    if is_ours:
        here = {"num_cpus": workers} if os.environ.get(RAY_ADDRESS, "local") == "local" else {}
        ray.init(log_to_driver=False, logging_level="ERROR", include_dashboard=False, **here)
    try:
        yield from _on_cluster(ray, jobs, workers)
    finally:
        if is_ours:
            ray.shutdown()


def _on_cluster(ray: Any, jobs: Sequence[Job], workers: int) -> Batches:
    remote = ray.remote(num_cpus=1)(run_job)
    todo = list(reversed(jobs))
    running: list[Any] = []
    slots = max(workers, int(ray.cluster_resources().get("CPU", 1))) * AT_HAND
    while todo or running:
        while todo and len(running) < slots:
            running.append(remote.remote(todo.pop()))
        finished, running = ray.wait(running)
        yield from ray.get(finished)


def chosen_engine() -> Engine:
    """Return the engine: the Ray cluster at RAY_ADDRESS if that is set, else processes here."""
    return run_on_ray if RAY_ADDRESS in os.environ else run_in_processes
