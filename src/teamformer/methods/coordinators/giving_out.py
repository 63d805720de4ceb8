"""The learned method that chooses tasks: a network says what is given out next, and to whom.

Every robot works it out alike from what everybody knows, as with a shared plan, and again whenever
something is done. What was decided before stays unless what is found is better by the method's own
forecast, which counts forming. The result is a plan, so nothing blocks that no plan blocks.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from teamformer.methods.learned.dispatch.forecast import StepForecast
from teamformer.methods.learned.dispatch.giving_out import Scorer, give_out_all
from teamformer.methods.learned.dispatch.onnx_scorer import shipped_scorer
from teamformer.mission.coordination import NEWS, Known, Plan
from teamformer.planning.steps.reactive import soonest_plan
from teamformer.planning.steps.shared_plan import kept_plan
from teamformer.planning.steps.situation import plan_of, situation_of
from teamformer.planning.steps.timed_plan import time_team_plan

HEAT = 0.05
"""How much chance there is in a sample, in what a task takes a robot."""


class GivesOutTasks:
    """A learned network gives out the tasks one by one: which is next, and who does it.

    With more than one of `samples` some chance is in all but the first, and the best by the own
    forecast is followed.
    """

    heeds = NEWS
    times = ("steps",)

    def __init__(self, score: Scorer, samples: int = 1) -> None:
        self.score, self.samples = score, samples

    def update(self, known: Known, plan: Plan | None) -> Plan:
        """Return who does each task that is possible now, or what is left of the plan before."""
        if not known.possible_tasks:
            return Plan(made_from="nothing")
        situation = situation_of(replace(known, open_tasks=known.possible_tasks))
        forecasts = [StepForecast(situation) for _ in range(self.samples)]
        given = [one.given for one in forecasts]
        could = give_out_all(given[:1], self.score)
        if self.samples > 1:
            rng = np.random.default_rng(known.step)
            could = np.concatenate([could, give_out_all(given[1:], self.score, rng, HEAT)])
        found = [one.timed() for one, is_able in zip(forecasts, could, strict=True) if is_able]
        old = plan is not None and bool(plan.order)
        if old and plan is not None:
            found.insert(0, time_team_plan(situation, kept_plan(situation, plan)))
        if not found:
            return soonest_plan(known)
        best = min(found, key=lambda timed: timed.rank)
        made_from = "kept" if old and best is found[0] else "offers"
        return replace(plan_of(situation, best.plan), made_from=made_from)


def teamformer_tasks() -> GivesOutTasks:
    """Return the method that comes with the package."""
    return GivesOutTasks(shipped_scorer())
