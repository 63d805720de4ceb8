"""The method that chooses tasks by a network: it ends, and never does worse than it foresees."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from teamformer.base.array_types import Array
from teamformer.files.drawn.named_settings import world_of
from teamformer.methods.coordinators.giving_out import GivesOutTasks
from teamformer.methods.learned.dispatch.offers import OfferFeature
from teamformer.planning.steps.reactive import soonest_plan
from teamformer.trials.trial import run_trial
from teamformer.world.env import TeamFormation


def soonest(features: Array, count: Array) -> Array:
    return -features[..., OfferFeature.BEGINS].astype(np.float64)


def anything(features: Array, count: Array) -> Array:
    return np.sin(1000 * features.sum(axis=2, dtype=np.float64))


def test_who_prefers_what_begins_soonest_plans_as_the_rule_does() -> None:
    known = TeamFormation([world_of("real", 4000)]).known()
    made, rule = GivesOutTasks(soonest).update(known, None), soonest_plan(known)
    assert dict(zip(made.order, made.coalitions, strict=True)).keys() == set(rule.order)
    assert GivesOutTasks(anything, samples=4).update(known, made).order


@pytest.mark.parametrize("setting", ["real-all", "warehouse-lost", "carry", "air-ground"])
def test_it_ends_whatever_the_network_says(setting: str) -> None:
    """A network that says anything at all plans only what robots can do."""
    mission = world_of(setting, 4000)
    trial = run_trial(mission, GivesOutTasks(anything), 0)
    assert trial.record.end.status == "completed"


def test_more_samples_are_no_worse_by_the_own_forecast() -> None:
    from teamformer.planning.steps.shared_plan import kept_plan
    from teamformer.planning.steps.situation import situation_of
    from teamformer.planning.steps.timed_plan import time_team_plan

    known = replace(TeamFormation([world_of("sparse", 4000)]).known(), news=("start",))
    situation = situation_of(known)
    ranks = [
        time_team_plan(
            situation, kept_plan(situation, GivesOutTasks(soonest, n).update(known, None))
        ).rank
        for n in (1, 8)
    ]
    assert ranks[1] <= ranks[0]
