"""Plans drawn by chance: what they gain, how likely they were, and what is learned of them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from teamformer.learning.algorithms.deviations import torch_scorer
from teamformer.learning.algorithms.sampled_plans import (
    SampledPlans,
    SampleSettings,
    _gains,
    _log_probs,
    fit,
    sample_plans,
)
from teamformer.learning.settings_files import load_settings
from teamformer.learning.task_worlds import task_selection, task_worlds
from teamformer.learning.trainer import Learner, make_learner, train
from teamformer.methods.learned.dispatch.giving_out import by_chance
from teamformer.methods.learned.dispatch.offers import MOST_OFFERS, OfferFeature

TINY = replace(
    load_settings("teamformer-tasks"),
    begin_from="",
    iterations=2,
    worlds=3,
    held_out=2,
    samples=SampleSettings(plans=4, heat=0.05),
)


def drawn() -> tuple[Learner, SampledPlans]:
    """Return a fresh network and what it draws of three missions."""
    learner = make_learner(TINY)
    rng = np.random.default_rng(0)
    seen, tasks, _ = sample_plans(
        torch_scorer(learner.policy), task_worlds(3, (5,)), replace(TINY.samples, share=1.0), rng
    )
    assert tasks == 4 * sum(len(mission.tasks) for mission in task_worlds(3, (5,)))
    return learner, seen


def test_a_plan_gains_by_how_much_it_is_cheaper_than_the_mean_of_its_mission() -> None:
    gain, spread = _gains(np.exp([[1.0, 3.0], [5.0, 5.0]]))
    assert spread == pytest.approx(0.5**0.5)  # of 1, -1, 0 and 0
    assert gain.tolist() == pytest.approx([2**0.5, -(2**0.5), 0.0, 0.0])


def test_the_chance_of_an_offer_is_the_exponential_of_its_score_by_the_heat() -> None:
    scores = np.tile([0.0, 0.1 * np.log(3), -np.inf], (20_000, 1))
    features = np.zeros((20_000, 3, 1))
    chosen = by_chance(np.random.default_rng(0), 0.1)([], 0, features, scores)
    assert np.bincount(chosen).tolist() == pytest.approx([5000, 15000], abs=200)


def test_what_was_drawn_is_as_likely_as_the_network_says() -> None:
    learner, seen = drawn()
    rows = torch.arange(len(seen.gain))
    with torch.no_grad():
        log_probs = _log_probs(learner, seen, rows, TINY.samples.heat)
    again = log_probs.gather(1, seen.chosen.unsqueeze(1))[:, 0]
    assert torch.allclose(again, seen.log_prob, atol=1e-4)
    assert seen.is_choice.gather(1, seen.chosen.unsqueeze(1)).all()
    assert seen.is_offer.shape == (len(rows), MOST_OFFERS)
    alike = seen.features[..., OfferFeature.IS_ALIKE] * seen.features[..., OfferFeature.IS_SPARING]
    assert not (seen.is_choice & (alike > 0)).any()  # the same robots are on offer once


def test_offers_of_better_plans_become_likelier() -> None:
    learner, seen = drawn()
    fit(learner, seen, replace(TINY.samples, passes=3), 0.0, torch.Generator().manual_seed(0))
    with torch.no_grad():
        after = _log_probs(learner, seen, torch.arange(len(seen.gain)), TINY.samples.heat)
    grown = after.gather(1, seen.chosen.unsqueeze(1))[:, 0] - seen.log_prob
    assert (grown * seen.gain).mean() > 0


def test_a_training_goes_on_where_it_stopped(tmp_path: Path) -> None:
    worlds = task_selection(TINY.held_out)
    whole = train(TINY, tmp_path / "whole", worlds, exports=False)
    train(TINY, tmp_path / "parts", worlds, until=1, exports=False)
    parts = train(TINY, tmp_path / "parts", worlds, exports=False)
    for one, other in zip(whole.policy.parameters(), parts.policy.parameters(), strict=True):
        assert torch.equal(one, other)
