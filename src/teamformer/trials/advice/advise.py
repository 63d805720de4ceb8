"""What would help most, and who could be spared: every change measured by planning again."""

from __future__ import annotations

import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from contextlib import closing
from itertools import islice
from statistics import median_low

from teamformer.base.errors import TeamformerError
from teamformer.methods.by_name import default_for
from teamformer.methods.listings import DEFAULT
from teamformer.mission.model import Mission
from teamformer.planning.continuous.rules import warm_up
from teamformer.record.critical_path.stretches import Stretch
from teamformer.trials.advice.changes import changes_of
from teamformer.trials.advice.measuring import (
    Found,
    PlannedSearch,
    Progress,
    goes_as_planned,
    searched,
)
from teamformer.trials.advice.suggestions import Advice, Suggestion
from teamformer.trials.noise import Noise

ROUNDS = 7
"""So many times every change is searched if there is time."""

WORTH_PROCESSES = 10.0
"""Seconds of searches from which on processes pay, of which each starts for some seconds."""

OF_THE_MISSION = 3
"""So many times as often the mission itself, which all are compared with."""


def advise_on(
    mission: Mission,
    seconds: float,
    workers: int = 1,
    progress: Progress | None = None,
    clock: Callable[[], float] = time.monotonic,
) -> Advice:
    """Measure all changes of a mission, round by round, for so many seconds at most.

    No search begins that is not expected to end in time, but for the first three of the mission
    itself. Every change is searched once before any is searched again, first those that the
    mission's critical path is about. What is not known of a mission in steps is taken as it is to
    be expected; in continuous time each search draws it. Raises `TeamformerError` for a mission
    that is not completed.
    """
    if mission.time == "continuous":
        warm_up(mission)
    measuring = _Measuring(mission, seconds, clock)
    jobs = measuring.searches()
    _make(measuring, islice(jobs, 1), 1, progress)
    _make(measuring, jobs, workers if measuring.is_long else 1, progress)
    return measuring.advice()


def _make(
    measuring: _Measuring, jobs: Iterator[PlannedSearch], workers: int, progress: Progress | None
) -> None:
    """Make searches and have their results taken."""
    with closing(searched(jobs, workers)) as results:
        for job, found in results:
            measuring.take(job.about, found)
            if progress is not None:
                progress(measuring.made, measuring.seconds_left)


class _Measuring:
    """The changes of a mission, and what searches have found of each, by its number."""

    def __init__(self, mission: Mission, seconds: float, clock: Callable[[], float]) -> None:
        self._mission, self._clock, self._spent = mission, clock, 0.0
        self._begun = clock()
        self._deadline = self._begun + seconds
        self._method = DEFAULT if mission.time == "continuous" else default_for(mission)
        self._changes = list(changes_of(mission))
        self._own = len(self._changes)  # the number of the mission itself
        self._found: defaultdict[int, list[float]] = defaultdict(list)
        self._failed = {n for n, change in enumerate(self._changes) if change.mission is None}
        self._path: tuple[Stretch, ...] = ()  # of the mission as it is written
        self.made = 0
        self._most = ROUNDS * (OF_THE_MISSION + len(self._changes) - len(self._failed))

    @property
    def seconds_left(self) -> float:
        """Return how long this is expected to go on: until time is up, or all is searched."""
        now = self._clock()
        left = (self._most - self.made) * (now - self._begun) / max(1, self.made)
        return max(0.0, min(left, self._deadline - now))

    @property
    def is_long(self) -> bool:
        """Say whether what is left takes so long that starting processes for it pays."""
        return self.seconds_left > WORTH_PROCESSES

    @property
    def _has_time(self) -> bool:
        """Say whether one search more is expected to end in time."""
        return self._clock() + self._spent / max(1, self.made) < self._deadline

    def searches(self) -> Iterator[PlannedSearch]:
        """Yield the searches to make, while there is time; the first of the mission anyway."""
        for turn in range(ROUNDS):
            for order in range(turn * OF_THE_MISSION, (turn + 1) * OF_THE_MISSION):
                if turn and not self._has_time:
                    return
                yield PlannedSearch(
                    self._own, self._mission, self._method, order, with_path=order == 0
                )
            for number in self._promising_first():
                change = self._changes[number]
                if not self._has_time:
                    return
                if change.mission is not None and number not in self._failed:
                    yield PlannedSearch(number, change.mission, self._method, turn)

    def _promising_first(self) -> list[int]:
        """Return the changes, those first that the critical path is about for the longest time."""
        numbers = range(len(self._changes))
        return sorted(numbers, key=lambda number: -self._changes[number].share_of(self._path))

    def take(self, about: int, found: Found) -> None:
        """Take the result of a search. Raises `TeamformerError` if the mission itself has none."""
        self.made += 1
        self._spent += found.seconds
        self._path = found.path or self._path
        if found.value is not None:
            self._found[about].append(found.value)
            return
        self._failed.add(about)
        if about == self._own:
            is_planned = self._mission.time == "continuous" and goes_as_planned(self._mission)
            verb = f"plan MISSION --method {DEFAULT}" if is_planned else "run MISSION"
            raise TeamformerError(
                f"{self._mission.name}: not all tasks are done by {self._method}, "
                "so there is nothing to compare changes with",
                f"`teamformer {verb}` says why; mend that first",
            )

    def advice(self) -> Advice:
        """Return what was found; of equal gains those come first that are listed first."""
        own = self._found[self._own]
        makespan, changes = median_low(own), list(enumerate(self._changes))
        suggestions = sorted(self._suggestions(makespan, len(own)), key=lambda it: -it.gain)
        return Advice(
            mission=self._mission,
            method=self._method,
            makespan=makespan,
            written=own[0],
            least=min(own),
            most=max(own),
            searches=len(own),
            suggestions=tuple(suggestions),
            impossible=tuple(change for n, change in changes if n in self._failed),
            unmeasured=tuple(
                change for n, change in changes if n not in self._failed and not self._found[n]
            ),
        )

    def _suggestions(self, makespan: float, searches: int) -> Iterator[Suggestion]:
        noise = Noise(self._found.values())
        noises: dict[int, float] = {}
        measured = [n for n in range(self._own) if n not in self._failed and self._found[n]]
        for number in measured:
            change, results = self._changes[number], self._found[number]
            count, with_it = len(results), median_low(results)
            if count not in noises:
                noises[count] = noise.of_gain(count, searches, len(measured))
            if change.mission is not None:
                yield Suggestion(
                    *(change.what, change.kind, with_it, makespan - with_it),
                    *(noises[count], count, change.mission),
                )
