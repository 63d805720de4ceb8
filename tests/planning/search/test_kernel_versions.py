"""Searches are compiled twice: with what only batteries, shifts and missed tasks need, or without.

Both versions do the same to a problem that has none of these.
"""

from __future__ import annotations

import numpy as np
import pytest

from random_coalitions import random_problem
from teamformer.files.drawn.named_settings import world_of
from teamformer.planning.continuous.continuous_mission import pose_mission
from teamformer.planning.graph.arc_problem import pose_arcs
from teamformer.planning.problem.coalition_problem import CoalitionProblem
from teamformer.planning.search.arc_search import ArcSearch


@pytest.mark.parametrize(
    ("family", "extras"),
    [("clock", ()), ("roads", ()), ("shifts", (1,)), ("optional", (1,)), ("charging", (1,))],
)
def test_the_long_version_is_for_problems_that_need_it(
    family: str, extras: tuple[int, ...]
) -> None:
    assert pose_arcs(pose_mission(world_of(family, 0)).problem).extras == extras


@pytest.mark.parametrize(
    "problem",
    [
        random_problem(3, tasks=15, robots=6),
        pose_mission(world_of("clock", 2)).problem,  # linked, with a cost
    ],
)
def test_both_versions_search_alike(problem: CoalitionProblem) -> None:
    found = []
    for extras in ((), (1,)):
        search = ArcSearch(problem, 5)
        search.arcs = search.arcs._replace(extras=extras)
        assert search.begin_anew()
        hot, cold = search.heats
        search.anneal(hot, cold, 0, 4000, 4000)
        found.append((search.rank, search.state.random.tolist(), search.graph.nodes.end.tolist()))
        found[-1] += (search.best.order.tolist(), search.best.coalition.tolist())
    assert found[0] == found[1]
    assert np.isfinite(found[0][0]).all()
