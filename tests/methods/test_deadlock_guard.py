"""When a team has seen no progress for too long."""

from __future__ import annotations

import itertools

import pytest

from small_worlds import make, robot, task
from teamformer.methods.learned.deadlock_guard import DeadlockGuard, _hash_open_tasks
from teamformer.mission.model import Mission
from teamformer.mission.parts.grid import Grid
from teamformer.world.env import TeamFormation
from teamformer.world.rules.constants import NOBODY
from teamformer.world.view import View


def four_tasks() -> View:
    """Return the view of a robot that sees four tasks; which ones, a test may change."""
    env = TeamFormation([make([robot("a", 0)], [task("a", x) for x in (1, 2, 3, 4)])])
    return env.view()


def hash_of(view: View, tasks: tuple[int, ...]) -> int:
    view.task_number[0, :4] = tasks
    return int(_hash_open_tasks(view, 0))


def test_any_two_sets_of_tasks_differ_and_their_order_does_not_count() -> None:
    """Sums of squares would not do: 1 + 64 = 16 + 49."""
    view = four_tasks()
    sets = list(itertools.combinations(range(40), 4))
    assert len({hash_of(view, tasks) for tasks in sets}) == len(sets)
    assert hash_of(view, (3, 9, 1, 7)) == hash_of(view, (1, 3, 7, 9))


@pytest.mark.parametrize(
    ("mission", "patience"),
    [
        (make([robot("a", 0)], [task("a", 2), task("a", 5)]), 30 + 3 * 5),
        (make([robot("a", 0, speed=0.5)], [task("a", 5)]), 30 + 3 * 10),
        (make([robot("a", 0, speed=2.0)], [task("a", 5)]), 30 + 3 * 5),
        (make([robot("a", 3)], [task("a", 1), task("a", 5)]), 30 + 3 * 4),
        (make([robot("a", 0, 3)], [task("a", 2, 1)], Grid(5, 5)), 30 + 3 * (2 + 2)),
        (make([robot("a", 1, 1)], [task("a", 0, 4)], Grid(5, 5)), 30 + 3 * (1 + 3)),
    ],
    ids=["right", "slow", "fast", "both sides", "down", "up"],
)
def test_a_team_is_overdue_after_thirty_steps_and_three_walks_across_what_it_sees(
    mission: Mission, patience: int
) -> None:
    guard, view = DeadlockGuard(), TeamFormation([mission]).view()
    told = [guard.is_overdue(view).tolist() for _ in range(patience + 3)]
    assert told == [[False]] * (patience + 1) + [[True]] * 2  # the first look is at step 0


def test_a_task_that_is_done_starts_the_wait_anew() -> None:
    guard, view = DeadlockGuard(), four_tasks()
    patience = 30 + 3 * 4
    for _ in range(patience + 1):
        assert not guard.is_overdue(view).any()
    view.task_number[0, 3] = NOBODY
    assert not guard.is_overdue(view).any()
    view.task_place[0, 3] = view.task_place[0, 0]
    nearer = 30 + 3 * 3
    assert [guard.is_overdue(view).any() for _ in range(nearer + 1)] == [False] * nearer + [True]
    guard.begin()
    assert not guard.is_overdue(view).any()
