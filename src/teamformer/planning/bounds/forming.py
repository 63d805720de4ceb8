"""Earliest starts of tasks when forming costs a step in which nobody moves.

If several starting teams have to become one, each of their robots forms at least once. Joins pair
two teams, so of teams that arrive after d_1, d_2, ... steps of walking, one at step D takes part
in no more than D - d_i joins, and the sum of 2^-(D - d_i) is at most 1 (Kraft's inequality).
"""

from __future__ import annotations

import math

import numpy as np

from teamformer.base.array_types import Array
from teamformer.mission.model import Mission
from teamformer.mission.parts.grid import Grid
from teamformer.planning.problem.relaxed_problem import Relaxed, in_blocks, steps_from_starts
from teamformer.world.rules.constants import FAR


def steps_of_forming(mission: Mission) -> int:
    """Return the steps that a join or a split costs: none on planes, where who joins is there."""
    return mission.forming_steps if isinstance(mission.world, Grid) else 0


def raise_for_forming(mission: Mission, problem: Relaxed, walked: Array) -> Array:
    """Return the first step by which each task's team can have walked and formed, as (tasks,).

    `walked` is the first step in which enough of each capability can be there, as (tasks,), 0 if
    they start there. Where forming is free, and on planes, that is all that is returned.
    """
    raised: Array = walked.astype(np.int64)
    if steps_of_forming(mission) == 0:
        return raised
    teams = [list(team) for team in mission.starting_teams]
    has = np.array([problem.counts[team].sum(axis=0) for team in teams])  # (teams, caps)
    members = np.concatenate(teams)  # (robots,) team by team
    first = np.cumsum([0, *map(len, teams[:-1])])  # (teams,)
    for tasks in in_blocks(np.flatnonzero(walked < FAR), len(members)):
        nearest = np.minimum.reduceat(steps_from_starts(problem, tasks)[:, members], first, axis=1)
        for task, ways in zip(tasks.tolist(), nearest, strict=True):  # (teams,) each
            useful = np.minimum(has, problem.needs[task]).sum(axis=1)  # (teams,)
            most = np.sort(useful)[::-1].cumsum()
            fewest = 1 + int(np.searchsorted(most, problem.needs[task].sum()))
            soonest = np.sort(np.partition(ways[useful > 0], fewest - 1)[:fewest]).tolist()
            raised[task] = _fewest_steps([*soonest[:-1], max(soonest[-1], int(walked[task]))])
    return raised


def _fewest_steps(ways: list[int]) -> int:
    """Return the first step in which teams that walk so far can be one; the last walks longest."""
    longest = int(ways[-1])
    return longest + math.ceil(math.log2(sum(2.0 ** (int(way) - longest) for way in ways)))
