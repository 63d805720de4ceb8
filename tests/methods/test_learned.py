"""The learned policy as it runs: ONNX against torch, and the deadlock guard."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from random_worlds import random_world
from teamformer.base.array_types import Array
from teamformer.base.errors import TeamformerError
from teamformer.files.drawn.generate import Spec, generate
from teamformer.learning.evaluation import torch_brain
from teamformer.learning.export.onnx_export import NETWORK_FILE, export_any_fleet
from teamformer.learning.trainer import make_learner
from teamformer.learning.training_settings import TrainSettings
from teamformer.methods.learned.any_fleet import AnyFleetCodec, any_fleet, teamformer
from teamformer.methods.learned.deadlock_guard import DeadlockGuard
from teamformer.methods.learned.macro_actions import FOLLOW, MAINTAIN
from teamformer.methods.learned.onnx_sessions import OnnxNetwork
from teamformer.methods.learned.policy import Brain, Learned, rows_of
from teamformer.methods.learned.relational_features import Relations, relate
from teamformer.methods.scripted.join_fitting import JoinFitting
from teamformer.methods.scripted.joining import JoinAll
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.trials.trial import run_trials
from teamformer.world.env import Decision, TeamFormation


def prefer_maintain(tokens: tuple[Array, ...]) -> Array:
    """Choose as a network would that never does anything."""
    return np.where(tokens[-1][:, MAINTAIN], MAINTAIN, FOLLOW)


class Whim:
    """Chooses at random, so that teams join and split without end."""

    def __init__(self) -> None:
        self.rng = np.random.default_rng(0)

    def __call__(self, tokens: tuple[Array, ...]) -> Array:
        is_legal = tokens[-1]
        return np.where(is_legal, self.rng.random(is_legal.shape), -1.0).argmax(axis=1)


def learned(brain: Brain, is_guarded: bool = True) -> Learned:
    return Learned(AnyFleetCodec(), brain, is_guarded)


def two_who_need_each_other() -> Mission:
    """Robots {a} at cell 0 and {b} at cell 1 of four; the task at cell 3 needs both."""
    return Mission(
        "two",
        Grid(4, 1),
        ("a", "b"),
        (Robot("r0", (0, 0), {"a": 1}), Robot("r1", (1, 0), {"b": 1})),
        (Task("t0", (3, 0), {"a": 1, "b": 1}),),
    )


@pytest.mark.thorough
def test_onnx_equals_torch_over_a_thousand_views(tmp_path: Path) -> None:
    learner = make_learner(TrainSettings(seed=5))
    with torch.no_grad():
        for weights in learner.policy.parameters():
            weights *= 2.0  # scores far apart, as after training
    export_any_fleet(learner.policy, None, tmp_path)
    content = (tmp_path / NETWORK_FILE).read_bytes()
    in_onnx = OnnxNetwork(content, "net", Relations._fields)
    rng = np.random.default_rng(0)
    env = TeamFormation([random_world(rng) for _ in range(80)])
    policy, views = learned(Whim()), 0
    for _ in range(30):
        view = env.view()
        if not len(view.slot):
            break
        relations = relate(view)
        [scores] = in_onnx(*relations)
        with torch.no_grad():
            twin = learner.policy(*map(torch.from_numpy, relations)).numpy()
        np.testing.assert_allclose(scores, twin, atol=1e-5, rtol=1e-5)
        assert (scores.argmax(axis=1) == twin.argmax(axis=1)).all()
        views += len(scores)
        env.step(policy.decide(view))
    assert views > 1000


def test_the_shipped_network_asks_for_nothing_illegal() -> None:
    rng = np.random.default_rng(1)
    env = TeamFormation([random_world(rng) for _ in range(150)])
    policy = teamformer()
    for _ in range(60):
        env.step(policy.decide(env.view()))
    assert env.worlds.count["illegal"].sum() == 0
    assert env.worlds.count["joins"].sum() > 50


def test_capabilities_may_be_many() -> None:
    names = tuple(f"c{i}" for i in range(1000))
    world = Mission(
        "thousand",
        Grid(6, 6),
        names,
        tuple(Robot(f"r{r}", (2, 2), {names[c]: 1 for c in range(r, 1000, 4)}) for r in range(4)),
        (Task("t0", (5, 5), dict.fromkeys(names, 1)),),
    )
    [tally] = run_trials([world], teamformer())
    assert tally.status == "completed"
    assert tally.steps < 20


def test_the_deadlock_guard_by_hand() -> None:
    """Both walk to cell 3 and wait: what they see spans three cells, then two, then none."""
    env = TeamFormation([two_who_need_each_other()])
    guard, overdue = DeadlockGuard(), []
    for _ in range(34):
        view = env.view()
        overdue.append(guard.is_overdue(view).tolist())
        env.step(Decision(view.counts))
    assert overdue[30] == [False, False]
    assert overdue[31] == [True, True]  # 31 steps without change, at the task, with 30 of patience
    guard.begin()
    assert guard.is_overdue(env.view()).tolist() == [False, False]


def test_progress_and_arrivals_reset_patience() -> None:
    mission = Mission(
        "late",
        Grid(4, 1),
        ("a", "b"),
        (Robot("r0", (3, 0), {"a": 1}), Robot("r1", (3, 0), {"b": 1})),
        (Task("t0", (3, 0), {"a": 1, "b": 1}), Task("t1", (3, 0), {"a": 1}, appears=20)),
    )
    env = TeamFormation([mission])
    guard, first = DeadlockGuard(), None
    for step in range(60):
        view = env.view()
        if guard.is_overdue(view).any() and first is None:
            first = step
        env.step(Decision(view.counts))
    # t1 is done in the step after it appears; the list last changes at step 21
    assert first == 21 + 31


def test_who_does_nothing_ends_with_the_rule_and_not_without() -> None:
    two = two_who_need_each_other()
    worlds = [replace(two, robots=(*two.robots, Robot("r2", (0, 0), {"a": 1})))]
    policy = learned(prefer_maintain)
    [tally] = run_trials(worlds, policy)
    assert tally.status == "completed"
    assert policy.overdue == 3  # all are, in the one step that it takes
    [tally] = run_trials(worlds, learned(prefer_maintain, is_guarded=False))
    assert tally.status == "step limit"


@pytest.mark.parametrize("policy", [learned(prefer_maintain), learned(Whim()), teamformer()])
def test_with_the_rule_all_ends_that_the_script_ends(policy: Learned) -> None:
    rng = np.random.default_rng(2)
    worlds = [random_world(rng, with_losses=False) for _ in range(200)]
    bar = run_trials(worlds, JoinAll())
    tallies = run_trials(worlds, policy)
    for world, tally, bar_tally in zip(worlds, tallies, bar, strict=True):
        assert (tally.status == "completed") or bar_tally.status != "completed", world
        assert tally.illegal_decisions == 0


def test_untrained_it_is_the_script() -> None:
    rng = np.random.default_rng(4)
    specs = [Spec(8, 8, 8), Spec(12, 12, 4), Spec(30, 4, 30)]
    worlds = [generate(s, rng) for s in specs for _ in range(6)]
    network = make_learner(TrainSettings(seed=3)).policy
    policy = Learned(AnyFleetCodec(), torch_brain(network), is_guarded=False)  # type: ignore[arg-type]
    assert run_trials(worlds, policy) == run_trials(worlds, JoinFitting())


def test_trials_do_not_depend_on_who_else_is_in_the_batch() -> None:
    rng = np.random.default_rng(3)
    worlds = [random_world(rng) for _ in range(12)]
    together = run_trials(worlds, teamformer())
    assert together == [run_trials([world], teamformer())[0] for world in worlds]


@pytest.mark.thorough
def test_files_that_are_no_network_are_refused(tmp_path: Path) -> None:
    with pytest.raises(TeamformerError, match="holds no network that runs"):
        any_fleet(b"no network", "net.onnx")
    export_any_fleet(make_learner(TrainSettings()).policy, None, tmp_path)
    with pytest.raises(TeamformerError, match="takes"):
        OnnxNetwork((tmp_path / NETWORK_FILE).read_bytes(), "net.onnx", ("own",))


def test_rows_of_a_view_keep_their_members() -> None:
    view = TeamFormation([generate(Spec(6, 3, 3, starts_in_teams=True), np.random.default_rng(1))])
    whole = view.view()
    some = rows_of(whole, np.array([2, 0]))
    assert some.slot.tolist() == whole.slot[[2, 0]].tolist()
    for row, old in enumerate((2, 0)):
        mine = some.member[some.first_member[row] : some.first_member[row + 1]]
        theirs = whole.member[whole.first_member[old] : whole.first_member[old + 1]]
        assert mine.tolist() == theirs.tolist()
        counts = some.member_counts[some.first_member[row] : some.first_member[row + 1]]
        assert (counts.sum(axis=0) == whole.counts[old]).all()
