"""A mission in continuous time as a coalition problem, and plans of it in the mission's unit."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from teamformer.base.array_types import Floats, Ints
from teamformer.base.errors import TeamformerError
from teamformer.mission.checks.costs import judged_by, weighed
from teamformer.mission.checks.links import is_linked
from teamformer.mission.checks.windows import release_of
from teamformer.mission.coordination import Plan
from teamformer.mission.keys.mission_keys import HOME as ENDS_HOME
from teamformer.mission.model import Mission
from teamformer.mission.parts.grid import Grid, Place
from teamformer.mission.parts.roads import AIR, Roads
from teamformer.mission.precedence import tasks_before
from teamformer.planning.continuous.solve import Solution
from teamformer.planning.continuous.times import TaskClock
from teamformer.planning.problem.coalition_plan import CoalitionPlan, empty_plan, without_spares
from teamformer.planning.problem.coalition_problem import (
    NEVER,
    SPARES,
    CoalitionProblem,
    pose_problem,
)
from teamformer.planning.problem.links import PART_OF, Link, Links, have_weights, link_tasks
from teamformer.planning.problem.relaxed_problem import count_table, least_carried
from teamformer.planning.problem.routes import MissionPlan
from teamformer.planning.problem.ways import ends_of
from teamformer.world.rules.distances import UNREACHABLE, straight_ways, travel_matrix

MOST_TICKS, MOST_WITH_WAITS = 2 * 10**9, 10**12
"""About how many ticks everything takes at most, one task after the other: all that is done, and
that with waiting for the last window to begin."""

MOST_WEIGHT = 10**6
"""Tasks that weigh more together have fewer ticks: what they cost has to stay a whole number."""

STRAIGHT = 1 - 1e-9
"""A way is shorter than another if it is by more than what rounding makes of equal ones."""

NO_WAY = 1000
"""Where no way is, it takes this many times longer than everything."""


@dataclass(frozen=True)
class ContinuousMission:
    """A mission's times as they are, and in ticks, of which there are `scale` in a unit."""

    source: Mission
    ways: Floats  # (paces, places, tasks) from places, which are tasks and starts, to tasks
    home: Floats  # (robots, places)
    origin: Ints  # (robots,) the place where each starts
    pace: Ints  # (robots,) row of `ways`
    carry: Floats  # (paces, tasks) how long a load is carried; 0 for other tasks
    scale: float
    problem: CoalitionProblem

    def tell(self, solution: Solution) -> MissionPlan:
        """Return a solution in the mission's unit; its times are worked out from the true ways.

        In ticks every way and duration is rounded, by half a tick at most; the bound allows for it.
        """
        timed = self.time(solution.plan)
        rounding = rounding_of(self.source)
        bound = max(0.0, (solution.bound - rounding) / self.scale)
        return replace(
            timed,
            bound=min(timed.makespan, bound),
            is_proven=solution.is_proven,
            curve=self._curve_of(solution),
        )

    def as_arrays(self, plan: Plan, with_spares: bool = False) -> CoalitionPlan:
        """Return a plan of all tasks as searches have it.

        Nobody is in it who can be spared, unless that may pay, or it is wanted `with_spares`.
        """
        made = empty_plan(self.problem)
        made.order[:] = plan.order
        is_kept = with_spares or self.problem.spares > 0
        for task, coalition in zip(plan.order, plan.coalitions, strict=True):
            needs = self.problem.needs[task]
            kept = without_spares(self.problem.counts, needs, coalition)
            robots = coalition if is_kept else kept
            made.size[task] = len(robots)
            made.coalition[task, : len(robots)] = robots
        return made

    def worth_of(self, plan: MissionPlan) -> float:
        """Return what a plan is judged by: what it costs, or its makespan if that alone counts."""
        weights = judged_by(self.source)
        if plan.cost is not None or weights is None:
            return plan.makespan if plan.cost is None else plan.cost
        ends = {stop.task: stop.end for route in plan.routes for stop in route.stops}
        return weighed(self.source, weights, ends, plan.makespan)

    def _curve_of(self, solution: Solution) -> tuple[tuple[float, float], ...]:
        """Return a curve in units; that of a linked problem without a cost is none of times."""
        if have_weights(self.problem.links) and self.source.cost is None:
            return ()
        return tuple((seconds, ticks / self.scale) for seconds, ticks in solution.curve)

    def time(self, plan: CoalitionPlan) -> MissionPlan:
        """Return a plan with its times by the mission's rules."""
        parts = (self.ways, self.home, self.pace, self.origin, self.problem.site, self.carry)
        return TaskClock(self.source, *parts).time(plan)


def pose_mission(mission: Mission) -> ContinuousMission:
    """Return a mission in continuous time as a problem in ticks."""
    robots, tasks = mission.robots, mission.tasks
    starts = list(dict.fromkeys(robot.at for robot in robots))
    places = [*ends_of(tasks), *starts]
    paces = sorted({(robot.moves, robot.speed) for robot in robots})
    pace = np.array([paces.index((robot.moves, robot.speed)) for robot in robots])
    begins = [task.at for task in tasks]
    metres = {moves: _distances(mission, moves, places, begins) for moves, _ in paces}
    ways = np.array([metres[moves] / speed for moves, speed in paces])
    carry = np.array([metres[moves].diagonal() / speed for moves, speed in paces])
    carry[:, [task.to is None for task in tasks]] = 0.0
    np.einsum("pkk->pk", ways[:, : len(tasks)])[:] = 0.0  # not the way from an end to a beginning
    home = _ways_home(mission, places)
    busy, waits = _longest(mission, ways, home, carry)
    scale = _scale(busy, waits, sum(task.weight for task in tasks))

    def ticks(times: npt.ArrayLike) -> Ints:
        known = np.where(np.isfinite(times), times, NO_WAY * (busy + waits))
        return np.rint(known * scale).astype(np.int64)

    counts = count_table([robot.can for robot in robots], mission)
    needs = count_table([task.needs for task in tasks], mission)
    carried = np.array([least_carried(counts, carry[pace, k], needs[k]) for k in range(len(tasks))])
    takes = np.array([task.duration + task.unload for task in tasks]) + carried
    origin = np.array([len(tasks) + starts.index(robot.at) for robot in robots])
    problem = pose_problem(
        ways=ticks(ways),
        home=ticks(home),
        pace=pace,
        origin=origin,
        counts=counts,
        needs=needs,
        duration=ticks(takes),
        slower=np.maximum(0, ticks(carry) - ticks(carried)),
        release=ticks([release_of(task) for task in tasks]),
        due=[NEVER if task.between is None else round(task.between[1] * scale) for task in tasks],
        precedence=[(k, task) for task, before in tasks_before(tasks).items() for k in before],
        forming=round(mission.forming * scale),
        spares=SPARES if _may_spare_pay(mission, ways, home, pace, takes) else 0,
        site=np.unique(np.array(places, np.float64), axis=0, return_inverse=True)[1].ravel(),
    )
    if is_linked(mission):
        problem = problem._replace(links=_links(mission, scale))
    return ContinuousMission(
        source=mission,
        ways=ways,
        home=home,
        origin=origin,
        pace=pace,
        carry=carry,
        scale=scale,
        problem=problem,
    )


def rounding_of(mission: Mission) -> int:
    """Return by how many ticks a time may be off: what is rounded in a chain, half a tick each."""
    return len(mission.tasks) + 2


def _may_spare_pay(mission: Mission, ways: Floats, home: Floats, pace: Ints, takes: Floats) -> bool:
    """Say whether it may pay that a robot takes part in a task that can be done without it.

    It forms no coalition later if it comes along; or the way by the task is the quicker one, as it
    may be on roads, or the one that costs less, as nothing does on which a load is carried.
    """
    is_road, has_loads = isinstance(mission.world, Roads), any(t.to for t in mission.tasks)
    costs_travel = mission.cost is not None and mission.cost.get("travel", 0.0) > 0
    if mission.forming > 0:
        return True
    if costs_travel and (is_road or has_loads):
        return _has_detour(ways, home, pace, np.zeros_like(takes))
    return is_road and _has_detour(ways, home, pace, takes)


def _has_detour(ways: Floats, home: Floats, pace: Ints, takes: Floats) -> bool:
    """Say whether some way by a task, which takes so long, is shorter than the straight one."""
    for task, spent in enumerate(takes):
        by_task = ways[:, :, task] + spent  # (paces, places)
        is_shorter = by_task[:, :, None] + ways[:, None, task] < ways * STRAIGHT
        back = by_task[pace] + home[:, task, None]  # (robots, places)
        if is_shorter.any() or (back < home * STRAIGHT).any():
            return True
    return False


def _links(mission: Mission, scale: float) -> Links:
    """Return a mission's linked starts and the weights of its cost.

    The longest gaps are longer by what ticks round, so that one which is just long enough is.
    """
    number_of = {task.name: number for number, task in enumerate(mission.tasks)}
    rounding = rounding_of(mission)
    links = [
        Link(number, number_of[name], round(least * scale), round(most * scale) + rounding)
        for number, task in enumerate(mission.tasks)
        for name, (least, most) in task.starts.items()
    ]
    weights = judged_by(mission) or {"makespan": 1}
    total = sum(weights.values())
    weight = {PART_OF[name]: value / total for name, value in weights.items()}
    sizes = (len(mission.tasks), len(mission.robots))
    return link_tasks(*sizes, links, weight, [task.weight for task in mission.tasks])


def refuse_no_way(mission: ContinuousMission, plan: MissionPlan) -> None:
    """Refuse a plan in which somebody goes where no way leads.

    That each task has robots who can get there was seen to before; but tasks that are linked may
    need the same ones.
    """
    if math.isinf(plan.makespan):
        raise TeamformerError(
            f"{mission.source.name}: no plan was found in which all can get to their tasks",
            "open the map, give ways a time under roads, move robots or tasks, or drop a link",
        )


def _distances(
    mission: Mission, moves: str, origins: Sequence[Place], goals: Sequence[Place]
) -> Floats:
    """Return how long ways take at speed 1, as (origins, goals); infinite where there is none."""
    world = mission.world
    if isinstance(world, Roads):
        here, there = ([int(number) for number, _ in some] for some in (origins, goals))
        return np.array(world.ways[moves])[np.ix_(here, there)]
    if not isinstance(world, Grid):
        return straight_ways(origins, goals)
    is_in_the_way = moves != AIR and world.rows
    cells = travel_matrix(world if is_in_the_way else replace(world, rows=()), origins, goals)
    return np.where(cells < UNREACHABLE, cells.astype(np.float64), np.inf)


def _ways_home(mission: Mission, places: Sequence[Place]) -> Floats:
    """Return how long each robot takes home from each place, (robots, places)."""
    robots, ends = mission.robots, mission.ends
    if ends is None:
        return np.zeros((len(robots), len(places)))
    home = {(r.moves, r.at if ends == ENDS_HOME else ends): np.empty(0) for r in robots}
    for moves, goal in home:
        assert not isinstance(goal, str)
        home[moves, goal] = _distances(mission, moves, places, [goal])[:, 0]
    return np.array([home[r.moves, r.at if ends == ENDS_HOME else ends] / r.speed for r in robots])


def _longest(mission: Mission, ways: Floats, home: Floats, carry: Floats) -> tuple[float, float]:
    """Return how long all that is done takes at most, and when the last task may begin."""
    longest = max(part[np.isfinite(part)].max(initial=0.0) for part in (ways, home))
    total = sum(task.duration + task.unload + mission.forming for task in mission.tasks)
    total += float(carry.max(axis=0).sum())
    total += longest * (len(mission.tasks) + 1) + 1e-6
    return total, max(release_of(task) for task in mission.tasks)


def _scale(busy: float, waits: float, weight: float) -> float:
    """Return a power of ten: as many ticks in a unit as there may be of all times together.

    One window that begins long after all else does not make what is done before it coarse.
    `weight` is that of all tasks.
    """
    most, scale = MOST_WITH_WAITS / max(1.0, weight / MOST_WEIGHT), 1e-6
    while 10 * scale * busy <= MOST_TICKS and 10 * scale * (busy + waits) <= most:
        scale *= 10
    return scale
