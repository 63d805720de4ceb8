"""Choices and relations: always legal, and blind to how capabilities are named and padded."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from random_worlds import random_world
from teamformer.methods.learned.feature_layout import OwnRelation as Own
from teamformer.methods.learned.feature_layout import TaskRelation as Ahead
from teamformer.methods.learned.feature_layout import TeamRelation as Team
from teamformer.methods.learned.macro_actions import (
    CHOICES,
    FOLLOW,
    HALVE,
    JOIN,
    MAINTAIN,
    SHED,
    SPLIT,
    legal_choices,
    scripted_counts,
    wanted_counts,
)
from teamformer.methods.learned.relational_features import relate
from teamformer.methods.scripted.join_fitting import JoinFitting
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.world.env import Decision, TeamFormation
from teamformer.world.view import View


def legal_in(view: View) -> np.ndarray:
    """Return the legal choices, as (teams, CHOICES)."""
    return legal_choices(view, scripted_counts(view))


def random_choices(is_legal: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Return a random legal choice for each team."""
    return np.where(is_legal, rng.random(is_legal.shape), -1.0).argmax(axis=1)


def team_and_robot() -> Mission:
    """Four robots with {a}, {a}, {b}, {b} as one team, a fifth with {a} beside them.

    In order: task 0 needs a, task 1 needs a and b.
    """
    cans = [{"a": 1}, {"a": 1}, {"b": 1}, {"b": 1}, {"a": 1}]
    return Mission(
        "team and robot",
        Grid(8, 1),
        ("a", "b"),
        tuple(Robot(f"r{r}", (0, 0), can) for r, can in enumerate(cans)),
        (Task("t0", (2, 0), {"a": 1}), Task("t1", (5, 0), {"a": 1, "b": 1})),
        teams=((0, 1, 2, 3),),
    )


def test_choices_of_a_team_by_hand() -> None:
    view = TeamFormation([team_and_robot()]).view()
    is_legal = legal_in(view)
    assert np.flatnonzero(is_legal[0]).tolist() == [FOLLOW, HALVE, SHED, JOIN, SPLIT, SPLIT + 1]
    assert np.flatnonzero(is_legal[1]).tolist() == [FOLLOW, JOIN]  # a third a would be wasted
    expected = {
        FOLLOW: [2, 2],
        MAINTAIN: [2, 2],
        HALVE: [1, 1],
        SHED: [1, 1],
        JOIN: [3, 2],
        SPLIT: [1, 0],
        SPLIT + 1: [1, 1],
    }
    for choice, counts in expected.items():
        wanted = wanted_counts(view, np.array([choice, MAINTAIN]))
        assert wanted.tolist() == [counts, [1, 0]]
    assert wanted_counts(view, np.array([FOLLOW, FOLLOW])).tolist() == [[2, 2], [1, 0]]


def test_relations_of_a_team_by_hand() -> None:
    relations = relate(TeamFormation([team_and_robot()]).view())
    team, robot = relations.tasks[0], relations.tasks[1]
    assert team[0, Ahead.COVERED] == 1.0
    assert team[1, Ahead.COVERED] == 1.0
    assert team[0, Ahead.SURPLUS] == pytest.approx(3 / 4)  # of four counts, t0 has no use for three
    assert robot[1, Ahead.COVERED] == 0.5
    assert robot[1, Ahead.IS_COVERED] == 0.0
    assert team[0, Ahead.DISTANCE] == pytest.approx(2 / 20)
    assert team[0, Ahead.NEARNESS] == 0.5
    assert relations.teams[1, 0, Team.DOES_ITS_OWN] == 0.0 or (
        relations.teams[1, 0, Team.IS_COMPLETED_BY_ME] == 0.0
    )
    assert relations.own[0, Own.SIZE] == 4 / 16
    assert relations.own[1, Own.IS_ALONE] == 1.0
    assert (
        relations.own[0, Own.REST_AFTER_HALVING] == 1.0
    )  # who would go on halving could do both tasks


@pytest.mark.parametrize("seed", range(4))
def test_no_choice_is_ever_illegal(seed: int) -> None:
    rng = np.random.default_rng(seed)
    env = TeamFormation([random_world(rng) for _ in range(60)])
    made = np.zeros(CHOICES, dtype=np.int64)
    for _ in range(40):
        view = env.view()
        choice = random_choices(legal_in(view), rng)
        made += np.bincount(choice, minlength=CHOICES)
        env.step(Decision(wanted_counts(view, choice)))
    assert env.worlds.count["illegal"].sum() == 0
    assert (made[[FOLLOW, MAINTAIN, HALVE, SHED, JOIN, SPLIT]] > 0).all()


def test_every_split_that_is_legal_is_made() -> None:
    rng = np.random.default_rng(5)
    env = TeamFormation([random_world(rng, with_losses=False) for _ in range(100)])
    for _ in range(20):
        view = env.view()
        is_legal = legal_in(view)
        is_legal[:, JOIN:SPLIT] = False
        is_legal[:, FOLLOW], is_legal[:, MAINTAIN] = False, True
        choice = random_choices(is_legal, rng)
        splits = env.worlds.count["splits"].copy()
        env.step(Decision(wanted_counts(view, choice)))
        wanted = np.bincount(view.world[choice > MAINTAIN], minlength=100)
        assert (env.worlds.count["splits"] - splits == wanted).all()


def test_following_is_the_script_and_nothing_else_is() -> None:
    rng = np.random.default_rng(6)
    env = TeamFormation([random_world(rng) for _ in range(100)])
    joins = 0
    for _ in range(20):
        view = env.view()
        wanted = JoinFitting().decide(view).wanted
        rows = len(wanted)
        assert (wanted_counts(view, np.full(rows, FOLLOW)) == wanted).all()
        is_legal = legal_in(view)
        for choice in range(MAINTAIN, CHOICES):
            others = is_legal[:, choice]
            counts = wanted_counts(view, np.where(others, choice, FOLLOW))
            assert (counts[others] != wanted[others]).any(axis=1).all()
        joins += int((wanted != view.counts).any(axis=1).sum())
        env.step(Decision(wanted))
    assert joins > 20


def relabelled(mission: Mission, rng: np.random.Generator, padding: int = 3) -> Mission:
    """Return the same world with its capabilities in another order, among others nobody has."""
    names = [*mission.capabilities, *(f"unused{i}" for i in range(padding))]
    order = [names[i] for i in rng.permutation(len(names))]
    return replace(mission, capabilities=tuple(order))


def test_names_and_number_of_capabilities_mean_nothing() -> None:
    rng = np.random.default_rng(7)
    worlds = [random_world(rng) for _ in range(60)]
    one, other = TeamFormation(worlds), TeamFormation([relabelled(w, rng) for w in worlds])
    for _ in range(15):
        view = one.view()
        relations, twin = relate(view), relate(other.view())
        for part, twin_part in zip(relations, twin, strict=True):
            assert (part == twin_part).all()
        choice = random_choices(relations.is_legal, rng)
        one.step(Decision(wanted_counts(view, choice)))
        other.step(Decision(wanted_counts(other.view(), choice)))


def test_other_worlds_in_a_batch_mean_nothing() -> None:
    rng = np.random.default_rng(8)
    worlds = [random_world(rng) for _ in range(12)]
    together = relate(TeamFormation(worlds).view())
    rows = 0
    for world in worlds:
        alone = relate(TeamFormation([world]).view())
        for part, part_alone in zip(together, alone, strict=True):
            assert (part[rows : rows + len(alone.own)] == part_alone).all()
        rows += len(alone.own)


def test_padding_is_zero_and_values_are_tame() -> None:
    rng = np.random.default_rng(9)
    env = TeamFormation([random_world(rng) for _ in range(100)])
    for _ in range(10):
        view = env.view()
        relations = relate(view)
        assert (relations.teams[~relations.is_team] == 0).all()
        assert (relations.tasks[~relations.is_task] == 0).all()
        for part in relations[:3]:
            assert np.isfinite(part).all()
            assert part.min() >= -1
            assert part.max() <= 1
        env.step(Decision(wanted_counts(view, random_choices(relations.is_legal, rng))))
