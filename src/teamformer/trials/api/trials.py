"""Missions run, compared, planned and checked. The command line calls the same; nothing prints."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from teamformer.base.errors import MissionError, TeamformerError
from teamformer.methods.by_name import Method, Player, as_method, default_for, load_method
from teamformer.mission.arrivals import with_arrivals
from teamformer.mission.checks.rules import rules_not_run
from teamformer.mission.model import Mission
from teamformer.mission.truth import draw_truth
from teamformer.record.critical_path.stretches import Stretch, path_rows
from teamformer.record.critical_path.words import why_so_late
from teamformer.record.files.reading import read_record
from teamformer.record.files.writing import record_to_tree
from teamformer.record.record import Record
from teamformer.record.referee import judge
from teamformer.record.referee.truth import wrong_truths
from teamformer.record.referee.verdict import Verdict
from teamformer.record.telling.whole import path_of_record
from teamformer.trials.api.arguments import (
    PathOrName,
    known_seconds,
    refuse_no_mission,
    whole_seed,
)
from teamformer.trials.comparison import IN_CONTINUOUS_TIME, IN_STEPS, compare_methods
from teamformer.trials.outputs import write_record
from teamformer.trials.planned import PlannedMission, plan_mission
from teamformer.trials.rows import bars_of, result_row
from teamformer.trials.trial import PlayedTrial, bound_of, run_trial
from teamformer.viewer.html import record_page
from teamformer.viewer.notebook_page import Page


@dataclass(frozen=True, repr=False)
class Trial:
    """The result of running a mission by a method: its record and what follows from it.

    >>> trial = tf.run(tf.setting("4N4T-C4"), seed=0)
    >>> trial.completed, trial.makespan >= trial.lower_bound
    (True, True)
    """

    played: PlayedTrial

    def __repr__(self) -> str:
        mission, end = self.record.mission.name, self.record.end
        return f"<{mission} by {self.record.method}: {end.status} after {end.steps} steps>"

    @property
    def record(self) -> Record:
        """Return the record, step by step (docs/reference/record.md)."""
        return self.played.record

    @property
    def completed(self) -> bool:
        """Say whether all tasks were done."""
        return self.record.end.status == "completed"

    @property
    def makespan(self) -> float | None:
        """Return the step in which the last task was done; None if not all were."""
        return self.record.end.makespan

    @property
    def lower_bound(self) -> float | None:
        """Return a number of steps that no plan can be faster than, None if unknown."""
        return self.record.lower_bound

    @property
    def row(self) -> dict[str, Any]:
        """Return what `teamformer run --json` prints."""
        path = path_rows(self.record.true_mission, self.critical_path)
        return result_row(self.played, bars_of([self.played])) | {"critical_path": path}

    @property
    def critical_path(self) -> tuple[Stretch, ...]:
        """Return the chain that decided when the mission ended: who did what from when to when.

        Its stretches are in order and add up to the makespan. Empty unless all tasks were done.
        """
        return path_of_record(self.record)

    @property
    def why_so_late(self) -> list[str]:
        """Return the critical path in words, line by line, as `teamformer run` prints it.

        >>> print(*tf.run(tf.setting("4N4T-C4")).why_so_late[:1])
        why so late: 15 steps are 13 walking, 2 forming
        """
        return why_so_late(self.record.true_mission, self.critical_path)

    def check(self) -> Verdict:
        """Return the referee's verdict on the record: `.is_legal`, `.findings`."""
        return judge(self.record)

    def show(self, height: int = 620) -> Page:
        """Return the page of the record; a notebook shows it in a frame `height` pixels high."""
        return Page(record_page(record_to_tree(self.record)), height)

    def save(self, folder: PathOrName) -> Path:
        """Write `record.json` and its page `record.html` into a folder; return the folder."""
        into = Path(folder)
        try:
            into.mkdir(parents=True, exist_ok=True)
            write_record(self.record, into)
        except OSError as error:
            hint = "name a folder that files can be written to"
            raise TeamformerError(f"{into}: cannot be written: {error.strerror}", hint) from None
        return into


def run(
    mission: Mission,
    method: str | Player | None = None,
    seed: int = 0,
    seconds: float = 10.0,
    truth: Mission | None = None,
) -> Trial:
    """Run a mission and return the trial.

    `method` is a name (docs/reference/methods.md), a policy or a coordinator. By default it is
    `plan`, or `crews` if the mission is too large for `plan`. `seed` decides what an uncertain
    mission really is, unless `truth` says it: the same mission with what shows itself in it, as
    `trial.record.true_mission` has it. `seconds` is how long a planner such as `central` may
    search. Raises `TeamformerError` for an unknown name, for a mission that cannot be played in
    steps, and for a truth that the mission does not allow.

    >>> trial = tf.run(tf.load("examples/four-robots.yaml"), method="plan")
    >>> trial.makespan
    27
    >>> trial.check().is_legal
    True
    """
    refuse_unplayed(mission, "run")
    if truth is not None:
        _refuse_wrong_truth(mission, truth)
    chosen = _method(default_for(mission) if method is None else method, seconds)
    return Trial(_run_one(mission, chosen, whole_seed(seed), truth))


def compare(
    mission: Mission,
    methods: Sequence[str | Player] | None = None,
    seeds: int = 1,
    seconds: float = 10.0,
) -> list[dict[str, Any]]:
    """Run a mission by several methods and return a row for each trial.

    Without `methods` these are heuristic, join-all, crews, plan and central; in continuous time
    plan and central. Each method runs once with each seed from 0 to `seeds` - 1. A row is what
    `teamformer compare --json` prints: `method`, `seed`, `makespan`, `percent_over_best`,
    `lower_bound` and others. Only the row of a trial that could not be run has an `error`; one that
    came to its step limit has a makespan of None. If no trial could be run, the first error is
    raised. Raises `TeamformerError` for no method and no seed.

    >>> rows = tf.compare(tf.setting("4N4T-C4"), methods=["join-all", "plan"])
    >>> [row["method"] for row in rows]
    ['join-all', 'plan']
    """
    refuse_unplayed(mission, "compare")
    if isinstance(methods, str):
        raise TeamformerError("methods is a text", f"write a list, [{methods!r}]")
    if methods is None:
        methods = IN_STEPS if mission.time == "steps" else IN_CONTINUOUS_TIME
    chosen = [_method(method, seconds) for method in methods]
    compared = compare_methods(mission, chosen, seeds, _run_one)
    if compared.is_interrupted:
        raise KeyboardInterrupt
    return compared.rows()


def plan(mission: Mission, seconds: float = 10.0, method: str = "central") -> PlannedMission | None:
    """Return a plan of who goes where and when; None if none was found.

    The plan has `makespan`, `bound`, `is_proven`, `order`, `coalitions`, `routes` and
    `critical_path`, in the mission's unit of time; in continuous time also `cost` (None without
    one) and `late`, by how much tasks are late. The bound is 0 where none was worked out: for a
    cost, and by `plan` and `reactive`. Its `record` is of the plan carried out.

    `method` is `central`, which searches for `seconds`. In continuous time it can also be `plan`,
    the plan that every robot computes for itself, or `reactive`. Raises `TeamformerError` if tasks
    can never be done because robots are lost.

    >>> made = tf.plan(tf.load("examples/four-robots.yaml"), seconds=1)
    >>> made.bound <= made.makespan <= 27
    True
    >>> len(made.order) == len(made.coalitions) == 4
    True
    """
    refuse_no_mission(mission, "plan")
    return plan_mission(mission, method, known_seconds(seconds))


def check(record: Trial | Record | PathOrName) -> Verdict:
    """Return the referee's verdict on a trial, a record or its file: `.is_legal`, `.findings`.

    >>> folder = tf.run(tf.setting("4N4T-C4")).save("out")
    >>> tf.check(folder / "record.json").is_legal
    True
    """
    if isinstance(record, Trial):
        return record.check()
    return judge(record if isinstance(record, Record) else read_record(Path(record)))


def refuse_unplayed(mission: Mission, verb: str) -> None:
    """Raise `TeamformerError` for what is no mission, or none that can be run."""
    refuse_no_mission(mission, verb)
    if problems := list(rules_not_run(mission)):
        raise MissionError(problems)


def _method(method: str | Player, seconds: float) -> Method:
    limit = known_seconds(seconds)
    return load_method(method, limit) if isinstance(method, str) else as_method(method)


def _refuse_wrong_truth(mission: Mission, truth: Mission) -> None:
    """Raise `TeamformerError` for a truth that a mission does not allow."""
    hint = "take trial.record.true_mission, or draw one from the mission itself"
    if not isinstance(truth, Mission):
        raise TeamformerError(f"the truth is a mission, not {type(truth).__name__}", hint)
    known = truth.tasks[: len(mission.tasks)] if mission.arrivals else truth.tasks
    if [task.name for task in mission.tasks] != [task.name for task in known]:
        raise TeamformerError("the truth has other tasks than the mission", hint)
    if [robot.name for robot in mission.robots] != [robot.name for robot in truth.robots]:
        raise TeamformerError("the truth has other robots than the mission", hint)
    for message in wrong_truths(with_arrivals(mission, truth), truth):
        raise TeamformerError(f"the truth does not fit the mission: {message}", hint)


def _run_one(
    mission: Mission, method: Method, seed: int, truth: Mission | None = None
) -> PlayedTrial:
    truth = draw_truth(mission, seed) if truth is None else truth
    return run_trial(mission, method, seed, bound_of(truth), truth=truth)
