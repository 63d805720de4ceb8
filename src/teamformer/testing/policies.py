"""What every policy keeps, whoever wrote it."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from teamformer.methods.seam.protocol import Planner, Policy
from teamformer.mission.coordination import Coordinator
from teamformer.mission.model import Mission
from teamformer.testing.missions import usual_missions
from teamformer.trials.trial import run_trial
from teamformer.world.env import Decision, TeamFormation, read_decision
from teamformer.world.view import View

STEPS = 60
"""How long decisions are looked at in each batch of missions."""


def check_policy(make: Callable[[], Policy], missions: Sequence[Mission] = ()) -> None:
    """Check that what `make` returns is a policy; raises `AssertionError` with what it is not.

    It decides for each row of a view, legally, and leaves the view as it is; the same seed gives
    the same record, also where it has played before; and it asks for no more than it says. It is
    given `missions`, or some of each kind.
    """
    missions = missions or usual_missions()
    policy = make()
    for part in ("needs_everything", "begin", "decide"):
        assert hasattr(policy, part), f"a policy has '{part}', and {_name(policy)} has not"
    _check_what_it_needs(policy)
    _check_decisions(policy, missions)
    for mission in missions[:2]:
        first = run_trial(mission, make(), seed=4).record
        again, other = run_trial(mission, make(), seed=4).record, make()
        run_trial(missions[-1], other, seed=2)
        assert first == again, (
            f"the same seed gives the same record, and {_name(policy)} did otherwise the second"
            f" time in {mission.name}; draw from the rng of begin(), and read no clock"
        )
        assert first == run_trial(mission, other, seed=4).record, (
            f"begin() forgets earlier trials, and {_name(policy)} did otherwise in {mission.name}"
            " after another mission"
        )


def _name(policy: Policy) -> str:
    return type(policy).__name__


def _begin(policy: Policy, missions: Sequence[Mission]) -> TeamFormation:
    rng = np.random.default_rng(0)
    coordinators: list[Coordinator | None] = [None] * len(missions)
    if isinstance(policy, Planner):
        policy.plan(missions, missions, rng)
        missions = [plan.mission for plan in policy.plans]
        coordinators = [plan.coordinator for plan in policy.plans]
    else:
        policy.begin(missions if policy.needs_everything else None, rng)
    return TeamFormation(missions, coordinator=coordinators)


def _check_what_it_needs(policy: Policy) -> None:
    """Without missions it begins, or refuses to if it says that it needs them."""
    needs = ""
    try:
        policy.begin(None, np.random.default_rng(0))
    except Exception as error:
        needs = f"{type(error).__name__}: {error}"
    assert policy.needs_everything or not needs, (
        "a policy with needs_everything = False begins without missions, and"
        f" {_name(policy)} raised {needs}"
    )
    assert needs or not policy.needs_everything, (
        "a policy with needs_everything = True refuses to begin without missions, and"
        f" {_name(policy)} did not"
    )


def _check_decisions(policy: Policy, missions: Sequence[Mission]) -> None:
    env = _begin(policy, missions)
    for _ in range(STEPS):
        if not env.is_running.any():
            return
        view = env.view()
        decision = _decision(policy, view)
        env.step(decision)
        illegal = int(env.worlds.count["illegal"].sum())
        assert not illegal, (
            f"a team stays, splits or joins whom it may, and {_name(policy)} decided otherwise"
            f" {illegal} times in step {int(env.worlds.count['steps'].max())}"
        )


def _decision(policy: Policy, view: View) -> Decision:
    """Return what it decides, once that is found to be a decision for the view."""
    before = [array.copy() for array in view]
    decision = policy.decide(view)
    changed = [
        name
        for name, old, new in zip(View._fields, before, view, strict=True)
        if not np.array_equal(old, new)
    ]
    assert not changed, f"a view is only read, and {_name(policy)} changed {', '.join(changed)}"
    assert isinstance(decision, Decision), (
        f"decide() returns a Decision, and {_name(policy)} returned {type(decision).__name__}"
    )
    try:
        read_decision(decision, *view.counts.shape)
    except ValueError as error:
        raise AssertionError(f"a decision has a row for each team: {error}") from None
    assert (np.asarray(decision.wanted) >= 0).all(), (
        f"counts are 0 or more, and {_name(policy)} wants {int(np.min(decision.wanted))}"
    )
    return decision
