"""Both action spaces mean the same decision, and legality is what the simulator says."""

from __future__ import annotations

import numpy as np
import pytest

from random_worlds import random_decision, random_world
from teamformer.world.env import Decision, TeamFormation
from teamformer.world.multi_agent.action_spaces import (
    action_from_wanted,
    count_actions,
    is_legal_action,
    is_legal_wanted,
    legal_actions,
    sequence_from_wanted,
    wanted_from_action,
    wanted_from_sequence,
)


def test_original_actions_add_or_remove_combinations() -> None:
    counts = np.array([1, 0, 2])
    assert count_actions(3) == 16
    assert wanted_from_action(counts, 0b0000).tolist() == [1, 0, 2]
    assert wanted_from_action(counts, 0b0110).tolist() == [1, 1, 3]
    assert wanted_from_action(counts, 0b1101).tolist() == [0, 0, 1]
    assert action_from_wanted(counts, np.array([0, 0, 1])) == 0b1101
    assert action_from_wanted(counts, np.array([1, 2, 2])) is None  # two of one at once
    assert action_from_wanted(counts, np.array([0, 1, 2])) is None  # less of one, more of another


def test_every_original_action_comes_back() -> None:
    counts = np.array([1, 1, 2, 3])
    for action in range(count_actions(4)):
        back = action_from_wanted(counts, wanted_from_action(counts, action))
        assert back == (0 if action == 0b10000 else action)  # removing nothing is to maintain


def test_the_scalable_space_spells_counts() -> None:
    assert wanted_from_sequence([2, 0, 2, 3], caps=3).tolist() == [1, 0, 2]
    assert sequence_from_wanted(np.array([1, 0, 2])) == [0, 2, 2, 3]
    with pytest.raises(ValueError, match="does not end"):
        wanted_from_sequence([0, 1], caps=3)
    with pytest.raises(ValueError, match="symbol 4"):
        wanted_from_sequence([4], caps=3)


@pytest.mark.parametrize("caps", [0, 17, 100])
def test_spaces_that_cannot_be_listed_are_refused(caps: int) -> None:
    with pytest.raises(ValueError, match="use 1 to 16"):
        count_actions(caps)
    with pytest.raises(ValueError, match="use 1 to 16"):
        action_from_wanted(np.zeros(caps), np.zeros(caps))


def test_legality_is_what_the_simulator_counts() -> None:
    rng = np.random.default_rng(2)
    checked = {True: 0, False: 0}
    for _ in range(150):
        env = TeamFormation([random_world(rng)])
        for _ in range(15):
            view = env.view()
            if not len(view.slot):  # it is over, or all robots are away
                break
            wanted = random_decision(view, rng, eagerness=0.6).wanted
            row = int(rng.integers(len(wanted)))
            if rng.random() < 0.5:
                wanted[row] = rng.integers(0, 4, size=wanted.shape[1])
            expected = is_legal_wanted(view, row, wanted[row])
            before = env.tally().illegal_decisions
            env.step(Decision(wanted))
            assert (env.tally().illegal_decisions == before) == expected
            checked[expected] += 1
    assert min(checked.values()) > 300


def test_original_actions_are_legal_where_the_simulator_says_so() -> None:
    rng = np.random.default_rng(3)
    checked = {True: 0, False: 0}
    for _ in range(150):
        env = TeamFormation([random_world(rng)])
        for _ in range(15):
            view = env.view()
            if not len(view.slot):  # it is over, or all robots are away
                break
            wanted = random_decision(view, rng, eagerness=0.6).wanted
            row = int(rng.integers(len(wanted)))
            mask = legal_actions(view, row)
            is_asked = mask if mask.all() or rng.random() < 0.5 else ~mask
            action = int(rng.choice(np.flatnonzero(is_asked)))
            wanted[row] = wanted_from_action(view.counts[row], action)
            before = env.tally().illegal_decisions
            env.step(Decision(wanted))
            assert (env.tally().illegal_decisions == before) == mask[action]
            checked[bool(mask[action])] += 1
    assert min(checked.values()) > 300


def test_the_mask_lists_every_legal_original_action() -> None:
    rng = np.random.default_rng(4)
    legal = {"join": 0, "split": 0}
    for _ in range(60):
        env = TeamFormation([random_world(rng)])
        for _ in range(4):
            view = env.view()
            for row in range(len(view.slot)):
                mask = legal_actions(view, row).tolist()
                assert mask == [is_legal_action(view, row, a) for a in range(len(mask))]
                half = len(mask) // 2
                legal["join"] += sum(mask[1:half])
                legal["split"] += sum(mask[half + 1 :])
            env.step(random_decision(view, rng, eagerness=0.6))
    assert min(legal.values()) > 50
