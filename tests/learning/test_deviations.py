"""The network that gives out tasks: what is on offer, what is tried, and that it repeats."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from random_coalitions import random_problem
from teamformer.base.array_types import Array
from teamformer.files.drawn.named_settings import world_of
from teamformer.learning.algorithms.deviations import (
    DeviationSettings,
    torch_scorer,
    try_deviations,
)
from teamformer.learning.nets.offers import OfferNetwork, OfferSettings
from teamformer.learning.settings_files import load_settings
from teamformer.learning.task_exam import examine_tasks, prepare_task_exam
from teamformer.learning.task_worlds import task_selection, task_worlds
from teamformer.learning.trainer import make_learner, train
from teamformer.methods.by_name import load_method
from teamformer.methods.learned.dispatch.giving_out import GivingOut, give_out_all
from teamformer.methods.learned.dispatch.offers import FEATURES, OfferFeature
from teamformer.planning.problem.coalition_problem import CoalitionProblem
from teamformer.planning.problem.schedule import schedule_of
from teamformer.trials.trial import run_trial

TINY = replace(load_settings("teamformer-tasks-deviations"), iterations=2, worlds=4, held_out=2)


def by_chance(seed: int) -> torch.nn.Module:
    """Return a network with random weights in its last layer too."""
    torch.manual_seed(seed)
    network = OfferNetwork(OfferSettings(FEATURES, int(OfferFeature.BEGINS)))
    for weights in network.parameters():
        torch.nn.init.normal_(weights, std=0.3)
    return network


def test_an_untrained_network_is_the_rule_soonest() -> None:
    exam = prepare_task_exam(task_selection(2))
    score = examine_tasks(make_learner(TINY).policy, exam)
    assert score.ratios == (1.0,) * 7
    assert score.failures == 0


@pytest.mark.parametrize("seed", range(6))
def test_whatever_is_chosen_is_a_plan_of_able_coalitions(seed: int) -> None:
    given = GivingOut.of(random_problem(seed, tasks=12))
    assert give_out_all([given], torch_scorer(by_chance(seed)))[0]
    plan, problem = given.schedule.plan, given.problem
    assert sorted(plan.order.tolist()) == list(range(12))
    for task in range(12):
        crew = plan.coalition[task, : plan.size[task]]
        assert (problem.counts[crew].sum(axis=0) >= problem.needs[task]).all()
    assert schedule_of(problem, plan).start.tolist() == given.schedule.start.tolist()


def test_capabilities_mean_nothing() -> None:
    problem = random_problem(2, tasks=9, caps=4)
    turned = problem._replace(
        counts=np.ascontiguousarray(problem.counts[:, ::-1]),
        needs=np.ascontiguousarray(problem.needs[:, ::-1]),
        able=np.ascontiguousarray(problem.able[::-1]),
    )

    def features(one: CoalitionProblem) -> Array:
        given = GivingOut.of(one)
        made = given.offer(0)
        return given.dispatcher.offers.features[:made]

    assert np.array_equal(features(problem), features(turned))


def test_the_first_offer_is_what_can_begin_soonest() -> None:
    given = GivingOut.of(random_problem(4, tasks=9))
    made = given.offer(0)
    begins = given.dispatcher.offers.features[:made, OfferFeature.BEGINS]
    assert begins[0] == 0
    assert (np.diff(begins[::2]) >= 0).all()
    assert (begins[1::2] >= begins[::2]).all()  # who is held back is not there sooner


def test_what_is_tried_leaves_no_trace_and_gains_add_up_to_nothing() -> None:
    missions = task_worlds(4, (9,))
    score = torch_scorer(by_chance(1))
    settings = DeviationSettings(share=0.5, random=0.0, largest_gain=1e9)
    seen, tasks = try_deviations(score, missions, settings, np.random.default_rng(0))
    assert tasks == sum(len(mission.tasks) for mission in missions)
    assert torch.allclose(seen.gain.sum(dim=1), torch.zeros(len(seen.gain)), atol=1e-4)
    assert seen.is_offer.gather(1, seen.tried).all()
    again, _ = try_deviations(score, missions, settings, np.random.default_rng(0))
    assert torch.equal(seen.gain, again.gain)
    fewer = replace(settings, share=0.2)
    other, _ = try_deviations(score, missions, fewer, np.random.default_rng(0))
    rows = {row.numpy().tobytes() for row in seen.features}
    assert any(row.numpy().tobytes() in rows for row in other.features)


def test_a_training_goes_on_where_it_stopped_and_its_folder_is_a_method(tmp_path: Path) -> None:
    worlds = task_selection(TINY.held_out)
    whole = train(TINY, tmp_path / "whole", worlds, exports=False)
    train(TINY, tmp_path / "parts", worlds, until=1, exports=False)
    parts = train(TINY, tmp_path / "parts", worlds)
    for one, other in zip(whole.policy.parameters(), parts.policy.parameters(), strict=True):
        assert torch.equal(one, other)
    method = load_method(str(tmp_path / "parts"))
    trial = run_trial(world_of("warehouse", 4000), method)
    assert trial.record.end.status == "completed"
