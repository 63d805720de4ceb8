"""Ways between tasks that no robot makes faster, and the tasks that stand for their place."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from teamformer.base.array_types import Array, Floats
from teamformer.planning.problem.relaxed_problem import Relaxed, cells_between
from teamformer.world.rules.constants import FAR


def one_for_each_place(problem: Relaxed, tasks: Array, start: Array) -> Array:
    """Keep the task that ends last of those in one place, or whose places touch on a plane."""
    by_end = tasks[np.argsort(-(start + problem.duration)[tasks], kind="stable")]
    is_same = cells_between(problem, by_end, by_end) == 0  # (tasks, tasks)
    kept: Array = by_end[_are_apart(is_same)]
    return kept


def _are_apart(is_same: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
    """Choose, in turn, what is not in the same place as anything chosen before, as (tasks,) bool.

    On a plane one place may touch two that do not touch each other.
    """
    is_chosen = np.zeros(len(is_same), np.bool_)
    for task in range(len(is_same)):
        is_chosen[task] = not (is_same[task] & is_chosen).any()
    return is_chosen


def least_legs(problem: Relaxed, robots: Array, tasks: Array) -> tuple[Floats, float]:
    """Return times that the legs of these robots are not shorter than, as (tasks, tasks).

    At whole speeds, the steps of the fastest robot, on the ground or in the air. Else the shorter
    way's cells over the highest speed: a robot may do a task in passing, with up to a cell walked
    of the next leg; the steps that gains come second. Where no way is, any time is sound, and the
    longest leg does.
    """
    cells = cells_between(problem, tasks, tasks)
    speed = float(problem.speed[robots].max())
    legs: Floats = problem.steps[np.unique(problem.pace[robots])][:, cells].min(axis=0)
    legs = legs.astype(np.float64)
    is_way, gained = legs < FAR, 0.0
    if (problem.speed[robots] % 1 != 0).any():
        legs[is_way] = problem.lengths[:, cells[is_way]].min(axis=0) / speed
        gained = 1 / speed
    legs[~is_way] = legs[is_way].max()
    return legs, gained
