"""What plans of missions in steps are searched by, where more counts than the makespan."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from teamformer.base.array_types import Array, Ints
from teamformer.base.kernels.jit import kernel
from teamformer.mission.checks.costs import judged_by
from teamformer.mission.model import Mission, Task
from teamformer.world.rules.constants import NEVER

SHARES = 3200
"""What a step of everything costs, for each task: how finely prices are told apart."""

STEP = 200
"""What a step of makespan costs, for each task, where that alone counts."""

SMOOTH = 16
"""What a step of the end of any task costs a search beside its price: it leads out of plateaus."""


class Prices(NamedTuple):
    """Prices of a step, whole numbers; no arrays have an entry where the makespan alone counts."""

    due: Ints  # (tasks,) the step in which each has to be done
    late: Ints  # (tasks,) of each step that it is late
    ends: Ints  # (tasks,) of each step until its end
    whole: Ints  # (2,) of each step of the makespan, and of each that the latest task is late


def prices_of(mission: Mission, tasks: Sequence[Task]) -> Prices:
    """Return the prices of plans for some tasks of a mission; none if its makespan alone counts."""
    weights = judged_by(mission)
    if weights is None or not tasks:
        nothing = np.zeros(0, np.int64)
        return Prices(nothing, nothing, nothing, nothing)
    by_task = np.array([task.weight for task in tasks])
    wanted = {part: weights.get(part, 0.0) for part in
              ("makespan", "max_tardiness", "tardiness", "completion")}  # fmt: skip
    of_tasks = (wanted["tardiness"] + wanted["completion"]) * by_task.sum()
    everything = wanted["makespan"] + wanted["max_tardiness"] + of_tasks
    if everything == 0:  # only what is missed counts
        wanted["makespan"] = everything = 1.0
    step = SHARES * len(tasks) / everything

    def price(weight: npt.ArrayLike) -> Ints:
        return np.rint(step * np.asarray(weight)).astype(np.int64)

    due = [NEVER if task.between is None else int(task.between[1]) for task in tasks]
    return Prices(
        due=np.array(due, np.int64),
        late=price(wanted["tardiness"] * by_task),
        ends=price(wanted["completion"] * by_task),
        whole=price([wanted["makespan"], wanted["max_tardiness"]]),
    )


def step_of_missed(mission: Mission, tasks: Sequence[Task]) -> float:
    """Return what a missed task of weight 1 costs, in the unit of prices of a step."""
    weights = judged_by(mission) or {}
    by_task = sum(task.weight for task in tasks)
    everything = weights.get("makespan", 0.0) + weights.get("max_tardiness", 0.0)
    everything += (weights.get("tardiness", 0.0) + weights.get("completion", 0.0)) * by_task
    return SHARES * len(tasks) * weights.get("missed", 0.0) / (everything or 1.0)


@kernel
def price_of_end(prices: Prices, task: int, end: int) -> int:
    """Return what it costs that a task ends in a step, and is late then."""
    late = max(0, end - prices.due[task])
    return prices.ends[task] * end + prices.late[task] * late


@kernel
def slope_of_price(prices: Prices, task: int, end: int) -> int:
    """Return what it costs that a task that ends in a step does so a step later."""
    return prices.ends[task] + (prices.late[task] if end >= prices.due[task] else 0)


@kernel
def price_of_ends(prices: Prices, ends: Array, until: int = NEVER) -> int:
    """Return what it costs that tasks end in such steps (tasks,), and how late the latest is.

    What ends after `until` is missed, and costs nothing here.
    """
    price, latest = np.int64(0), np.int64(0)
    for task in range(len(prices.due)):
        if ends[task] > until:
            continue
        price += price_of_end(prices, task, ends[task])
        latest = max(latest, ends[task] - prices.due[task])
    return price + prices.whole[1] * latest
