"""What every policy keeps, the listed ones and a user's own."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from random_worlds import random_decision, random_world
from teamformer.files.drawn.generate import Spec, generate
from teamformer.methods.by_name import load_method
from teamformer.methods.listings import our_method_names
from teamformer.methods.seam.protocol import Policy
from teamformer.mission.model import Mission
from teamformer.testing import check_policy
from teamformer.trials.trial import run_trials
from teamformer.world.env import Decision, TeamFormation
from teamformer.world.view import View


class Dice:
    """A user's own policy: random, but legal."""

    needs_everything = False

    def begin(self, everything: Sequence[Mission] | None, rng: np.random.Generator) -> None:
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


def worlds(seed: int, count: int) -> list[Mission]:
    rng = np.random.default_rng(seed)
    return [random_world(rng) for _ in range(count)] + [generate(Spec(), rng) for _ in range(2)]


@pytest.mark.parametrize("name", NAMES)
def test_a_policy_keeps_what_all_keep(name: str) -> None:
    check_policy(lambda: load(name), worlds(1, 20))


@pytest.mark.parametrize("name", LISTED)
@pytest.mark.thorough
def test_company_changes_nothing(name: str) -> None:
    """A world beside larger ones, with padding in its views, goes as it does alone."""
    missions = worlds(6, 12)
    together = run_trials(missions, load(name), seed=0)
    assert together == [run_trials([mission], load(name), seed=0)[0] for mission in missions]


@pytest.mark.parametrize("name", LISTED)
def test_every_possible_world_is_finished(name: str) -> None:
    rng = np.random.default_rng(7)
    missions = [random_world(rng, with_losses=False) for _ in range(30)]
    assert {tally.status for tally in run_trials(missions, load(name))} == {"completed"}


@pytest.mark.parametrize("name", [name for name in LISTED if not load(name).needs_everything])
def test_a_row_decides_by_itself(name: str) -> None:
    """Each team decides from its own row, whoever else is asked at the same time."""
    policy = load(name)
    policy.begin(None, np.random.default_rng(0))
    env = TeamFormation(worlds(8, 15))
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
