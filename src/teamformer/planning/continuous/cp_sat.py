"""Small problems solved and proven by CP-SAT: a circuit for each robot, a start for each task."""

from __future__ import annotations

import time
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from teamformer.base.array_types import Ints
from teamformer.base.import_apart import import_apart
from teamformer.planning.problem.coalition_plan import CoalitionPlan, empty_plan
from teamformer.planning.problem.coalition_problem import NEVER, NOBODY, CoalitionProblem
from teamformer.planning.problem.schedule import MAKESPAN, schedule_of
from teamformer.planning.relaxation.cp_sat import make_solver

if TYPE_CHECKING:
    from ortools.sat.python import cp_model

MOST_ARCS = 2500
"""Robots times pairs of tasks; beyond that a proof takes longer than anybody waits."""


@dataclass(frozen=True)
class Proof:
    """What CP-SAT found: a plan, if a better one, and ticks that no plan beats."""

    plan: CoalitionPlan | None
    bound: int


def is_small(problem: CoalitionProblem) -> bool:
    """Say whether it is worth trying to prove a plan; late tasks, forming, shifts are not in it."""
    arcs = len(problem.counts) * len(problem.needs) ** 2
    is_plain = (problem.due >= NEVER).all() and problem.forming[0] == 0
    return arcs <= MOST_ARCS and bool(is_plain) and not len(problem.rotas.every)


def solve_exactly(
    problem: CoalitionProblem,
    plan: CoalitionPlan,
    bound: int,
    seconds: float,
    is_large: bool = False,
) -> Proof:
    """Search with one thread of CP-SAT; return its best plan, if it finds one, and its bound.

    `plan` is its hint: who does what. If the problem `is_large`, the whole plan is the hint, and
    the bound comes from a linear relaxation. `seconds` include the time to pose the model.
    """
    begun = time.perf_counter()
    circuits = _Circuits(problem, bound, int(schedule_of(problem, plan).total[MAKESPAN]))
    circuits.hint(plan)
    if is_large:
        circuits.hint_ways(plan)
    from ortools.sat.python import cp_model

    solver = make_solver(seed=0)
    if is_large:
        solver.parameters.linearization_level = 2
    left = seconds - (time.perf_counter() - begun)
    solver.parameters.max_time_in_seconds = max(left, 0.01)
    status = solver.solve(circuits.model)
    if status == cp_model.INFEASIBLE:  # never: the hint is a plan
        return Proof(None, bound)
    least = max(bound, round(solver.best_objective_bound))
    if status not in (cp_model.OPTIMAL, cp_model.FEASIBLE):
        return Proof(None, least)
    return Proof(circuits.plan_of(solver), least)


class _Circuits:
    """The model: which robot goes from where to where, and when tasks start."""

    def __init__(self, problem: CoalitionProblem, bound: int, horizon: int) -> None:
        """Pose the model of plans that end by the horizon."""
        import_apart("ortools.sat.python.cp_model")
        from ortools.sat.python import cp_model

        self.problem, self.model = problem, cp_model.CpModel()
        tasks, robots = len(problem.needs), len(problem.counts)
        self.start = [
            self.model.new_int_var(int(problem.release[task]), horizon, f"start {task}")
            for task in range(tasks)
        ]
        self.end = [self._end(task, horizon) for task in range(tasks)]
        self.makespan = self.model.new_int_var(bound, horizon, "makespan")
        self.does = [
            [self.model.new_bool_var(f"{robot} does {task}") for task in range(tasks)]
            for robot in range(robots)
        ]
        self.goes: list[dict[tuple[int, int], cp_model.IntVar]] = []  # by robot, from node to node
        for robot in range(robots):
            self._route(robot)
        self._cover()
        for task in range(tasks):
            for other in problem.before[task][problem.before[task] != NOBODY]:
                self.model.add(self.start[task] >= self.end[other])
        self.model.minimize(self.makespan)

    def _end(self, task: int, horizon: int) -> cp_model.LinearExprT:
        """Return when a task ends; for a load that is up to who carries it."""
        if not self.problem.slower[:, task].any():
            return self.start[task] + int(self.problem.duration[task])
        return self.model.new_int_var(0, horizon, f"end {task}")

    def _route(self, robot: int) -> None:
        """Let a robot go from its start through its tasks and home; node 0 is start and home."""
        problem, model = self.problem, self.model
        tasks, pace, kind = len(self.start), problem.pace[robot], problem.kind[robot]
        origin = int(problem.origin[robot])
        ready = int(problem.ready[origin - tasks])
        arcs: list[tuple[int, int, cp_model.LiteralT]] = []
        ways: dict[tuple[int, int], cp_model.IntVar] = {}
        busy: list[cp_model.LinearExprT] = []  # ticks of the ways and tasks that the robot takes
        self.goes.append(ways)
        idle = ways[0, 0] = model.new_bool_var("")
        arcs.append((0, 0, idle))
        model.add(self.makespan >= ready + int(problem.home[kind, origin])).only_enforce_if(idle)
        for task in range(tasks):
            does, end = self.does[robot][task], self.end[task]
            takes = int(problem.duration[task] + problem.slower[pace, task])
            if problem.slower[:, task].any():
                model.add(end >= self.start[task] + takes).only_enforce_if(does)
            arcs.append((task + 1, task + 1, ~does))
            first, last = model.new_bool_var(""), model.new_bool_var("")
            ways[0, task + 1], ways[task + 1, 0] = first, last
            arcs += [(0, task + 1, first), (task + 1, 0, last)]
            there = ready + int(problem.ways[pace, origin, task])
            model.add(self.start[task] >= there).only_enforce_if(
                does if self._is_straight(pace, origin, task) else first
            )
            model.add(self.makespan >= end + int(problem.home[kind, task])).only_enforce_if(last)
            busy += [
                int(problem.ways[pace, origin, task]) * first,
                takes * does,
                int(problem.home[kind, task]) * last,
            ]
            for other in range(tasks):
                if other != task:
                    goes = ways[task + 1, other + 1] = model.new_bool_var("")
                    arcs.append((task + 1, other + 1, goes))
                    way = int(problem.ways[pace, task, other])
                    model.add(self.start[other] >= end + way).only_enforce_if(goes)
                    busy.append(way * goes)
        model.add_circuit(arcs)
        model.add(self.makespan >= sum(busy))  # nothing new, but it raises the bound

    def _is_straight(self, pace: int, origin: int, task: int) -> bool:
        """Say whether no detour by another task is shorter."""
        ways = self.problem.ways[pace]
        detours = ways[origin] + self.problem.duration + ways[: len(self.start), task]
        return bool(ways[origin, task] <= detours.min())

    def _cover(self) -> None:
        for task, needs in enumerate(self.problem.needs):
            for cap in np.flatnonzero(needs):
                brought = [
                    int(self.problem.counts[robot, cap]) * does[task]
                    for robot, does in enumerate(self.does)
                ]
                self.model.add(sum(brought) >= int(needs[cap]))

    def hint(self, plan: CoalitionPlan) -> None:
        """Begin at who does what in a plan."""
        for task, coalition in enumerate(plan.coalition):
            for robot, does in enumerate(self.does):
                self.model.add_hint(does[task], robot in coalition[: plan.size[task]])

    def hint_ways(self, plan: CoalitionPlan) -> None:
        """Begin at a plan's ways and starts, too."""
        schedule = schedule_of(self.problem, plan)
        for task, start in enumerate(self.start):
            self.model.add_hint(start, int(schedule.start[task]))
        self.model.add_hint(self.makespan, int(schedule.total[MAKESPAN]))
        for robot, ways in enumerate(self.goes):
            nodes = [
                task + 1 for task in plan.order if robot in plan.coalition[task, : plan.size[task]]
            ]
            taken = set(pairwise((0, *nodes, 0)))
            for way, goes in ways.items():
                self.model.add_hint(goes, way in taken)

    def plan_of(self, solver: cp_model.CpSolver) -> CoalitionPlan:
        """Return what the solver found as a plan; tasks in the order in which they start.

        Those that take no time may do so at one moment: then what comes before others is first.
        """
        plan = empty_plan(self.problem)
        starts = np.array([solver.value(start) for start in self.start])
        ends = np.array([solver.value(end) for end in self.end])
        plan.order[:] = np.lexsort((_depths(self.problem), ends, starts))
        for task in range(len(starts)):
            coalition = [r for r, does in enumerate(self.does) if solver.value(does[task])]
            plan.size[task] = len(coalition)
            plan.coalition[task, : len(coalition)] = coalition
        return plan


def _depths(problem: CoalitionProblem) -> Ints:
    """Return how many tasks stand in the longest chain of those before each, as (tasks,)."""
    depth = np.zeros(len(problem.needs), np.int64)
    for _ in depth:
        for task, before in enumerate(problem.before):
            depth[task] = max((depth[other] + 1 for other in before if other != NOBODY), default=0)
    return depth
