"""The coalition problem in ticks of what is left of a mission in continuous time."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from teamformer.mission.checks.costs import judged_by
from teamformer.mission.checks.windows import latest_end
from teamformer.mission.parts.roads import Roads
from teamformer.mission.parts.shifts import ALWAYS
from teamformer.planning.continuous.posing.batteries import (
    ChargedClock,
    batteries_of,
    kinds_apart,
)
from teamformer.planning.continuous.posing.remaining import Remaining
from teamformer.planning.continuous.posing.tables import has_detour
from teamformer.planning.continuous.posing.ticks import Ticks, rounding_of
from teamformer.planning.problem.coalition_problem import (
    NEVER,
    SPARES,
    CoalitionProblem,
    pose_problem,
)
from teamformer.planning.problem.docks import docks_of
from teamformer.planning.problem.links import PART_OF, Link, Links, link_tasks
from teamformer.planning.problem.misses import Misses, misses_of
from teamformer.planning.problem.permits import Permits, block, permits_of
from teamformer.planning.problem.rotas import rotas_in_ticks
from teamformer.world.rules.starts import RoomLeft


def problem_of(rest: Remaining, ticks: Ticks, charging: ChargedClock | None) -> CoalitionProblem:
    """Return the problem, in ticks that are counted from the present."""
    mission, now, scale = rest.mission, rest.known.now, ticks.scale
    permits = permits_of(_rooms_in_searches(rest), len(rest.tasks), now)
    rotas = [robot.rota for robot in rest.own_robots]
    different = list(dict.fromkeys(rotas))
    apart = kinds_apart(rest.known, rest.robots, [different.index(rota) for rota in rotas])
    starts = zip(rest.own_tasks, np.add(rest.latest, rest.takes).tolist(), strict=True)
    due = [min(latest_end(task.between), latest) for task, latest in starts]
    problem = pose_problem(
        **_with_permits(rest, ticks, permits),
        duration=ticks.of(rest.takes),
        release=ticks.of([begin - now for begin in rest.release]),
        due=[NEVER if math.isinf(end) else round((end - now) * scale) for end in due],
        precedence=[(k, task) for task, others in rest.before.items() for k in others],
        forming=round(mission.forming * scale),
        spares=SPARES if _may_spare_pay(rest) else 0,
        apart=[*apart, *[-1] * permits.number],
        rotas=rotas_in_ticks(
            [rota.counted_from(now) for rota in [*rotas, *[ALWAYS] * permits.number]],
            lambda when: round(when * scale),
            round(ticks.never * scale),
            rounding_of(len(rest.tasks)),
        ),
        permits=permits.number,
    )
    if any(robot.battery for robot in rest.own_robots):
        assert charging is not None, "somebody has a battery"
        batteries = batteries_of(charging, problem, rest.places, now, ticks.of)
        problem = problem._replace(batteries=batteries)
    docks = docks_of(
        rest.rooms,
        [-1.0 if task.to is None else task.duration for task in rest.own_tasks],
        [task.unload for task in rest.own_tasks],
        ticks.of,
        now,
    )
    problem = problem._replace(docks=docks)
    if mission.until is not None:
        problem = problem._replace(misses=_misses(rest, mission.until, ticks, problem))
    if judged_by(mission) is not None or rest.gaps:
        problem = problem._replace(links=_links(rest, scale))
    return problem


def _rooms_in_searches(rest: Remaining) -> list[RoomLeft]:
    """Return the rooms that searches count with: loads take none there."""
    loads = {number for number, task in enumerate(rest.own_tasks) if task.to is not None}
    kept = (room._replace(tasks=room.tasks - loads) for room in rest.rooms)
    return [room for room in kept if room.tasks]


def _with_permits(rest: Remaining, ticks: Ticks, permits: Permits) -> dict[str, Any]:
    """Return what a problem has by robots and places: permits are behind robots.

    They have a pace and depots of their own, and no ways.
    """
    slower = np.maximum(0, ticks.of(rest.carry) - ticks.of(rest.carried))
    free, depot_of = np.unique(permits.free, return_inverse=True)
    new, more, paces = permits.number, len(free), len(rest.ways)
    one = min(1, new)
    last = 1 + int(rest.site.max())
    return {
        "ways": np.pad(ticks.of(rest.ways), ((0, one), (0, more), (0, 0))),
        "home": np.pad(ticks.of(rest.home), ((0, new), (0, more))),
        "slower": np.pad(slower, ((0, one), (0, 0))),
        "pace": [*rest.pace, *[paces] * new],
        "origin": [*rest.origin, *(len(rest.places) + depot_of).tolist()],
        "counts": block(rest.counts, permits.counts),
        "needs": np.hstack([rest.needs, permits.needs]),
        "site": [*rest.site, *range(last, last + more)],
        "ready": [*ticks.of(rest.ready), *ticks.of(free - rest.known.now)],
    }


def _may_spare_pay(rest: Remaining) -> bool:
    """Say whether it may pay that a robot takes part in a task that can be done without it.

    It forms no coalition later if it comes along; or the way by the task is the quicker one, as it
    may be on roads, or the one that costs less, as nothing does on which a load is carried.
    """
    mission, takes = rest.mission, rest.takes
    is_road, has_loads = isinstance(mission.world, Roads), any(t.to for t in rest.own_tasks)
    costs_travel = mission.cost is not None and mission.cost.get("travel", 0.0) > 0
    if mission.forming > 0:
        return True
    if costs_travel and (is_road or has_loads):
        return has_detour(rest.ways, rest.home, rest.pace, np.zeros_like(takes))
    return is_road and has_detour(rest.ways, rest.home, rest.pace, takes)


def _links(rest: Remaining, scale: float) -> Links:
    """Return the gaps between starts of tasks, and the weights of the mission's cost.

    The longest gaps are longer by what ticks round, so that one which is just long enough is.
    """
    tasks = rest.own_tasks
    rounding = rounding_of(len(tasks))
    links = [
        Link(task, other, round(least * scale), round(most * scale) + rounding)
        for task, other, least, most in rest.gaps
    ]
    weights = judged_by(rest.mission) or {"makespan": 1}
    total = sum(weights.values())
    weight = {PART_OF[name]: w / total for name, w in weights.items() if name in PART_OF}
    by_task = [task.weight for task in tasks]
    return link_tasks(len(tasks), len(rest.robots), links, weight, by_task)


def _misses(rest: Remaining, until: float, ticks: Ticks, problem: CoalitionProblem) -> Misses:
    """Return what is missed of tasks when the mission is over; ends are rounded, so it is later."""
    mission, tasks = rest.mission, rest.own_tasks
    weights = judged_by(mission) or {}
    end = int(ticks.of(max(0.0, until - rest.known.now))) + rounding_of(len(tasks))
    most = end + int(problem.home.max()) + 1
    leg = int(problem.duration.mean() + problem.ways[0].mean())
    price = weights.get("missed", 0.0) / max(1.0, sum(weights.values())) * float(ticks.of(1.0))
    return misses_of(mission, tasks, end, most, leg, price)
