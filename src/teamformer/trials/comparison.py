"""The same mission by several methods: trials, those that came to nothing, and their bars."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from teamformer.base.errors import TeamformerError
from teamformer.methods.by_name import Method
from teamformer.mission.model import Mission
from teamformer.trials.rows import Bars, bars_of, result_row
from teamformer.trials.trial import PlayedTrial

IN_STEPS = ("heuristic", "join-all", "crews", "plan", "central")
IN_CONTINUOUS_TIME = ("plan", "central")
"""What a mission is compared by if nobody says more, by its time."""

RunOne = Callable[[Mission, Method, int], PlayedTrial]
"""Runs a trial of a mission by a method with a seed."""


@dataclass(frozen=True)
class Failure:
    """A trial that came to nothing: of which mission, by which method, and what went wrong."""

    mission: Mission
    method: str
    seed: int
    error: TeamformerError


@dataclass(frozen=True)
class Comparison:
    """What was run, in its order, and the bars of each seed.

    `is_interrupted` says that Ctrl-C was pressed before all was run.
    """

    ran: tuple[PlayedTrial | Failure, ...]
    bars: Mapping[int, Bars]
    is_interrupted: bool = False

    @property
    def trials(self) -> list[PlayedTrial]:
        """Return the trials that came to something."""
        return [trial for trial in self.ran if isinstance(trial, PlayedTrial)]

    @property
    def failures(self) -> list[Failure]:
        """Return the trials that came to nothing."""
        return [trial for trial in self.ran if isinstance(trial, Failure)]

    def rows(self) -> list[dict[str, Any]]:
        """Return a row for each trial; of one that came to nothing, why."""
        return [
            result_row(trial, self.bars[trial.record.seed])
            if isinstance(trial, PlayedTrial)
            else _row_of_failure(trial)
            for trial in self.ran
        ]


def compare_methods(
    mission: Mission, methods: Sequence[Method], seeds: int, run_one: RunOne
) -> Comparison:
    """Run every method with the seeds from 0 on; Ctrl-C ends it with what was done so far.

    What goes wrong in one trial does not cost what the others have done. Raises the first error
    if all trials come to nothing, KeyboardInterrupt if it is interrupted before any has ended, and
    `TeamformerError` for no method, no seed, or a method that stands twice.
    """
    if not methods:
        raise TeamformerError("no method is named", "name one, such as plan")
    if seeds < 1:
        raise TeamformerError(f"seeds is {seeds}; write a whole number from 1 on")
    names = [method.name for method in methods]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        hint = "name it once; more seeds run it more often"
        raise TeamformerError(f"method '{twice[0]}' is named twice", hint)
    ran: list[PlayedTrial | Failure] = []
    is_interrupted = False
    try:
        for method, seed in ((method, seed) for method in methods for seed in range(seeds)):
            trial = _try(mission, method, seed, run_one)
            ran.append(trial)
            if isinstance(trial, PlayedTrial) and trial.is_interrupted:
                is_interrupted = True
                break
    except KeyboardInterrupt:  # between two trials, say
        if not any(isinstance(trial, PlayedTrial) for trial in ran):
            raise
        is_interrupted = True
    trials = [trial for trial in ran if isinstance(trial, PlayedTrial)]
    if not trials:
        raise next(trial.error for trial in ran if isinstance(trial, Failure))
    bars = _find_bars(trials, mission.has_surprises)
    known = (_knowing(trial, bars) if isinstance(trial, PlayedTrial) else trial for trial in ran)
    return Comparison(tuple(known), bars, is_interrupted)


def _try(mission: Mission, method: Method, seed: int, run_one: RunOne) -> PlayedTrial | Failure:
    try:
        return run_one(mission, method, seed)
    except TeamformerError as error:
        return Failure(mission, method.name, seed, error)


def _find_bars(trials: Sequence[PlayedTrial], is_uncertain: bool) -> dict[int, Bars]:
    """Return the bars of each seed, which are the same for all where nothing is uncertain.

    Else each seed is a mission of its own.
    """
    seeds = dict.fromkeys(trial.record.seed for trial in trials)
    return {
        seed: bars_of([it for it in trials if it.record.seed == seed or not is_uncertain])
        for seed in seeds
    }


def _knowing(trial: PlayedTrial, bars: Mapping[int, Bars]) -> PlayedTrial:
    """Return a trial that knows the bound of its seed."""
    bound = bars[trial.record.seed].bound
    return replace(trial, record=replace(trial.record, lower_bound=bound))


def _row_of_failure(failure: Failure) -> dict[str, Any]:
    return {
        "mission": failure.mission.name,
        "method": failure.method,
        "seed": failure.seed,
        "completed": False,
        "status": "failed",
        "makespan": None,
        "error": str(failure.error),
        "hint": failure.error.hint,
    }
