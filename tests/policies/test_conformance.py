"""What every policy keeps, the listed ones and a user's own."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from random_worlds import random_decision, random_world
from small_worlds import two_robots_one_task
from teamformer.model import Scenario
from teamformer.policies.protocol import Planner, Policy
from teamformer.scenarios.generate import Spec, generate
from teamformer.sim.env import Decision, TeamFormation
from teamformer.sim.view import View
from teamformer.trials.listings import our_method_names
from teamformer.trials.methods import load_method
from teamformer.trials.trial import run_trial, run_trials

STEPS = 60


class Dice:
    """A user's own policy: random, but legal."""

    needs_everything = False

    def begin(self, everything: Sequence[Scenario] | None, rng: np.random.Generator) -> None:
        self.rng = rng

    def decide(self, view: View) -> Decision:
        return random_decision(view, self.rng)


LISTED = [
    name
    for name in our_method_names()
    if load_method(name).policy is not None and not name.endswith("-ppo")
]
"""Without those that are others with other weights."""
NAMES = [*LISTED, "test_conformance:Dice"]


def load(name: str) -> Policy:
    policy = load_method(name, time_limit=0.0).policy  # so that no clock decides on plans
    assert policy is not None
    return policy


def worlds(seed: int, count: int) -> list[Scenario]:
    rng = np.random.default_rng(seed)
    return [random_world(rng) for _ in range(count)] + [generate(Spec(), rng) for _ in range(2)]


def begin(policy: Policy, scenarios: Sequence[Scenario], seed: int = 0) -> TeamFormation:
    everything = scenarios if policy.needs_everything else None
    policy.begin(everything, np.random.default_rng(seed))
    if isinstance(policy, Planner):
        missions = [plan.mission for plan in policy.plans]
        return TeamFormation(missions, coordinator=[plan.coordinator for plan in policy.plans])
    return TeamFormation(scenarios)


@pytest.mark.parametrize("name", NAMES)
def test_decisions_have_a_row_for_each_team_and_are_legal(name: str) -> None:
    policy = load(name)
    env = begin(policy, worlds(1, 20))
    for _ in range(STEPS):
        if not env.is_running.any():
            break
        view = env.view()
        decision = policy.decide(view)
        assert decision.wanted.shape == view.counts.shape
        assert np.issubdtype(decision.wanted.dtype, np.integer)
        assert (decision.wanted >= 0).all()
        if decision.task is not None:
            assert decision.task.shape == view.task.shape
        env.step(decision)
        assert not env.worlds.count["illegal"].any()


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.thorough
def test_the_same_seed_gives_the_same_record(name: str) -> None:
    for scenario in worlds(2, 6):
        one, other = (run_trial(scenario, load(name), seed=4).replay for _ in range(2))
        assert one == other


@pytest.mark.parametrize("name", NAMES)
def test_a_policy_can_begin_again(name: str) -> None:
    policy = load(name)
    first = run_trials(worlds(3, 5), policy, seed=1)
    run_trials(worlds(4, 3), policy, seed=2)
    assert run_trials(worlds(3, 5), policy, seed=1) == first


@pytest.mark.parametrize("name", NAMES)
def test_a_view_is_not_written_to(name: str) -> None:
    policy = load(name)
    env = begin(policy, worlds(5, 10))
    for _ in range(10):
        view = env.view()
        before = [array.copy() for array in view]
        decision = policy.decide(view)
        assert all((a == b).all() for a, b in zip(view, before, strict=True))
        env.step(decision)


@pytest.mark.parametrize("name", LISTED)
@pytest.mark.thorough
def test_company_changes_nothing(name: str) -> None:
    """A world beside larger ones, with padding in its views, goes as it does alone."""
    scenarios = worlds(6, 12)
    together = run_trials(scenarios, load(name), seed=0)
    assert together == [run_trials([scenario], load(name), seed=0)[0] for scenario in scenarios]


@pytest.mark.parametrize("name", LISTED)
def test_every_possible_world_is_finished(name: str) -> None:
    rng = np.random.default_rng(7)
    scenarios = [random_world(rng, with_losses=False) for _ in range(30)]
    assert {tally.status for tally in run_trials(scenarios, load(name))} == {"completed"}


@pytest.mark.parametrize("name", NAMES)
def test_a_decentralised_policy_needs_no_scenario(name: str) -> None:
    policy = load(name)
    if policy.needs_everything:
        with pytest.raises(ValueError, match="scenarios"):
            policy.begin(None, np.random.default_rng(0))
        return
    policy.begin(None, np.random.default_rng(0))
    view = TeamFormation([two_robots_one_task()]).view()
    assert policy.decide(view).wanted.shape == (2, 3)


@pytest.mark.parametrize("name", [name for name in LISTED if not load(name).needs_everything])
def test_a_row_decides_by_itself(name: str) -> None:
    """Each team decides from its own row, whoever else is asked at the same time."""
    policy = load(name)
    env = begin(policy, worlds(8, 15))
    for _ in range(8):
        view = env.view()
        together = policy.decide(view).wanted.copy()
        for row in range(len(view.slot)):
            assert policy.decide(only(view, row)).wanted.tolist() == [together[row].tolist()]
        env.step(Decision(together))


def only(view: View, row: int) -> View:
    """Return the view of one team."""
    begin, end = view.first_member[row : row + 2].tolist()
    one = {name: getattr(view, name)[row : row + 1] for name in View._fields}
    one["first_member"] = np.array([0, end - begin], dtype=np.int32)
    one["member"], one["member_counts"] = view.member[begin:end], view.member_counts[begin:end]
    return View(**one)
