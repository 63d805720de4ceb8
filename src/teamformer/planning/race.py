"""Searching by the clock: the best plan that several threads have found, and how they end."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_EXCEPTION, ThreadPoolExecutor, wait
from typing import Any, Generic, NamedTuple, TypeVar

Plan = TypeVar("Plan")

LOOK = 0.1
"""Seconds between two looks at whether anybody still waits."""

FEWEST_ROUNDS, SECONDS_AT_ONCE = 200, 0.05
"""Rounds before the first look at the clock, and seconds between two looks."""


class Judgement(NamedTuple):
    """What is thought of a plan."""

    rank: tuple[float, ...]  # plans are compared by it, the least first
    value: float  # what the curve tells
    bounded: float  # what bounds are of, and infinite if they say nothing of such a plan


class Race(Generic[Plan]):
    """The best plan that any thread has found so far, and when each better one was found.

    Moments are what `time.perf_counter` shows. `is_abandoned` says whether nobody waits for it any
    more.
    """

    def __init__(
        self,
        judge: Callable[[Plan], Judgement],
        first: Plan,
        begun: float,
        deadline: float,
        is_abandoned: Callable[[], bool] = lambda: False,
    ) -> None:
        self.plan, self.bound, self.deadline = first, 0, deadline
        self.judgement = judge(first)
        self.curve: list[tuple[float, Any]] = []
        self._judge, self._begun = judge, begun
        self._is_stopped, self._is_abandoned = False, is_abandoned
        self._lock = threading.Lock()

    def offer(self, plan: Plan) -> None:
        """Take a plan if it is better."""
        judgement = self._judge(plan)
        with self._lock:
            if judgement.rank >= self.judgement.rank:
                return
            if judgement.value != self.judgement.value:
                self.curve.append((time.perf_counter() - self._begun, judgement.value))
            self.plan, self.judgement = plan, judgement

    def raise_bound(self, bound: int) -> None:
        """Note that no plan is better than this."""
        with self._lock:
            self.bound = max(self.bound, bound)

    def stop(self) -> None:
        """Let all searches come to their end."""
        self._is_stopped = True

    def is_stopped(self) -> bool:
        """Say whether somebody has stopped all searches."""
        return self._is_stopped

    @property
    def seconds_left(self) -> float:
        """Return the seconds until the searches are to end."""
        return max(0.0, self.deadline - time.perf_counter())

    @property
    def is_over(self) -> bool:
        """Say whether searches are to end: time is up, somebody stops them, or nothing is better.

        A plan that is as good as the bound is the best.
        """
        is_proven = self.judgement.bounded <= self.bound
        is_stopped = self._is_stopped or self._is_abandoned()
        return is_stopped or is_proven or self.seconds_left == 0.0

    def run(self, jobs: Sequence[Callable[[], Any]], threads: int) -> list[Any]:
        """Run jobs on so many threads, and return what each returns.

        If a job raises an error, the others end too, and the error is raised here. The calling
        thread only waits, so that Ctrl-C reaches it.
        """
        with ThreadPoolExecutor(threads) as pool:
            running = [pool.submit(job) for job in jobs]
            try:
                while not self._is_abandoned():
                    done, left = wait(running, LOOK, FIRST_EXCEPTION)
                    if not left or any(job.exception() for job in done):
                        break
            finally:
                self.stop()
        return [job.result() for job in running]


def search_by_clock(
    search: Callable[[float, int], None],
    rank: Callable[[], tuple[float, ...]],
    deadline: float,
    race: Race[Any],
    offer: Callable[[], None],
    rounds: float,
) -> None:
    """Search until one of three things happens: a deadline, the end of the race, enough rounds.

    `search` makes rounds. It is told how much of the time or of the rounds is over, from 0 to 1,
    and how many rounds to make. `offer` is called whenever the `rank` of its best plan has fallen.
    """
    at_once, least, made = FEWEST_ROUNDS, rank(), 0
    begun = now = time.perf_counter()
    while now < deadline and made < rounds and not race.is_over:
        passed = max((now - begun) / (deadline - begun), made / rounds)
        at_once = int(min(at_once, rounds - made))
        search(passed, at_once)
        made += at_once
        if rank() < least:
            least = rank()
            offer()
        took, now = time.perf_counter() - now, time.perf_counter()
        at_once = max(1, min(2 * at_once, int(at_once * SECONDS_AT_ONCE / max(took, 1e-7))))
