"""When a team has seen no progress for too long."""

from __future__ import annotations

import itertools

from small_worlds import make, robot, task
from teamformer.policies.learned.deadlock_guard import _hash_open_tasks
from teamformer.sim.env import TeamFormation
from teamformer.sim.view import View


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
