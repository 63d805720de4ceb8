"""Ways in which all that is not known of a mission may turn out: the same for everybody."""

from __future__ import annotations

from collections.abc import Set
from typing import NamedTuple

import numpy as np

from teamformer.model import Scenario
from teamformer.planning.relaxation.plan import Array
from teamformer.planning.teams.facts import Situation


class Futures(NamedTuple):
    """What is true in each of them; tasks are those of a `Situation`."""

    needs: Array  # (futures, tasks, caps)
    duration: Array  # (futures, tasks)


def sample_futures(
    scenario: Scenario,
    situation: Situation,
    most: Array,
    hidden: Set[int],
    step: int,
    count: int,
) -> Futures:
    """Return futures that are as likely as any; needs that nobody left could bring do not come.

    They follow from the step and the numbers of the tasks alone. `most` (tasks, caps) is what is
    believed to be needed at most, `hidden` are the tasks of which nobody has seen what they need.
    """
    needs = np.repeat(most[None], count, axis=0)
    duration = np.repeat(situation.problem.duration[None].astype(np.int64), count, axis=0)
    for index, number in enumerate(situation.tasks):
        task = scenario.tasks[number]
        rng = np.random.default_rng([number, step])
        if number in hidden:
            for cap, chance in task.may_need.items():
                column = scenario.capabilities.index(cap)
                is_absent = rng.random(count) >= chance
                if needs[0, index, column] > task.needs.get(cap, 0):
                    needs[is_absent, index, column] -= 1
        if task.lasts is not None:
            duration[:, index] = rng.integers(*task.lasts, size=count, endpoint=True)
    return Futures(needs, duration)
