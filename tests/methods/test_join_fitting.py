"""The script that the policy for any fleet begins from: by hand, and that it ends missions."""

from __future__ import annotations

import numpy as np
import pytest

from random_worlds import random_world
from teamformer.files.drawn.named_settings import world_of
from teamformer.methods.scripted.join_fitting import JoinFitting
from teamformer.methods.scripted.joining import JoinAll
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.trials.trial import run_trials
from teamformer.world.env import Decision, TeamFormation

CAPS = ("a", "b")


def side_by_side(cans: list[dict[str, int]], tasks: list[tuple[int, dict[str, int]]]) -> Mission:
    """Robots in cell 0 of a row of eight, and tasks at their cells."""
    return Mission(
        "side by side",
        Grid(8, 1),
        CAPS,
        tuple(Robot(f"r{r}", (0, 0), can) for r, can in enumerate(cans)),
        tuple(Task(f"t{k}", (x, 0), needs) for k, (x, needs) in enumerate(tasks)),
    )


def wanted(mission: Mission) -> list[list[int]]:
    counts: list[list[int]] = JoinFitting().decide(TeamFormation([mission]).view()).wanted.tolist()
    return counts


def test_who_adds_what_is_needed_is_joined_and_who_would_be_one_too_many_is_not() -> None:
    both = (4, {"a": 1, "b": 1})
    assert wanted(side_by_side([{"a": 1}, {"b": 1}], [both])) == [[1, 1], [1, 1]]
    assert wanted(side_by_side([{"a": 1}, {"a": 1}], [(4, {"a": 1})])) == [[1, 0], [1, 0]]
    assert wanted(side_by_side([{"a": 1}, {"a": 1}], [(4, {"a": 2})])) == [[2, 0], [2, 0]]


def test_one_of_what_no_task_in_view_needs_is_taken_along_and_two_are_not() -> None:
    """A task out of view may need it."""
    only_a = (4, {"a": 1})
    assert wanted(side_by_side([{"a": 1}, {"b": 1}], [only_a])) == [[1, 1], [1, 1]]
    assert wanted(side_by_side([{"a": 1}, {"b": 2}], [only_a])) == [[1, 0], [1, 2]]


def test_at_the_task_what_is_missing_is_joined_even_if_some_is_wasted() -> None:
    """Robots {a, b} and {a, c} fit nobody elsewhere; where both must work they join."""
    mission = Mission(
        "overlap",
        Grid(4, 1),
        ("a", "b", "c"),
        (Robot("r0", (0, 0), {"a": 1, "b": 1}), Robot("r1", (0, 0), {"a": 1, "c": 1})),
        (Task("t0", (2, 0), {"a": 1, "b": 1, "c": 1}),),
    )
    assert wanted(mission) == [[1, 1, 0], [1, 0, 1]]
    [tally] = run_trials([mission], JoinFitting())
    assert (tally.status, tally.steps) == ("completed", 3)  # two steps there, one to join


def test_those_who_can_do_their_own_tasks_alone_part() -> None:
    """{a} heads for the near task, {b} for the far one; only the third needs both."""
    tasks = [(2, {"a": 1}), (4, {"b": 1}), (7, {"a": 1, "b": 1})]
    env = TeamFormation([side_by_side([{"a": 1}, {"b": 1}], tasks)])
    env.step(Decision(env.view().counts))  # they have assignments now, and both stand in cell 1
    assert JoinFitting().decide(env.view()).wanted.tolist() == [[1, 0], [0, 1]]


def test_without_doubles_it_does_as_well_as_join_all() -> None:
    worlds = [world_of("8N20T-C8", seed) for seed in range(30)]
    fitting, bar = (
        np.mean([tally.steps for tally in run_trials(worlds, policy)])
        for policy in (JoinFitting(), JoinAll())
    )
    assert fitting <= bar + 0.1


def test_with_doubles_it_is_faster_than_join_all() -> None:
    worlds = [world_of("20N40T-C4-20x20", seed) for seed in range(20)]
    fitting, bar = (
        np.mean([tally.steps for tally in run_trials(worlds, policy)])
        for policy in (JoinFitting(), JoinAll())
    )
    assert fitting < 0.95 * bar


@pytest.mark.parametrize("is_plane", [False, True])
def test_missions_end(is_plane: bool) -> None:
    rng = np.random.default_rng(11)
    worlds = [random_world(rng, with_losses=False, is_plane=is_plane) for _ in range(300)]
    for world, tally in zip(worlds, run_trials(worlds, JoinFitting()), strict=True):
        assert tally.status == "completed", world
