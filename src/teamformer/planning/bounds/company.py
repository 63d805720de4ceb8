"""Legs on which a robot's team has to form, since nobody else can be along.

Who does one task and then another is in the same team at both only if all that one of the tasks
needs was at the other too. If a capability that only the second needs cannot have been at the
first, the team joins on the way; if one that only the first needs cannot come along, it splits.
Each takes a step in which nobody of the team moves. A capability of one robot alone cannot be at a
task that does not fit between those that need it.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from teamformer.base.array_types import Ints
from teamformer.base.kernels.jit import entry
from teamformer.planning.bounds.tours import SetTables
from teamformer.planning.problem.coalition_problem import NEVER


@entry
def fit_in(
    duration: Ints,
    ways: Ints,
    others: Ints,
    tables: SetTables,
    before: npt.NDArray[np.bool_],
    after: npt.NDArray[np.bool_],
) -> None:
    """Say which tasks fit into a tour before each of its own, (others, visited), and after.

    `ways` (visited, others) are those to them; `others` (4, others) tells of each when the robot
    can be there first, between which times it starts, and how long it takes.
    """
    early, late, tours = tables
    visited, sets = len(duration), 1 << len(duration)
    for done in range(sets):
        left = sets - 1 - done
        if (done != 0 and tours[done] != 1) or (left != 0 and tours[left] != 1):
            continue
        for other in range(ways.shape[1]):
            begin, first, last, stay = others[:, other]
            soonest, leave = (begin if done == 0 else NEVER), (NEVER if left == 0 else -NEVER)
            for task in range(visited):
                if left >> task & 1:
                    leave = max(leave, late[left, task] - ways[task, other])
                elif early[done, task] < NEVER:
                    there = early[done, task] + duration[task] + ways[task, other]
                    soonest = min(soonest, there)
            soonest = max(soonest, first)
            if soonest > last or soonest + stay > leave:
                continue
            for task in range(visited):
                if left >> task & 1:
                    before[other, task] = True
                else:
                    after[other, task] = True
