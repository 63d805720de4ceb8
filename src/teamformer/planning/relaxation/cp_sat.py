"""The relaxed problem as a constraint model for OR-Tools CP-SAT: one circuit per robot.

A robot's circuit leads from its start through the tasks it visits and back at no cost. All
robots of a coalition share the task's start, so one literal says for all that a task is over
before another begins; a robot that visits both tasks needs it one way or the other.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from itertools import combinations, pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from teamformer.base.array_types import Int32s
from teamformer.base.import_apart import import_apart
from teamformer.planning.bounds.earliest import earliest_starts
from teamformer.planning.problem.coalition_plan import CoalitionPlan
from teamformer.planning.problem.relaxed_problem import Relaxed
from teamformer.planning.relaxation.relaxed_plan import plan_without_spares
from teamformer.world.rules.constants import FAR

if TYPE_CHECKING:
    from ortools.sat.python import cp_model

Literal = Any
"""A Boolean variable of the model, or its negation."""

DEPOT = 0
"""The node a circuit starts from; task k is node k + 1."""


@dataclass(frozen=True)
class Circuits:
    """A model and its variables; robots and tasks by number."""

    problem: Relaxed
    model: cp_model.CpModel
    horizon: int
    makespan: cp_model.IntVar
    start: tuple[cp_model.IntVar, ...]  # (tasks,)
    visits: dict[tuple[int, int], Literal] = field(default_factory=dict)  # (robot, task)
    firsts: dict[tuple[int, int], Literal] = field(default_factory=dict)  # (robot, task)
    before: dict[tuple[int, int], Literal] = field(default_factory=dict)  # (task, other)


def count_arcs(problem: Relaxed) -> int:
    """Return how many arcs the circuits can have."""
    visits = ((problem.counts > 0) @ (problem.needs > 0).T).sum(axis=1)  # (robots,)
    return int((visits.astype(np.int64) * (visits + 2)).sum())


def build_circuits(problem: Relaxed, bound: int, horizon: int) -> Circuits:
    """Return the model of all plans with a makespan from `bound` to `horizon`."""
    from ortools.sat.python import cp_model

    model = cp_model.CpModel()
    earliest = np.minimum(earliest_starts(problem), horizon + 1)  # (tasks,)
    start = tuple(model.new_int_var(int(first), horizon + 1, "") for first in earliest)
    makespan = model.new_int_var(bound, horizon, "")
    circuits = Circuits(problem, model, horizon, makespan, start)
    for task, duration in enumerate(problem.duration):
        model.add(start[task] + int(duration) <= makespan)
    for robot in range(len(problem.pace)):
        _add_circuit(circuits, robot, earliest, horizon)
        _order_visits(circuits, robot)
    _cover_needs(circuits)
    _break_symmetry(circuits)
    model.minimize(makespan)
    return circuits


def _add_circuit(circuits: Circuits, robot: int, earliest: Int32s, horizon: int) -> None:
    """Let a robot visit tasks one after the other, in no more steps than the makespan."""
    problem, model = circuits.problem, circuits.model
    tasks = list(_tasks_in_reach(problem, robot, earliest, horizon))
    idle = model.new_bool_var("")
    arcs: list[tuple[int, int, Literal]] = [(DEPOT, DEPOT, idle)]
    spent = []
    for task in tasks:
        visit, first, last = (model.new_bool_var("") for _ in range(3))
        circuits.visits[robot, task], circuits.firsts[robot, task] = visit, first
        node, way = task + 1, _way_from_start(problem, robot, task)
        arcs += [(node, node, ~visit), (DEPOT, node, first), (node, DEPOT, last)]
        spent += [way * first, int(problem.duration[task]) * last]
        _limit_visit(circuits, robot, task, way)
    for task in tasks:
        for other in tasks:
            steps = gap(problem, robot, task, other)
            if task != other and earliest[task] + steps + problem.duration[other] <= horizon:
                arc = model.new_bool_var("")
                arcs.append((task + 1, other + 1, arc))
                spent.append(steps * arc)
                model.add_implication(arc, _before(circuits, task, other))
    model.add_circuit(arcs)
    model.add(sum(spent) <= circuits.makespan)


def _tasks_in_reach(problem: Relaxed, robot: int, earliest: Int32s, horizon: int) -> Iterator[int]:
    """Return the tasks a robot is of use for and can be at in time."""
    is_useful = (problem.needs > 0) @ (problem.counts[robot] > 0)  # (tasks,)
    for task in np.flatnonzero(is_useful).tolist():
        start = max(int(earliest[task]), _way_from_start(problem, robot, task))
        if start + problem.duration[task] <= min(horizon, problem.lost[robot] - 1):
            yield task


def _limit_visit(circuits: Circuits, robot: int, task: int, way: int) -> None:
    """A robot is there from when it can be until it is lost."""
    model, start, visit = circuits.model, circuits.start[task], circuits.visits[robot, task]
    model.add(start >= way).only_enforce_if(visit)
    if circuits.problem.lost[robot] < FAR:
        latest = int(circuits.problem.lost[robot] - 1 - circuits.problem.duration[task])
        model.add(start <= latest).only_enforce_if(visit)


def _before(circuits: Circuits, task: int, other: int) -> Literal:
    """Return the literal that a task is over, and the fastest robot there, before another."""
    if (task, other) not in circuits.before:
        literal = circuits.before[task, other] = circuits.model.new_bool_var("")
        fastest = _fastest(circuits.problem, task, other)
        _delay(circuits, fastest, task, other, [literal])
        if (other, task) in circuits.before:
            circuits.model.add_at_most_one(literal, circuits.before[other, task])
    return circuits.before[task, other]


def _fastest(problem: Relaxed, task: int, other: int) -> int:
    """Return a robot that gets from a task to another in the fewest steps."""
    _, first = np.unique(problem.pace, return_index=True)
    ways = problem.steps[problem.pace[first], problem.cells[other, task]]
    return int(first[::-1][ways[::-1].argmin()])  # of equally fast ones the fastest by speed


def _delay(circuits: Circuits, robot: int, task: int, other: int, when: list[Literal]) -> None:
    steps = gap(circuits.problem, robot, task, other)
    delay = circuits.model.add(circuits.start[other] >= circuits.start[task] + steps)
    delay.only_enforce_if(*when)


def _order_visits(circuits: Circuits, robot: int) -> None:
    """Two tasks that a robot visits come one before the other, at the robot's own pace.

    This also makes it wait for all tasks of a stay, not just for the last it began.
    """
    problem = circuits.problem
    is_slow = problem.speed[robot] < problem.speed.max()
    is_slow |= problem.pace[robot] != problem.pace.max()  # who flies may have a shorter way
    tasks = [task for visitor, task in circuits.visits if visitor == robot]
    for pair in combinations(tasks, 2):
        both = [circuits.visits[robot, task] for task in pair]
        orders = [pair, pair[::-1]]
        circuits.model.add_bool_or(
            *(~visit for visit in both),
            *(circuits.before[order] for order in orders if order in circuits.before),
        )
        for order in orders:
            if is_slow and order in circuits.before:
                _delay(circuits, robot, *order, [circuits.before[order], *both])


def _cover_needs(circuits: Circuits) -> None:
    """Give each task enough of each capability."""
    problem = circuits.problem
    for task, cap in np.argwhere(problem.needs > 0).tolist():
        brought = [
            int(problem.counts[robot, cap]) * circuits.visits[robot, task]
            for robot in problem.able[cap].tolist()  # closed by NOBODY, who visits nothing
            if (robot, task) in circuits.visits
        ]
        circuits.model.add(sum(brought) >= int(problem.needs[task, cap]))


def _break_symmetry(circuits: Circuits) -> None:
    """Of robots that are alike in everything, let the first have the lowest first task."""
    problem, tasks = circuits.problem, len(circuits.start)
    alike: dict[bytes, list[int]] = defaultdict(list)
    for robot in range(len(problem.pace)):
        traits = (problem.counts[robot], problem.cells[:, tasks + robot])
        rest = (problem.pace[robot], problem.lost[robot])
        alike[np.concatenate([*traits, rest]).tobytes()].append(robot)
    for group in alike.values():
        for robot, other in pairwise(group):
            ranks = [
                tasks + sum((task - tasks) * literal for task, literal in _firsts(circuits, who))
                for who in (robot, other)
            ]
            circuits.model.add(ranks[0] <= ranks[1])


def _firsts(circuits: Circuits, robot: int) -> list[tuple[int, Literal]]:
    return [(task, first) for (who, task), first in circuits.firsts.items() if who == robot]


def gap(problem: Relaxed, robot: int, task: int, other: int) -> int:
    """Return the steps from a task's start to another's if a robot does both in this order.

    In one place that is 0, as services may overlap: a robot's tasks in one stay can be put in
    the order of their starts.
    """
    way = int(problem.steps[problem.pace[robot], problem.cells[other, task]])
    return way + int(problem.duration[task]) if way > 0 else 0


def latest_makespan(problem: Relaxed) -> int:
    """Return a makespan that no plan exceeds in which every task starts as early as can be.

    What a task waits for is its appearance, or a way and a service that end with its start.
    """
    ways = problem.steps[:, problem.cells]  # (paces, tasks, places)
    longest = np.where(ways < FAR, ways, 0).max(axis=(0, 2))  # (tasks,)
    return int(problem.appears.max() + 1 + (longest + problem.duration).sum())


def _way_from_start(problem: Relaxed, robot: int, task: int) -> int:
    place = len(problem.appears) + robot
    return int(problem.steps[problem.pace[robot], problem.cells[task, place]])


def make_solver(seed: int) -> cp_model.CpSolver:
    """Return a solver that works on one thread: on these models two are no faster."""
    import_apart("ortools.sat.python.cp_model")
    from ortools.sat.python import cp_model

    solver = cp_model.CpSolver()
    solver.parameters.num_workers = 1
    solver.parameters.catch_sigint_signal = False
    solver.parameters.random_seed = seed
    return solver


def minimise(
    circuits: Circuits, solver: cp_model.CpSolver, offer: Callable[[CoalitionPlan], None]
) -> tuple[bool, int]:
    """Solve a model, offering each plan found on the way.

    Returns whether the search came to its end, and the solver's bound; if there is no plan within
    the horizon at all, that is more than the horizon.
    """
    from ortools.sat.python import cp_model

    class Reporter(cp_model.CpSolverSolutionCallback):
        """Passes on what the solver finds."""

        def on_solution_callback(self) -> None:
            offer(read_solution(circuits, self.value))

    status = solver.solve(circuits.model, Reporter())
    assert status != cp_model.MODEL_INVALID, "the model is malformed"
    if status == cp_model.INFEASIBLE:
        return True, circuits.horizon + 1
    return status == cp_model.OPTIMAL, math.ceil(solver.best_objective_bound - 1e-6)


def read_solution(circuits: Circuits, value: Callable[[Any], int]) -> CoalitionPlan:
    """Return the plan of a solution; `value` says what a variable is in it."""
    starts = [value(start) for start in circuits.start]
    coalitions: list[list[int]] = [[] for _ in starts]
    for (robot, task), visit in circuits.visits.items():
        if value(visit):
            coalitions[task].append(robot)
    order = np.argsort(starts, kind="stable").tolist()
    return plan_without_spares(circuits.problem, order, coalitions)
