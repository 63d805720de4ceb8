"""What plans come to where robots queue, in ticks: at chargers, before zones. No search has it."""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Sequence

from teamformer.mission.parts.charging import Battery
from teamformer.planning.problem.batteries import ENDLESS, Batteries, are_charged
from teamformer.planning.problem.coalition_plan import CoalitionPlan
from teamformer.planning.problem.coalition_problem import CoalitionProblem
from teamformer.planning.problem.constants import SPREAD
from teamformer.planning.problem.docks import have_docks, rooms_of_docks
from teamformer.planning.problem.links import (
    COMPLETION,
    HOME,
    MAKESPAN,
    MAX_TARDINESS,
    PARTS,
    TARDINESS,
    TRAVEL,
    gaps_as_told,
    have_weights,
)
from teamformer.planning.problem.misses import can_miss
from teamformer.planning.problem.permits import rooms_of_permits
from teamformer.planning.problem.rotas import rotas_as_told
from teamformer.world.rules.charging.stops import ChargeRules
from teamformer.world.rules.charging.times import ChargedTimes, ChargeStart, time_charged
from teamformer.world.rules.constants import NOBODY
from teamformer.world.rules.starts import FIRST, LoadTimes, StartRules

AT_HOME = -1
"""Stands among places, tasks and chargers for where a robot is to be in the end."""


def are_carried_out(problem: CoalitionProblem) -> bool:
    """Say whether plans have to be carried out to be timed: somebody may queue."""
    return are_charged(problem.batteries) or have_docks(problem.docks)


def charged_totals(problem: CoalitionProblem, plan: CoalitionPlan) -> tuple[float, float]:
    """Return what a plan is judged by if robots queue, and what leads a search.

    Both are in ticks, infinite if somebody runs dry, and count with who queues at chargers, and
    where loads are taken up and unloaded.
    """
    told = charged_times(problem, plan)
    ends = [told.timed.end(task) if plan.size[task] else math.inf for task in range(len(plan.size))]
    return totals_of(problem, ends, told.back, sum(told.walked))


def totals_of(
    problem: CoalitionProblem, ends: Sequence[float], back: Sequence[float], travel: float
) -> tuple[float, float]:
    """Return what a plan is judged by, and that with what leads, by its ends and homes, in ticks.

    Tasks that are left out end at no time (infinite).
    """
    misses = problem.misses
    has_end = can_miss(misses)
    missed = [has_end and end > misses.until[0] for end in ends]
    judged = sum(int(misses.judged[task]) for task, is_so in enumerate(missed) if is_so)
    leads = sum(int(misses.leads[task]) for task, is_so in enumerate(missed) if is_so)
    makespan, home = max(back), sum(back)
    if not have_weights(problem.links):
        return makespan + judged, makespan + home / (SPREAD * len(back)) + leads
    if math.isinf(makespan) or any(
        math.isinf(end) and not is_so for end, is_so in zip(ends, missed, strict=True)
    ):
        return math.inf, math.inf
    weight, parts = problem.links.weight, [0.0] * PARTS
    parts[MAKESPAN], parts[TRAVEL] = makespan, travel
    for task, end in enumerate(ends):
        if missed[task]:
            continue
        own, late = problem.links.task_weight[task], max(0.0, end - problem.due[task])
        parts[TARDINESS] += int(own * late)
        parts[MAX_TARDINESS] = max(parts[MAX_TARDINESS], late)
        parts[COMPLETION] += int(own * end)
    cost = sum(float(weight[part]) * parts[part] for part in range(PARTS))
    return cost + judged, cost + float(weight[HOME]) * home + leads


def _battery(batteries: Batteries, kind: int) -> Battery | None:
    """Return the battery of a kind of robots as the plain rule has it; None if it has none."""
    lasts = int(batteries.lasts[kind])
    if lasts == ENDLESS:
        return None
    fills, waiting = batteries.fills[kind], float(batteries.waiting[kind])
    return Battery(lasts, float(fills) * lasts, serving=1.0, waiting=waiting)


def _ways_of(problem: CoalitionProblem) -> Callable[[int, Hashable, Hashable], float]:
    """Return who says how long a robot takes between places, tasks, chargers and its home."""
    batteries, tasks, places = problem.batteries, len(problem.needs), problem.ways.shape[1]

    def way(robot: int, here: Hashable, there: Hashable) -> float:
        assert isinstance(here, int), "places are numbers"
        assert isinstance(there, int), "places are numbers"
        pace, kind = problem.pace[robot], problem.kind[robot]
        if here < places and there == AT_HOME:
            return int(problem.home[kind, here])
        if there == AT_HOME:
            return int(batteries.fro[kind, here - places, tasks])
        if here < places and there >= places:
            return int(batteries.to[pace, here, there - places])
        if there >= places:
            return int(batteries.between[pace, here - places, there - places])
        if here >= places:
            return int(batteries.fro[kind, here - places, there])
        return int(problem.ways[pace, here, there])

    return way


def charged_times(problem: CoalitionProblem, plan: CoalitionPlan) -> ChargedTimes:
    """Return the times of a plan in ticks if robots queue."""
    batteries, tasks, places = problem.batteries, len(problem.needs), problem.ways.shape[1]
    order = [task for task in plan.order.tolist() if plan.size[task] > 0]
    robots, way = range(problem.bodies), _ways_of(problem)

    def site(robot: int, before: int) -> int:
        return int(problem.site[problem.origin[robot] if before == FIRST else before])

    def takes(task: int, robots: Sequence[int]) -> float:
        slower = problem.slower[problem.pace[list(robots)], task].max(initial=0)
        return int(problem.duration[task] + slower)

    before = {
        task: [other for other in row if other != NOBODY and plan.size[other] > 0]
        for task, row in enumerate(problem.before.tolist())
        if row[0] != NOBODY
    }
    charged, docks = are_charged(batteries), problem.docks
    own = [_battery(batteries, problem.kind[robot]) if charged else None for robot in robots]
    lifting = {task: int(docks.lifting[task]) for task in order if have_docks(docks)}
    lifting = {task: takes for task, takes in lifting.items() if takes >= 0}

    def carried(task: int, robots: Sequence[int]) -> float:
        return takes(task, robots) - int(docks.lifting[task] + docks.unloading[task])

    chargers = [places + charger for charger in range(len(batteries.room))]
    origin = problem.origin[: problem.bodies].tolist()
    free = [int(problem.ready[place - tasks]) for place in origin]
    rules = StartRules(
        way, site, takes, free, dict(enumerate(problem.release.tolist())), before,
        gaps=gaps_as_told(problem.links, order),
        forming=int(problem.forming[0]),
        rotas=rotas_as_told(problem.rotas, problem.kind[: problem.bodies]),
        rooms=rooms_of_docks(docks) if have_docks(docks) else rooms_of_permits(problem),
        loads=LoadTimes(lifting, {task: int(docks.unloading[task]) for task in lifting}, carried),
    )  # fmt: skip
    standing = ChargeStart(
        places=origin,
        left=batteries.left[: problem.bodies].tolist() if charged else [math.inf] * len(own),
        taken=[(charger, until) for charger, until in batteries.taken.tolist()],
        task_places=dict(zip(order, order, strict=True)),
        task_ends=dict(zip(order, order, strict=True)),
        homes=[AT_HOME] * len(own),
        spends=[batteries.spends[problem.kind[robot]].tolist() for robot in robots if charged],
        serves=[batteries.serves[problem.kind[robot]].tolist() for robot in robots if charged],
        services=batteries.services.tolist(),
    )
    charging = ChargeRules(own, chargers, batteries.room.tolist(), way)
    coalitions = {
        task: [r for r in plan.coalition[task, : plan.size[task]].tolist() if r < problem.bodies]
        for task in order
    }
    return time_charged(rules, charging, standing, order, coalitions)
