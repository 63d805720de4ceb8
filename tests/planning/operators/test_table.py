"""The table of operators: which problem has which, and how often each is drawn."""

from __future__ import annotations

import numpy as np
import pytest

from random_coalitions import random_problem
from teamformer.base.array_types import Array, Int32s, Ints
from teamformer.base.kernels.jit import entry
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.planning.operators.table import (
    EXCHANGE,
    MOVE_GROUP,
    MOVE_TASK,
    OPERATORS,
    RIDE,
    draw_operator,
    shares_of,
)
from teamformer.planning.problem.links import TRAVEL, link_tasks
from teamformer.planning.steps.arc_search import TeamArcs
from teamformer.planning.steps.situation import situation_in_hindsight


def used(shares: Int32s) -> set[int]:
    """Return the numbers of the operators that make changes."""
    return set(np.flatnonzero(shares).tolist())


@pytest.mark.parametrize(("spares", "more"), [(0, set()), (2, {RIDE})])
def test_robots_to_spare_come_along_only_where_that_may_pay(spares: int, more: set[int]) -> None:
    problem = random_problem(0)._replace(spares=spares)
    assert used(shares_of(problem, None)) == {EXCHANGE, MOVE_TASK} | more
    links = link_tasks(len(problem.needs), len(problem.counts), (), {TRAVEL: 1.0})
    shares = shares_of(problem._replace(links=links), None)
    assert used(shares) == {EXCHANGE, MOVE_GROUP} | more


@pytest.mark.parametrize("tasks", [3, 100])
def test_in_steps_all_but_those_for_costs_are_tried(tasks: int) -> None:
    robots = (Robot("r", (0, 0), {"a": 1}), Robot("s", (1, 0), {"a": 1}))
    wanted = tuple(Task(f"t{n}", (n % 20, n // 20), {"a": 1}) for n in range(tasks))
    mission = Mission("many", Grid(20, 5), ("a",), robots, wanted)
    shares = TeamArcs(situation_in_hindsight(mission)).search._shares
    expected = [
        (one.large_steps if tasks == 100 else one.steps) * (not one.with_misses)
        for one in OPERATORS
    ]
    assert shares.tolist() == expected
    assert MOVE_GROUP not in used(shares)


@entry
def draw_many(shares: Int32s, random: Array, drawn: Ints, times: int) -> None:
    """Draw so often, and count."""
    for _ in range(times):
        drawn[draw_operator(shares, random)] += 1


def test_operators_are_drawn_by_their_shares_and_the_last_makes_the_rest() -> None:
    shares = np.array([40, 15, 0, 0, 0, 100], np.int32)
    drawn = np.zeros(6, np.int64)
    draw_many(shares, np.array([88172645463325252], np.uint64), drawn, 100_000)
    assert drawn / 1000 == pytest.approx([40, 15, 0, 0, 0, 45], abs=1)
