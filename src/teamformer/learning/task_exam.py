"""How well a network gives out tasks on held-out missions, by its own forecast, against rules."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from torch import nn

from teamformer.learning.algorithms.deviations import torch_scorer
from teamformer.learning.evaluation import Score
from teamformer.methods.learned.dispatch.forecast import forecast_of
from teamformer.methods.learned.dispatch.giving_out import GivingOut, Scorer, give_out_all
from teamformer.mission.model import Mission
from teamformer.planning.dispatch.futures import empty_calls, play_out


@dataclass(frozen=True)
class TaskExam:
    """Held-out missions, in settings, and the mean makespans of rules on each."""

    settings: Sequence[Sequence[Mission]]
    bars: Mapping[str, tuple[float, ...]]


def prepare_task_exam(settings: Sequence[Sequence[Mission]]) -> TaskExam:
    """Give out the tasks of held-out missions by the rule `soonest`."""
    made = tuple(_mean_makespan(missions, _give_out_soonest)[0] for missions in settings)
    return TaskExam(settings, {"soonest": made})


def examine_tasks(network: nn.Module, exam: TaskExam, device: str = "cpu") -> Score:
    """Give out the tasks of held-out missions greedily."""
    score = torch_scorer(network, device)
    both = [
        _mean_makespan(missions, lambda given: _give_out_scored(given, score))
        for missions in exam.settings
    ]
    return Score(
        steps=tuple(mean for mean, _ in both),
        bars=exam.bars,
        failures=sum(failures for _, failures in both),
        trials=sum(map(len, exam.settings)),
        splits=0.0,
    )


def _mean_makespan(
    missions: Sequence[Mission], give_out: Callable[[list[GivingOut]], Sequence[bool]]
) -> tuple[float, int]:
    """Return the mean makespan of those that could be given out, and how many could not."""
    forecasts = [forecast_of(mission) for mission in missions]
    could = give_out([one.given for one in forecasts])
    done = [one.makespan() for one, is_able in zip(forecasts, could, strict=True) if is_able]
    return float(np.mean(done)), len(missions) - len(done)


def _give_out_scored(given: list[GivingOut], score: Scorer) -> Sequence[bool]:
    able: list[bool] = give_out_all(given, score).tolist()
    return able


def _give_out_soonest(given: list[GivingOut]) -> Sequence[bool]:
    return [
        bool(play_out(one.problem, one.schedule, empty_calls(one.problem, 0), 0)) for one in given
    ]
