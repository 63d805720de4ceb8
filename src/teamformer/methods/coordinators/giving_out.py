"""The learned method that chooses tasks: a network says what is given out next, and to whom.

Every robot works it out alike from what everybody knows, as with a shared plan, and again whenever
something is done. What was decided before stays unless what is found is better by the method's own
forecast, which counts forming. The result is a plan, so nothing blocks that no plan blocks.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from teamformer.methods.learned.dispatch.forecast import StepForecast
from teamformer.methods.learned.dispatch.giving_out import Scorer, by_chance, give_out_all
from teamformer.methods.learned.dispatch.onnx_scorer import shipped_scorer
from teamformer.mission.coordination import NEWS, Known, Plan
from teamformer.planning.steps.reactive import soonest_plan
from teamformer.planning.steps.shared_plan import kept_plan
from teamformer.planning.steps.situation import Situation, plan_of, situation_of
from teamformer.planning.steps.timed_plan import TimedPlan, must_come_first, time_team_plan

HEAT = 0.04
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

    def of_samples(self, samples: int) -> GivesOutTasks:
        """Return the same that follows the best of so many samples."""
        return GivesOutTasks(self.score, samples)

    def update(self, known: Known, plan: Plan | None) -> Plan:
        """Return who does each task that is possible now, or what is left of the plan before."""
        if not known.possible_tasks:
            return Plan(made_from="nothing")
        situation = situation_of(replace(known, open_tasks=known.possible_tasks))
        old = None
        if plan is not None and plan.order:
            old = time_team_plan(situation, kept_plan(situation, plan))
        best = self._best(situation, old, known.step)
        if best is None:
            return soonest_plan(known)
        made_from = "kept" if best is old else "offers"
        return replace(plan_of(situation, best.plan), made_from=made_from)

    def _best(self, situation: Situation, old: TimedPlan | None, seed: int) -> TimedPlan | None:
        """Return the best plan by the own forecast, the old one if none is better."""
        forecasts = [StepForecast(situation) for _ in range(self.samples)]
        given, rng = [one.given for one in forecasts], np.random.default_rng(seed)
        could = give_out_all(given[:1], self.score).tolist()
        could += give_out_all(given[1:], self.score, by_chance(rng, HEAT)).tolist()
        found = [
            must_come_first(situation, one.timed())
            for one, is_able in zip(forecasts, could, strict=True)
            if is_able
        ]
        found = found if old is None else [old, *found]
        return min(found, key=lambda timed: timed.rank, default=None)


class TeamformerTasks(GivesOutTasks):
    """The best learned method: one network for any fleet, which chooses tasks and who does them."""

    def __init__(self) -> None:
        super().__init__(shipped_scorer())
