"""A mission in continuous time as a coalition problem, and plans of it in the mission's unit."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from teamformer.base.array_types import Floats, Ints
from teamformer.base.errors import TeamformerError
from teamformer.mission.checks.costs import judged_by, weighed
from teamformer.mission.checks.optional import is_in_time
from teamformer.mission.checks.windows import latest_end
from teamformer.mission.coordination import Known, Plan, known_at_start
from teamformer.mission.model import Mission, Task
from teamformer.mission.parts.roads import Roads
from teamformer.mission.parts.shifts import rotas_of
from teamformer.planning.continuous.batteries import (
    batteries_of,
    by_ability,
    charged_clock,
    kinds_apart,
)
from teamformer.planning.continuous.solve import Solution
from teamformer.planning.continuous.tables import (
    has_detour,
    longest_of,
    ticks_in_a_unit,
    ways_by_pace,
    ways_home,
)
from teamformer.planning.continuous.times import TaskClock
from teamformer.planning.problem.coalition_plan import (
    CoalitionPlan,
    empty_plan,
    without_spares,
    without_tasks,
)
from teamformer.planning.problem.coalition_problem import (
    NEVER,
    SPARES,
    CoalitionProblem,
    pose_problem,
)
from teamformer.planning.problem.links import PART_OF, Link, Links, have_weights, link_tasks
from teamformer.planning.problem.misses import Misses, can_miss, misses_of
from teamformer.planning.problem.relaxed_problem import count_table, least_carried
from teamformer.planning.problem.rotas import longest_pauses, rotas_in_ticks
from teamformer.planning.problem.routes import MissionPlan
from teamformer.planning.problem.ways import ends_of
from teamformer.world.rules.starts import Gap
from teamformer.world.rules.waits import Waits, waits_at

WHOLE = 1e-6
"""By how much of a tick a time may be off that counts as whole."""

NO_WAY = 1000
"""Where no way is, it takes this many times longer than everything."""


@dataclass(frozen=True)
class ContinuousMission:
    """What is left of a mission, as it is, and in ticks, of which there are `scale` in a unit.

    A time in ticks is off by no more than `rounding`: by nothing if all times are whole ticks.
    """

    source: Mission
    now: float  # from when on ticks are counted
    robots: tuple[int, ...]  # the numbers that those of the problem have in the mission
    tasks: tuple[int, ...]
    clock: TaskClock  # its times as they are
    scale: float
    rounding: int
    problem: CoalitionProblem

    def tell(self, solution: Solution) -> MissionPlan:
        """Return a solution in the mission's unit; its times are worked out from the true ways.

        In ticks every way and duration is rounded, by half a tick at most; the bound allows for it.
        """
        timed = self.time(self.in_time(solution.plan))
        bound = self.now + max(0.0, (solution.bound - self.rounding) / self.scale)
        if timed.missed:
            bound = self.now
        return replace(
            timed,
            bound=min(timed.makespan, bound),
            least_cost=self._least_cost_of(solution, timed.cost),
            is_proven=solution.is_proven,
            curve=self._curve_of(solution),
        )

    def as_arrays(self, plan: Plan, with_spares: bool = False) -> CoalitionPlan:
        """Return a plan of all tasks as searches have it.

        Nobody is in it who can be spared, unless that may pay, or it is wanted `with_spares`.
        """
        made = empty_plan(self.problem)
        left_out = sorted(set(range(len(self.tasks))).difference(plan.order))
        made.order[:] = [*plan.order, *left_out]
        is_kept = with_spares or self.problem.spares > 0
        for task, coalition in zip(plan.order, plan.coalitions, strict=True):
            needs = self.problem.needs[task]
            kept = without_spares(self.problem.counts, needs, coalition)
            robots = coalition if is_kept else kept
            made.size[task] = len(robots)
            made.coalition[task, : len(robots)] = robots
        return made

    def rank_of(self, plan: MissionPlan) -> tuple[float, float, float]:
        """Return what plans are compared by: what must be done and is missed, what else is, worth.

        If the mission has a cost, that has what else is missed.
        """
        left_out = [self.tasks[task] for task in plan.missed]
        tasks = self.source.tasks
        must = sum(not tasks[task].optional for task in left_out)
        may = sum(tasks[task].weight for task in left_out if tasks[task].optional)
        return must, 0.0 if self.source.cost else may, self.worth_of(plan)

    def worth_of(self, plan: MissionPlan) -> float:
        """Return what a plan is judged by: what it costs, or its makespan if that alone counts."""
        weights = judged_by(self.source)
        if plan.cost is not None or weights is None:
            return plan.makespan if plan.cost is None else plan.cost
        ends = {stop.task: stop.end for route in plan.routes for stop in route.stops}
        return weighed(self.source, weights, ends, plan.makespan)

    def _least_cost_of(self, solution: Solution, cost: float | None) -> float | None:
        """Return what no plan costs less than; every part of it may be rounded by some ticks."""
        if cost is None:
            return None
        links, parts = self.problem.links, len(self.robots) * (1 + len(self.tasks))
        rounding = rounding_of(len(self.tasks)) * (parts + float(links.task_weight.sum()))
        least = solution.least_cost - rounding * float(links.weight.sum())
        return min(cost, max(0.0, least / self.scale))

    def _curve_of(self, solution: Solution) -> tuple[tuple[float, float], ...]:
        """Return a curve in units; that of a linked problem without a cost is none of times."""
        if have_weights(self.problem.links) and self.source.cost is None:
            return ()
        return tuple((seconds, ticks / self.scale) for seconds, ticks in solution.curve)

    def time(self, plan: CoalitionPlan) -> MissionPlan:
        """Return a plan with its times by the mission's rules, in the numbers of the problem."""
        return self.clock.time(plan)

    def in_time(self, plan: CoalitionPlan) -> CoalitionPlan:
        """Return a plan without optional tasks that would be missed, be it by a rounding."""
        misses, until = self.problem.misses, self.source.until
        if not can_miss(misses):
            return plan
        ends = {stop.task: stop.end for route in self.time(plan).routes for stop in route.stops}
        late = [k for k, end in ends.items() if misses.optional[k] and not is_in_time(end, until)]
        return self.in_time(without_tasks(self.problem, plan, late)) if late else plan

    def as_plan(self, found: CoalitionPlan, made_from: str = "") -> Plan:
        """Return a plan in the numbers of the mission, with the time at which each task ends.

        Tasks that are left out are not in it, nor those that end at no time as shifts are over.
        """
        found = self.in_time(found)
        routes = self.time(found).routes
        ends = {stop.task: stop.end for route in routes for stop in route.stops}
        has_shifts = len(self.clock.rotas) > 0
        kept = [task for task in found.order.tolist() if found.size[task] > 0]
        order = [task for task in kept if not has_shifts or math.isfinite(ends[task])]
        is_done = all(math.isfinite(ends.get(task, math.inf)) for task in order)  # nobody runs dry
        return Plan(
            order=tuple(self.tasks[task] for task in order),
            coalitions=tuple(
                tuple(self.robots[r] for r in sorted(found.coalition[task, : found.size[task]]))
                for task in order
            ),
            ends=tuple(ends[task] for task in order) if is_done else (),
            made_from=made_from,
        )


def pose_mission(mission: Mission) -> ContinuousMission:
    """Return a mission in continuous time, from its start, as a problem in ticks."""
    robots, tasks = range(len(mission.robots)), range(len(mission.tasks))
    return _pose(known_at_start(mission), tuple(robots), tuple(tasks))


def pose_present(known: Known) -> ContinuousMission:
    """Return what is left to do at a moment, by the robots that are there, as a problem in ticks.

    Ticks are counted from then on. What is under way is not in it: its robots are free once it
    ends, and tasks after it begin later. A task whose start is linked with one that has begun may
    not begin too soon, and is late if it begins too late.
    """
    return _pose(known, known.robots, known.possible_tasks)


def _pose(known: Known, numbers: Sequence[int], chosen: Sequence[int]) -> ContinuousMission:
    """Return the problem that some tasks are for some robots, both by their numbers."""
    mission, now = known.mission, known.now
    robots = [mission.robots[robot] for robot in numbers]
    tasks = [mission.tasks[task] for task in chosen]
    depot_of = [(known.places[r], known.free_at[r] - now, known.came_from[r]) for r in numbers]
    depots = list(dict.fromkeys(depot_of))
    places = [*ends_of(tasks), *(place for place, _, _ in depots)]
    sites = [*ends_of(tasks), *(came_from for _, _, came_from in depots)]
    pace, ways, carry = ways_by_pace(mission, robots, tasks, places)
    home = ways_home(mission, robots, places)
    ready = [left for _, left, _ in depots]
    waits = waits_at(known, chosen)
    release = [waits.release[task] for task in chosen]
    number_of = {task: number for number, task in enumerate(chosen)}
    before, gaps = _renumbered(waits, number_of)
    busy = longest_of(tasks, mission.forming, ways, home, carry) + max(ready, default=0.0)
    different = list(dict.fromkeys(robot.rota for robot in robots))
    later = [robot.rota.counted_from(now) for robot in robots]
    longest_wait = max((begin - now for begin in release), default=0.0)
    longest_wait += longest_pauses(later, busy, len(tasks))
    scale = ticks_in_a_unit(busy, longest_wait, sum(task.weight for task in tasks))

    def ticks(times: npt.ArrayLike) -> Ints:
        finite = np.where(np.isfinite(times), times, NO_WAY * (busy + longest_wait))
        return np.rint(finite * scale).astype(np.int64)

    late = round(NO_WAY * (busy + longest_wait) * scale)
    counts = count_table([robot.can for robot in robots], mission)
    needs = count_table([task.needs for task in tasks], mission)
    counts, needs = by_ability(mission, numbers, chosen, counts, needs)
    carried = np.array([least_carried(counts, carry[pace, k], needs[k]) for k in range(len(tasks))])
    takes = np.array([task.duration + task.unload for task in tasks]) + carried
    due = [
        min(latest_end(tasks[number].between), waits.latest[task] + takes[number])
        for task, number in number_of.items()
    ]
    problem = pose_problem(
        ways=ticks(ways),
        home=ticks(home),
        pace=pace,
        origin=[len(tasks) + depots.index(depot) for depot in depot_of],
        counts=counts,
        needs=needs,
        duration=ticks(takes),
        slower=np.maximum(0, ticks(carry) - ticks(carried)),
        release=ticks([begin - now for begin in release]),
        due=[NEVER if math.isinf(end) else round((end - now) * scale) for end in due],
        precedence=[(k, task) for task, others in before.items() for k in others],
        forming=round(mission.forming * scale),
        spares=SPARES if _may_spare_pay(mission, tasks, ways, home, pace, takes) else 0,
        site=np.unique(np.array(sites, np.float64), axis=0, return_inverse=True)[1].ravel(),
        ready=ticks(ready),
        apart=kinds_apart(known, numbers, [different.index(robot.rota) for robot in robots]),
        rotas=rotas_in_ticks(
            later, lambda when: round(when * scale), late, rounding_of(len(tasks))
        ),
    )
    charging = charged_clock(known, numbers, chosen)
    if charging is not None:
        problem = problem._replace(batteries=batteries_of(charging, problem, places, now, ticks))
    if mission.until is not None:
        problem = problem._replace(misses=_misses(mission, now, tasks, ticks, problem))
    if judged_by(mission) is not None or gaps:
        problem = problem._replace(links=_links(mission, tasks, len(robots), gaps, scale))
    rotas = rotas_of(robots)
    times = (ways, home, carry, takes, ready, np.subtract(release, now), mission.forming)
    is_exact = not rotas and all(_are_whole(np.multiply(part, scale)) for part in times)
    clock = TaskClock(
        tasks=tasks,
        ways=ways,
        home=home,
        pace=pace,
        origin=np.asarray(problem.origin, np.int64),
        site=problem.site,
        carry=carry,
        free=[known.free_at[robot] for robot in numbers],
        release=release,
        before=before,
        gaps=gaps,
        forming=mission.forming,
        rotas=rotas,
        cost=mission.cost,
        charging=charging,
    )
    return ContinuousMission(
        source=mission,
        now=now,
        robots=tuple(numbers),
        tasks=tuple(chosen),
        clock=clock,
        scale=scale,
        rounding=0 if is_exact else rounding_of(len(tasks)),
        problem=problem,
    )


def _renumbered(
    waits: Waits, number_of: Mapping[int, int]
) -> tuple[dict[int, list[int]], list[Gap]]:
    """Return the tasks before each and the gaps between starts, in the numbers of a problem."""
    before = {number_of[k]: [number_of[o] for o in others] for k, others in waits.before.items()}
    gaps = [
        gap._replace(task=number_of[gap.task], other=number_of[gap.other]) for gap in waits.gaps
    ]
    return before, gaps


def _are_whole(ticks: Floats) -> bool:
    """Say whether times are whole ticks, but for what a product of two fractions is off by."""
    finite = ticks[np.isfinite(ticks)]
    return bool((np.abs(finite - np.rint(finite)) < WHOLE).all())


def rounding_of(tasks: int) -> int:
    """Return by how many ticks a time may be off: what is rounded in a chain, half a tick each."""
    return tasks + 2


def _may_spare_pay(
    mission: Mission,
    tasks: Sequence[Task],
    ways: Floats,
    home: Floats,
    pace: Ints,
    takes: Floats,
) -> bool:
    """Say whether it may pay that a robot takes part in a task that can be done without it.

    It forms no coalition later if it comes along; or the way by the task is the quicker one, as it
    may be on roads, or the one that costs less, as nothing does on which a load is carried.
    """
    is_road, has_loads = isinstance(mission.world, Roads), any(t.to for t in tasks)
    costs_travel = mission.cost is not None and mission.cost.get("travel", 0.0) > 0
    if mission.forming > 0:
        return True
    if costs_travel and (is_road or has_loads):
        return has_detour(ways, home, pace, np.zeros_like(takes))
    return is_road and has_detour(ways, home, pace, takes)


def _links(
    mission: Mission, tasks: Sequence[Task], robots: int, gaps: Sequence[Gap], scale: float
) -> Links:
    """Return the gaps between starts of tasks, and the weights of the mission's cost.

    The longest gaps are longer by what ticks round, so that one which is just long enough is.
    """
    rounding = rounding_of(len(tasks))
    links = [
        Link(task, other, round(least * scale), round(most * scale) + rounding)
        for task, other, least, most in gaps
    ]
    weights = judged_by(mission) or {"makespan": 1}
    total = sum(weights.values())
    weight = {PART_OF[name]: w / total for name, w in weights.items() if name in PART_OF}
    return link_tasks(len(tasks), robots, links, weight, [task.weight for task in tasks])


def _misses(
    mission: Mission,
    now: float,
    tasks: Sequence[Task],
    ticks: Callable[[npt.ArrayLike], Ints],
    problem: CoalitionProblem,
) -> Misses:
    """Return what is missed of tasks when the mission is over; ends are rounded, so it is later."""
    assert mission.until is not None, "the mission is over at a time"
    weights = judged_by(mission) or {}
    until = int(ticks(max(0.0, mission.until - now))) + rounding_of(len(tasks))
    most = until + int(problem.home.max()) + 1
    leg = int(problem.duration.mean() + problem.ways[0].mean())
    price = weights.get("missed", 0.0) / max(1.0, sum(weights.values())) * float(ticks(1.0))
    return misses_of(mission, tasks, until, most, leg, price)


def refuse_no_way(mission: ContinuousMission, plan: MissionPlan) -> None:
    """Refuse a plan in which somebody goes where no way leads.

    That each task has robots who can get there was seen to before; but tasks that are linked may
    need the same ones.
    """
    if math.isinf(plan.makespan):
        within, more = "", ""
        if any(robot.shifts for robot in mission.source.robots):
            within, more = " within their shifts", "lengthen shifts, have them come again (every), "
        raise TeamformerError(
            f"{mission.source.name}: no plan was found in which all can get to their tasks{within}",
            f"{more}open the map, give ways a time under roads, move robots or tasks, drop a link",
        )
