"""Nobody knows of a task before it appears: another future changes nothing until then."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest

from teamformer.mission.rules import ALLOCATIONS
from teamformer.model import Scenario, Task
from teamformer.scenarios.named_settings import world_of
from teamformer.sim.env import Decision, TeamFormation
from teamformer.sim.view import View
from teamformer.trials.methods import METHODS, load_method

MINE = [
    listing.name for listing in METHODS if not load_method(listing.name).policy.needs_everything
]
FITTING = [name for name in MINE if not name.endswith(("-c8", "-c100", "-ppo"))]  # networks once


def with_another_future(scenario: Scenario, kept: int) -> Scenario:
    """Move the late tasks, change what they need, and leave some of them out."""
    known = [task for task in scenario.tasks if task.appears == 0]
    late = [task for task in scenario.tasks if task.appears > 0]
    others: list[Task] = [
        replace(task, at=(9 - task.at[0], 9 - task.at[1]), needs={"c1": 1}) for task in late[:kept]
    ]
    return replace(scenario, tasks=(*known, *others))


def play(scenario: Scenario, policy_name: str, steps: int) -> list[tuple[View, Decision]]:
    """Return what is seen and decided in the first steps."""
    policy = load_method(policy_name).policy
    policy.begin(None, np.random.default_rng(0))
    env = TeamFormation([scenario])
    seen = []
    for _ in range(steps):
        view = View(*(part.copy() for part in env.view()))
        decision = policy.decide(view)
        seen.append((view, decision))
        env.step(decision)
    return seen


def assert_alike(one: tuple[View, Decision], other: tuple[View, Decision]) -> None:
    for name, ours, theirs in zip(View._fields, one[0], other[0], strict=True):
        assert np.array_equal(ours, theirs), name
    assert np.array_equal(one[1].wanted, other[1].wanted)


SETTINGS = ("4N20+20T-C4-tsp", "4N20+20T-C4-nn")
RULES = [*itertools.product(SETTINGS, ALLOCATIONS)]
OF_THE_FIRST = [rule for rule in RULES if rule[0] == SETTINGS[0]]
OF_OTHERS = [
    pytest.param(*rule, marks=pytest.mark.slow) for rule in RULES if rule[0] != SETTINGS[0]
]


@pytest.mark.parametrize(("setting", "allocation"), [*OF_THE_FIRST, *OF_OTHERS])
def test_another_future_changes_nothing_before_it(setting: str, allocation: str) -> None:
    check_another_future("join-fitting", setting, allocation, seeds=1)


@pytest.mark.parametrize("policy", FITTING)
def test_no_policy_knows_of_the_future(policy: str) -> None:
    assert len(FITTING) >= 3
    allocation = "plan" if policy == "plan" else "paper"
    check_another_future(policy, SETTINGS[0], allocation, seeds=1)


@pytest.mark.slow
@pytest.mark.parametrize("policy", FITTING)
@pytest.mark.parametrize(("setting", "allocation"), RULES)
def test_no_policy_knows_of_the_future_under_any_rules(
    policy: str, setting: str, allocation: str
) -> None:
    check_another_future(policy, setting, allocation, seeds=2)


def check_another_future(policy: str, setting: str, allocation: str, seeds: int) -> None:
    for seed in range(seeds):
        scenario = replace(world_of(setting, seed), allocation=allocation)
        appears = scenario.tasks[-1].appears
        steps = appears + 1  # the view after `appears` steps is the first to know
        now = play(scenario, policy, steps)
        for kept in (20, 7):
            then = play(with_another_future(scenario, kept), policy, steps)
            for step in range(appears):
                assert_alike(now[step], then[step])
            with pytest.raises(AssertionError):
                assert_alike(now[appears], then[appears])
