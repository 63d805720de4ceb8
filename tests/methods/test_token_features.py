"""What the paper's network sees: checked by hand on a world drawn in a line."""

from __future__ import annotations

import numpy as np
import pytest

from teamformer.methods.learned.token_features import NEVER_FITS, Spelled, SpellingCodec
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.world.env import Decision, TeamFormation
from teamformer.world.view import View


def on_a_line(cells: int = 30, service: int = 0) -> Mission:
    """Robots r0 {a} and r1 {a: 2, b} as one team and r2 {b} at cell 4; tasks at cells 4 and 24.

    t0 at cell 4 needs 4 a, t1 at cell 24 needs 2 b and 1 a.
    """
    return Mission(
        "line",
        Grid(cells, 1),
        ("a", "b"),
        (
            Robot("r0", (4, 0), {"a": 1}),
            Robot("r1", (4, 0), {"a": 2, "b": 1}),
            Robot("r2", (4, 0), {"b": 1}),
        ),
        (Task("t0", (4, 0), {"a": 3}, service), Task("t1", (24, 0), {"a": 1, "b": 2})),
        teams=((0, 1), (2,)),
    )


def seen_in(mission: Mission, capabilities: int = 3) -> tuple[View, Spelled]:
    env = TeamFormation([mission])
    view = env.view()
    return view, SpellingCodec(capabilities).encode(view)


def test_counts_come_with_padding_and_the_own_team_first() -> None:
    _, tokens = seen_in(on_a_line())
    assert tokens.team_counts[0].tolist() == [[3, 1, 0], [0, 1, 0], [0, 0, 0]]
    assert tokens.team_counts[1].tolist() == [[0, 1, 0], [3, 1, 0], [0, 0, 0]]
    assert tokens.is_team.tolist() == [[True, True, False]] * 2
    assert tokens.can_join.tolist() == [[False, True, False]] * 2
    assert sorted(tokens.task_needs[0].tolist()) == [[1, 2, 0], [3, 0, 0]]


def test_robots_of_one_capability_and_of_several_are_kept_apart() -> None:
    _, tokens = seen_in(on_a_line())
    assert tokens.singles.tolist() == [[1, 0, 0], [0, 1, 0]]
    assert tokens.profiles[0].tolist() == [[2, 1, 0], [NEVER_FITS] * 3, [NEVER_FITS] * 3]
    assert (tokens.profiles[1] == NEVER_FITS).all()


def test_places_are_in_tens_of_cells_and_in_the_box_of_all_tasks() -> None:
    """From cell 4, cell 24 is two tens away; the box goes from 4 to 24, its middle is 14."""
    _, tokens = seen_in(on_a_line())
    there = next(task for task in range(2) if tokens.task_needs[0, task, 1] == 2)
    here = 1 - there
    assert tokens.tasks[0, there, :8].tolist() == pytest.approx([2, 0, 2, 0, 0, 0, 1, 0])
    assert tokens.tasks[0, here, :8].tolist() == pytest.approx([0, 0, 0, 1, 0, 0, -1, 0])
    assert tokens.teams[0, 0, :8].tolist() == pytest.approx([0, 0, 0, 1, 0, 0, -1, 0])


def test_what_a_task_needs_is_compared_with_what_the_team_has() -> None:
    """Team 0 has 3 a and 1 b: all of t0, which needs no b, and two of the three for t1."""
    _, tokens = seen_in(on_a_line())
    there = next(task for task in range(2) if tokens.task_needs[0, task, 1] == 2)
    covered, alone, helps, beyond = tokens.tasks[0, there, 12:16].tolist()
    assert covered == pytest.approx(2 / 3)
    assert (alone, helps, beyond) == (0, 1, 1)
    assert tokens.tasks[0, 1 - there, 12:16].tolist() == [1, 1, 1, 1]


def test_a_larger_grid_changes_nothing() -> None:
    small, large = seen_in(on_a_line(30))[1], seen_in(on_a_line(300))[1]
    for one, other in zip(small, large, strict=True):
        assert np.array_equal(one, other)


def test_who_serves_has_no_choice() -> None:
    env = TeamFormation([on_a_line(service=5)])
    for _ in range(2):
        env.step(Decision(env.view().counts))
    view = env.view()
    tokens = SpellingCodec(2).encode(view)
    codec = SpellingCodec(2)
    assert view.is_serving.tolist() == [True, False]
    assert codec.has_choice(view, tokens).tolist() == [False, False]  # nobody else can be joined
    assert tokens.singles[0].tolist() == [0, 0]


def test_who_is_alone_and_sees_nobody_has_no_choice() -> None:
    mission = on_a_line()
    view, tokens = seen_in(mission)
    assert SpellingCodec(3).has_choice(view, tokens).tolist() == [True, True]
    alone = Mission(
        "alone",
        Grid(3, 1),
        ("a",),
        (Robot("r0", (0, 0), {"a": 2}),),
        (Task("t0", (2, 0), {"a": 1}),),
    )
    view, tokens = seen_in(alone)
    assert SpellingCodec(3).has_choice(view, tokens).tolist() == [False]


def test_an_action_loses_its_padding() -> None:
    view, _ = seen_in(on_a_line())
    wanted = SpellingCodec(3).decode(view, np.array([[3, 2, 0], [0, 1, 0]]))
    assert wanted.tolist() == [[3, 2], [0, 1]]
    assert wanted.dtype == np.int32
