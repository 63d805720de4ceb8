"""The central solver: the best relaxed schedule it can find in time, and a bound on all others."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, wait
from dataclasses import dataclass
from functools import cache
from typing import Literal

from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.planning.bounds.earliest import earliest_starts
from teamformer.planning.bounds.makespan import bound_makespan
from teamformer.planning.problem.relaxed_problem import (
    Relaxed,
    is_true_relaxation,
    may_set_down,
    relax,
)
from teamformer.planning.relaxation.cp_sat import (
    build_circuits,
    count_arcs,
    latest_makespan,
    make_solver,
    minimise,
)
from teamformer.planning.relaxation.schedule import RelaxedSchedule
from teamformer.planning.relaxation.threshold import HOT, ThresholdSearch
from teamformer.world.rules.constants import FAR

Status = Literal["optimal", "feasible", "infeasible", "unknown"]

FIRST_ROUNDS = 250
"""Rounds of searching, for each task, before anything is to be proven; up to half of the time."""

LARGEST_MODEL = 5000
"""Circuits with more arcs than this prove nothing in minutes, so searching goes on instead."""

SECONDS_TO_BUILD = 5e-5
"""Seconds that an arc may take to be built and presolved; with less time left, none are."""

MOST_AT_ONCE = 2000
"""Rounds times tasks of searching between two looks at the clock; a few hundredths of a second."""

STOP_AGAIN = 0.05
"""Seconds after which it is looked again whether threads are to end, and they are told again."""

EARLY = 0.3
"""Share of the time left for a first cooling down; a second one takes the rest."""


@dataclass(frozen=True)
class RelaxedSolution:
    """What the solver found.

    `value` is the makespan of `schedule`, `bound` what no plan can beat, under the rules either.
    Status: `optimal` if both are the same, `feasible` if not; `infeasible` if robots are lost too
    early for some task; `unknown` if no schedule was found. `curve` holds each improvement as
    (seconds, value).
    """

    schedule: RelaxedSchedule | None
    value: int | None
    bound: int
    status: Status
    seconds: float
    curve: tuple[tuple[float, int], ...]


def solve(
    mission: Mission,
    time_limit: float,
    seed: int = 0,
    workers: int = 2,
    hint: RelaxedSchedule | None = None,
    is_stopped: Callable[[], bool] = lambda: False,
) -> RelaxedSolution:
    """Minimise the makespan if joining is free, for up to `time_limit` seconds.

    Starts from `hint`, if given, and works on up to `workers` threads. A limit of 0 returns
    the first plan. It ends early when `is_stopped` says so. Compiling, once for each installation,
    takes seconds that do not count.
    """
    _compile()
    progress = SolverProgress(relax(mission), time_limit, is_stopped)
    progress.is_bounding = not may_set_down(mission)
    if (earliest_starts(progress.problem) >= FAR).any():
        progress.is_infeasible = progress.is_bounding
        return progress.report()
    search = ThresholdSearch(progress.problem, seed, hint)
    search.run(1)
    progress.offer(search.best)
    if progress.is_bounding:
        progress.raise_bound(bound_makespan(progress.problem))
    if count_arcs(progress.problem) <= LARGEST_MODEL:
        rounds = FIRST_ROUNDS * len(mission.tasks)
        _cool_down(progress, search, rounds, progress.seconds_left / 2)
    if not progress.is_over():
        _search_and_prove(progress, seed, workers)
    return progress.report()


class SolverProgress:
    """What all threads together know so far about one problem."""

    def __init__(
        self,
        problem: Relaxed,
        time_limit: float,
        is_stopped: Callable[[], bool] = lambda: False,
    ) -> None:
        self.problem = problem
        self._is_stopped = is_stopped
        self.best: RelaxedSchedule | None = None
        self.is_exhausted = False  # nothing better is left to be found
        self.is_infeasible = False
        self.is_bounding = True  # what is proven of the relaxed problem holds for all plans
        self.stop_solver: Callable[[], None] = lambda: None
        self.bound = 0
        self._curve: list[tuple[float, int]] = []
        self._started, self._limit = time.perf_counter(), time_limit
        self._lock = threading.Lock()

    @property
    def seconds(self) -> float:
        """Return the seconds since the start."""
        return time.perf_counter() - self._started

    @property
    def seconds_left(self) -> float:
        """Return the seconds until time is up."""
        return max(0.0, self._limit - self.seconds)

    def is_over(self) -> bool:
        """Say whether time is up, somebody stops it, or nothing better is left to be found."""
        return self.seconds_left == 0 or self.is_exhausted or self._is_stopped()

    def offer(self, schedule: RelaxedSchedule | None) -> None:
        """Take a schedule if it is faster than the best."""
        with self._lock:
            if schedule and (self.best is None or schedule.makespan < self.best.makespan):
                self.best = schedule
                self._curve.append((self.seconds, schedule.makespan))
        self.raise_bound(0)

    def raise_bound(self, bound: int) -> None:
        """Note that no plan is faster than this."""
        self.bound = max(self.bound, bound)
        self.is_exhausted |= self.best is not None and self.best.makespan <= self.bound

    def stop(self) -> None:
        """Let all threads come to their end."""
        self.is_exhausted = True
        self.stop_solver()

    def report(self) -> RelaxedSolution:
        """Return where things stand."""
        best, status = self.best, self._status()
        value = best.makespan if best else None
        return RelaxedSolution(best, value, self.bound, status, self.seconds, tuple(self._curve))

    def _status(self) -> Status:
        if self.best is None:
            return "infeasible" if self.is_infeasible else "unknown"
        return "optimal" if self.best.makespan <= self.bound else "feasible"


def _cool_down(
    progress: SolverProgress, search: ThresholdSearch, rounds: float, seconds: float
) -> None:
    """Search once from hot to cool, over so many rounds or seconds, whichever are over first."""
    begin, made = progress.seconds, 0
    at_once = max(1, MOST_AT_ONCE // len(progress.problem.appears))
    while not progress.is_over():
        part = max(made / rounds, (progress.seconds - begin) / seconds)
        if part >= 1:
            break
        cost, heat = search.cost, HOT * (1 - part)
        search.run(at_once, heat, heat)
        made += at_once
        if search.cost < cost:
            progress.offer(search.best)


def _search_on(progress: SolverProgress, seed: int) -> None:
    """Search until time is up."""
    search = ThresholdSearch(progress.problem, seed, progress.best)
    _cool_down(progress, search, math.inf, EARLY * progress.seconds_left)
    if progress.best:
        search.restart(progress.best)
    _cool_down(progress, search, math.inf, progress.seconds_left)


def _search_and_prove(progress: SolverProgress, seed: int, workers: int) -> None:
    """Let the solver work on one thread, if it can get anywhere, and search on all others.

    The main thread only waits, so that Ctrl-C reaches it.
    """
    arcs, workers = count_arcs(progress.problem), max(1, workers)
    proves = arcs <= LARGEST_MODEL and arcs * SECONDS_TO_BUILD < progress.seconds_left
    with ThreadPoolExecutor(workers) as pool:
        work = [pool.submit(_prove, progress, seed)] if proves else []
        while len(work) < workers:
            work.append(pool.submit(_search_on, progress, seed + 1 + len(work)))
        try:
            while wait(work, timeout=STOP_AGAIN).not_done:
                if progress.is_over():
                    progress.stop()
            for done in work:
                done.result()
        finally:
            progress.stop()
            while wait(work, timeout=STOP_AGAIN).not_done:  # one that just begins is deaf
                progress.stop()


def _prove(progress: SolverProgress, seed: int) -> None:
    """Look for a faster schedule with the solver, or show that there is none."""
    problem, best = progress.problem, progress.best
    solver = make_solver(seed)
    progress.stop_solver = solver.stop_search
    horizon = best.makespan - 1 if best else latest_makespan(problem)
    circuits = build_circuits(problem, progress.bound, horizon)
    solver.parameters.max_time_in_seconds = progress.seconds_left
    has_seen_all, bound = minimise(circuits, solver, progress.offer)
    if progress.is_bounding and is_true_relaxation(problem):
        progress.raise_bound(bound)
        progress.is_infeasible = bound > horizon and best is None
    progress.is_exhausted |= has_seen_all


@cache
def _compile() -> None:
    """Compile the kernels, or load what was compiled before, on a smallest problem."""
    robots = tuple(Robot(f"r{r}", (0, 0), {cap: 1}) for r, cap in enumerate("aab"))
    tasks = tuple(Task(f"t{k}", (k, 0), {"a": 1, "b": 1}) for k in range(2))
    problem = relax(Mission("smallest", Grid(2, 1), ("a", "b"), robots, tasks))
    search = ThresholdSearch(problem, seed=0)
    search.run(1)
    if search.best is not None:
        search.restart(search.best)
    bound_makespan(problem)
