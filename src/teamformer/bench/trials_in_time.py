"""Trials of missions in continuous time, which run one by one."""

from __future__ import annotations

import time
from dataclasses import dataclass

from teamformer.base.errors import TeamformerError
from teamformer.files.drawn.smallest import smallest_mission
from teamformer.methods.by_name import Method
from teamformer.mission.model import Mission
from teamformer.planning.continuous.rules import warm_up
from teamformer.record.record import Record
from teamformer.trials.continuous_trial import coordinator_of
from teamformer.trials.trial import run_trial


@dataclass(frozen=True)
class TrialInTime:
    """A trial's record, and its seconds: of planning by the clock, and of the processor in all."""

    record: Record
    planning_seconds: float
    cpu_seconds: float

    @property
    def plans(self) -> int:
        """Return how many plans were made."""
        return sum(event.kind == "plan" for event in self.record.events)


def play_in_time(mission: Mission, method: Method, seed: int) -> TrialInTime:
    """Run a trial; what an uncertain mission really is is drawn by the seed."""
    warm_up(mission)
    begun = time.process_time()
    trial = run_trial(mission, method, seed)
    return TrialInTime(trial.record, trial.planning_seconds, time.process_time() - begun)


def why_not_in_time(method: Method) -> str:
    """Return why a method cannot run missions in continuous time; empty if it can."""
    try:
        coordinator_of(method, smallest_mission())
    except TeamformerError as error:
        return str(error)
    return ""
