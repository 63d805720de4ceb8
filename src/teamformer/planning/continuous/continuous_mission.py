"""A mission in continuous time as a coalition problem, and plans of it in the mission's unit."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from teamformer.base.errors import TeamformerError
from teamformer.mission.checks.costs import judged_by, weighed
from teamformer.mission.checks.optional import is_in_time
from teamformer.mission.coordination import Known, Plan, known_at_start
from teamformer.mission.model import Mission
from teamformer.planning.continuous.posing.batteries import charged_clock
from teamformer.planning.continuous.posing.problem import problem_of
from teamformer.planning.continuous.posing.remaining import remaining_at
from teamformer.planning.continuous.posing.ticks import (
    WHOLE,
    grain_of,
    rounding_in,
    rounding_of,
    ticks_of,
)
from teamformer.planning.continuous.posing.times import TaskClock
from teamformer.planning.continuous.solve import Solution
from teamformer.planning.problem.batteries import are_charged
from teamformer.planning.problem.coalition_plan import (
    CoalitionPlan,
    empty_plan,
    without_spares,
    without_tasks,
)
from teamformer.planning.problem.coalition_problem import CoalitionProblem
from teamformer.planning.problem.links import have_weights
from teamformer.planning.problem.misses import can_miss
from teamformer.planning.problem.permits import deal_permits, of_robots, without_permits
from teamformer.planning.problem.routes import MissionPlan
from teamformer.planning.problem.schedule import schedule_of


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
    grain: int  # the ticks of which all times are multiples
    problem: CoalitionProblem

    def as_bound(self, ticks: float) -> float:
        """Return a bound in ticks in the mission's unit: no plan is over before that has passed."""
        whole = math.ceil((ticks - self.rounding) / self.grain - WHOLE) * self.grain
        return max(0.0, whole / self.scale)

    def tell(self, solution: Solution) -> MissionPlan:
        """Return a solution in the mission's unit; its times are worked out from the true ways.

        In ticks every way and duration is rounded, by half a tick at most; the bound allows for it.
        """
        timed = self.time(self.in_turn(solution.plan))
        bound = self.now + self.as_bound(solution.bound)
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
        counts, needs = of_robots(self.problem)
        for task, coalition in zip(plan.order, plan.coalitions, strict=True):
            kept = without_spares(counts, needs[task], coalition)
            robots = coalition if is_kept else kept
            made.size[task] = len(robots)
            made.coalition[task, : len(robots)] = robots
        deal_permits(self.problem, made, self._ends_in_ticks(made))
        return made

    def _ends_in_ticks(self, plan: CoalitionPlan) -> dict[int, float]:
        """Return when the tasks of a plan end, counted from the present."""
        stops = (stop for route in self.time(plan).routes for stop in route.stops)
        return {stop.task: (stop.end - self.now) * self.scale for stop in stops}

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
        return self.clock.time(without_permits(self.problem, plan))

    def in_turn(self, plan: CoalitionPlan) -> CoalitionPlan:
        """Return a plan of robots only, whose tasks are in the order in which they begin.

        In that order they enter zones. Optional tasks that would be missed are not in it.
        """
        if self.clock.rest.rooms and not have_weights(self.problem.links):  # else it is so already
            starts = schedule_of(self.problem, plan).start[plan.order]
            order = plan.order[np.argsort(starts, kind="stable")]
            plan = plan._replace(order=order)
        return self.in_time(without_permits(self.problem, plan))

    def in_time(self, plan: CoalitionPlan) -> CoalitionPlan:
        """Return a plan without optional tasks that would be missed, be it by a rounding.

        So are those that come after one that is left out.
        """
        misses, until = self.problem.misses, self.source.until
        if not can_miss(misses):
            return plan
        plan = without_tasks(self.problem.before, plan, ())
        ends = {stop.task: stop.end for route in self.time(plan).routes for stop in route.stops}
        late = [k for k, end in ends.items() if misses.optional[k] and not is_in_time(end, until)]
        return self.in_time(without_tasks(self.problem.before, plan, late)) if late else plan

    def as_plan(self, found: CoalitionPlan, made_from: str = "") -> Plan:
        """Return a plan in the numbers of the mission, with the time at which each task ends.

        Tasks that are left out are not in it, nor those that nobody gets to, or not before shifts
        are over. Who runs dry is known only as it runs.
        """
        found = self.in_turn(found)
        routes = self.time(found).routes
        ends = {stop.task: stop.end for route in routes for stop in route.stops}
        drops = any(robot.rota for robot in self.clock.rest.own_robots) or not are_charged(
            self.problem.batteries
        )
        kept = [task for task in found.order.tolist() if found.size[task] > 0]
        order = [task for task in kept if not drops or math.isfinite(ends.get(task, math.inf))]
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
    rest = remaining_at(known, numbers, chosen)
    ticks, charging = ticks_of(rest), charged_clock(known, numbers, chosen)
    return ContinuousMission(
        source=known.mission,
        now=known.now,
        robots=rest.robots,
        tasks=rest.tasks,
        clock=TaskClock(rest, charging),
        scale=ticks.scale,
        rounding=rounding_in(rest, ticks.scale),
        grain=grain_of(rest, ticks.scale),
        problem=problem_of(rest, ticks, charging),
    )


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
