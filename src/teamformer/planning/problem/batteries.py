"""Batteries and chargers of a coalition problem, in ticks, and what its plans come to with them."""

from __future__ import annotations

from collections.abc import Hashable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from teamformer.base.array_types import Floats, Ints
from teamformer.mission.parts.charging import Battery
from teamformer.planning.problem.constants import SPREAD
from teamformer.world.rules.charging.stops import ChargeRules
from teamformer.world.rules.charging.times import ChargedTimes, ChargeStart, time_charged
from teamformer.world.rules.constants import NOBODY
from teamformer.world.rules.starts import FIRST, StartRules

if TYPE_CHECKING:
    from teamformer.planning.problem.coalition_plan import CoalitionPlan
    from teamformer.planning.problem.coalition_problem import CoalitionProblem

ENDLESS = 10**15
"""Of a battery that never runs down, in ticks."""


class Batteries(NamedTuple):
    """What robots have to spend and where they charge; no kinds where nobody has a battery."""

    lasts: Ints  # (kinds,)
    fills: Floats  # (kinds,) how long a tick of walking takes to charge
    waiting: Floats  # (kinds,) what a tick of waiting takes
    spends: Ints  # (kinds, tasks) what the service of a task takes
    left: Ints  # (robots,) what each begins with
    to: Ints  # (paces, places, chargers) ways
    nearest: Ints  # (paces, places) the way to the nearest charger
    fro: Ints  # (kinds, chargers, tasks + 1) ways from chargers, last the way home
    between: Ints  # (paces, chargers, chargers)
    onward: Ints  # the same for who is full there, by way of others if need be; NEVER if it cannot
    room: Ints  # (chargers,)
    taken: Ints  # (taken, 2) chargers where somebody charges, and until when


def no_batteries() -> Batteries:
    """Return what stands for batteries where nobody has one."""
    one, two, three = (np.zeros((0,) * axes, np.int64) for axes in (1, 2, 3))
    none = np.zeros(0)
    return Batteries(one, none, none, two, one, three, two, three, three, three, one, two)


def are_charged(batteries: Batteries) -> bool:
    """Say whether anybody has a battery."""
    return len(batteries.lasts) > 0


def charged_totals(problem: CoalitionProblem, plan: CoalitionPlan) -> tuple[float, float]:
    """Return the makespan of a plan if robots charge, and what leads a search; infinite if never.

    Both are in ticks, and count with who queues at chargers.
    """
    back = charged_times(problem, plan).back
    makespan = max(back)
    return makespan, makespan + sum(back) / (SPREAD * len(back))


def charged_times(problem: CoalitionProblem, plan: CoalitionPlan) -> ChargedTimes:
    """Return the times of a plan in ticks if robots charge."""
    batteries, tasks, places = problem.batteries, len(problem.needs), problem.ways.shape[1]
    order, robots = plan.order.tolist(), range(len(problem.counts))
    home = -1

    def way(robot: int, here: Hashable, there: Hashable) -> float:
        assert isinstance(here, int), "places are numbers"
        assert isinstance(there, int), "places are numbers"
        pace, kind = problem.pace[robot], problem.kind[robot]
        if here < places and there == home:
            return int(problem.home[kind, here])
        if there == home:
            return int(batteries.fro[kind, here - places, tasks])
        if here < places and there >= places:
            return int(batteries.to[pace, here, there - places])
        if there >= places:
            return int(batteries.between[pace, here - places, there - places])
        if here >= places:
            return int(batteries.fro[kind, here - places, there])
        return int(problem.ways[pace, here, there])

    def site(robot: int, before: int) -> int:
        return int(problem.site[problem.origin[robot] if before == FIRST else before])

    def battery(robot: int) -> Battery | None:
        kind = problem.kind[robot]
        lasts = int(batteries.lasts[kind])
        if lasts == ENDLESS:
            return None
        fills, waiting = batteries.fills[kind], float(batteries.waiting[kind])
        return Battery(lasts, float(fills) * lasts, serving=1.0, waiting=waiting)

    def takes(task: int, _: object) -> float:
        return int(problem.duration[task])

    before = {
        task: [other for other in row if other != NOBODY]
        for task, row in enumerate(problem.before.tolist())
        if row[0] != NOBODY
    }
    own = [battery(robot) for robot in robots]
    chargers = [places + charger for charger in range(len(batteries.room))]
    free = [int(problem.ready[place - tasks]) for place in problem.origin]
    rules = StartRules(
        way, site, takes, free, dict(enumerate(problem.release.tolist())), before,
        forming=int(problem.forming[0]),
    )  # fmt: skip
    standing = ChargeStart(
        places=problem.origin.tolist(),
        left=batteries.left.tolist(),
        taken=[(charger, until) for charger, until in batteries.taken.tolist()],
        task_places=dict(zip(order, order, strict=True)),
        homes=[home] * len(own),
        spent=[batteries.spends[problem.kind[robot]].tolist() for robot in robots],
    )
    charging = ChargeRules(own, chargers, batteries.room.tolist(), way)
    coalitions = {task: plan.coalition[task, : plan.size[task]].tolist() for task in order}
    return time_charged(rules, charging, standing, order, coalitions)
