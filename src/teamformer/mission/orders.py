"""Other orders in which a mission is written.

The order of robots and tasks means nothing, but searches draw their changes by it. So other orders
make other searches for a plan of the same mission.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from teamformer.mission.model import Mission, as_believed


class WritingOrder(NamedTuple):
    """In which order the robots and tasks of a mission are written, by their numbers before."""

    robots: list[int]
    tasks: list[int]


def draw_order(mission: Mission, number: int) -> WritingOrder:
    """Return one of the orders of a mission; 0 is the one that it is written in."""
    robots, tasks = len(mission.robots), len(mission.tasks)
    if number == 0:
        return WritingOrder(list(range(robots)), list(range(tasks)))
    rng = np.random.default_rng(number)
    in_turn = rng.permutation(tasks).tolist()
    return WritingOrder(rng.permutation(robots).tolist(), in_turn)


def in_order(mission: Mission, order: int) -> Mission:
    """Return the same mission with robots and tasks written in another order.

    It is as possible as it was: one that is believed at some moment may not be.
    """
    if order == 0:
        return mission
    drawn = draw_order(mission, order)
    return as_believed(
        mission,
        robots=tuple(mission.robots[robot] for robot in drawn.robots),
        tasks=tuple(mission.tasks[task] for task in drawn.tasks),
        teams=_teams_of(mission, drawn.robots),
    )


def with_robots(mission: Mission, chosen: Sequence[int]) -> Mission:
    """Return a mission with some of its robots, in another order; teams keep those chosen.

    Raises `MissionError` if they cannot do it.
    """
    robots = tuple(mission.robots[robot] for robot in chosen)
    return replace(mission, robots=robots, teams=_teams_of(mission, chosen), step_limit=0)


def _teams_of(mission: Mission, chosen: Sequence[int]) -> tuple[tuple[int, ...], ...]:
    """Return the teams of those of some robots that start together, by where they stand there."""
    number_of = {robot: number for number, robot in enumerate(chosen)}
    teams = (tuple(sorted(number_of[r] for r in team if r in number_of)) for team in mission.teams)
    return tuple(team for team in teams if len(team) > 1)
