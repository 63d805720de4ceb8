"""The central solver: the best relaxed plan it can find in time, and a bound on all others."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, wait
from dataclasses import dataclass
from functools import cache, partial
from typing import Literal

from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.planning.bounds.earliest import earliest_starts
from teamformer.planning.bounds.makespan import bound_makespan
from teamformer.planning.problem.coalition_plan import CoalitionPlan
from teamformer.planning.problem.relaxed_problem import (
    Relaxed,
    is_true_relaxation,
    may_set_down,
    relax,
)
from teamformer.planning.race import Judgement, Race, search_by_clock
from teamformer.planning.relaxation.cp_sat import (
    build_circuits,
    count_arcs,
    latest_makespan,
    make_solver,
    minimise,
)
from teamformer.planning.relaxation.relaxed_plan import makespan_of
from teamformer.planning.relaxation.threshold import HOT, ThresholdSearch
from teamformer.world.rules.constants import FAR

Status = Literal["optimal", "feasible", "infeasible", "unknown"]

Plans = Race[CoalitionPlan | None]
"""A race of relaxed plans; it may begin without one."""

FIRST_ROUNDS = 250
"""Rounds of searching, for each task, before anything is to be proven; up to half of the time."""

LARGEST_MODEL = 5000
"""Circuits with more arcs than this prove nothing in minutes, so searching goes on instead."""

SECONDS_TO_BUILD = 5e-5
"""Seconds that an arc may take to be built and presolved; with less time left, none are."""

STOP_AGAIN = 0.05
"""Seconds after which it is looked again whether the solver is to end, and it is told again."""


@dataclass(frozen=True)
class RelaxedSolution:
    """What the solver found.

    `value` is the makespan of `plan` if joining is free, `bound` what no plan can beat, under the
    rules either. Status: `optimal` if both are the same, `feasible` if not; `infeasible` if robots
    are lost too early for some task; `unknown` if no plan was found.
    """

    plan: CoalitionPlan | None
    value: int | None
    bound: int
    status: Status
    seconds: float


def solve(
    mission: Mission,
    time_limit: float,
    seed: int = 0,
    is_stopped: Callable[[], bool] = lambda: False,
) -> RelaxedSolution:
    """Minimise the makespan if joining is free, for up to `time_limit` seconds, on this thread.

    A limit of 0 returns the first plan. It ends early when `is_stopped` says so. Compiling, once
    for each installation, takes seconds that do not count.
    """
    _compile()
    begun, problem = time.perf_counter(), relax(mission)
    is_bounding = not may_set_down(mission)
    if (earliest_starts(problem) >= FAR).any():
        status: Status = "infeasible" if is_bounding else "unknown"
        return RelaxedSolution(None, None, 0, status, time.perf_counter() - begun)
    search = ThresholdSearch(problem, seed)
    search.run(1)
    race = Plans(partial(_judge, problem), search.best, begun, begun + time_limit, is_stopped)
    if is_bounding:
        race.raise_bound(bound_makespan(problem))
    arcs, is_infeasible = count_arcs(problem), False
    if arcs > LARGEST_MODEL:
        _cool_down(race, search)
    else:
        _cool_down(race, search, 0.5, FIRST_ROUNDS * len(mission.tasks))
        if arcs * SECONDS_TO_BUILD < race.seconds_left and not race.is_over:
            is_infeasible = _prove(race, problem, seed, is_bounding)
    value = _value_of(problem, race.plan)
    if value is None:
        status = "infeasible" if is_infeasible else "unknown"
    else:
        status = "optimal" if value <= race.bound else "feasible"
    return RelaxedSolution(race.plan, value, race.bound, status, time.perf_counter() - begun)


def _value_of(problem: Relaxed, plan: CoalitionPlan | None) -> int | None:
    return None if plan is None else makespan_of(problem, plan)


def _judge(problem: Relaxed, plan: CoalitionPlan | None) -> Judgement:
    """Compare plans by their makespans; any is better than none."""
    value = _value_of(problem, plan)
    makespan = math.inf if value is None else value
    return Judgement((makespan,), makespan, makespan)


def _cool_down(
    race: Plans, search: ThresholdSearch, share: float = 1.0, rounds: float = math.inf
) -> None:
    """Search once from hot to cool, over a share of the time or so many rounds."""
    deadline = time.perf_counter() + share * race.seconds_left

    def run(passed: float, rounds: int) -> None:
        heat = HOT * (1 - passed)
        search.run(rounds, heat, heat)

    search_by_clock(
        run, lambda: (search.cost,), deadline, race, lambda: race.offer(search.best), rounds
    )


def _prove(race: Plans, problem: Relaxed, seed: int, is_bounding: bool) -> bool:
    """Look for a faster plan with CP-SAT, or show that there is none; say if there is none.

    It works on a thread of its own, and this one only waits, so that Ctrl-C reaches it.
    """
    solver, best = make_solver(seed), _value_of(problem, race.plan)
    horizon = latest_makespan(problem) if best is None else best - 1
    circuits = build_circuits(problem, race.bound, horizon)
    solver.parameters.max_time_in_seconds = race.seconds_left
    with ThreadPoolExecutor(1) as pool:
        proof = pool.submit(partial(minimise, circuits, solver, race.offer))
        try:
            while wait([proof], timeout=STOP_AGAIN).not_done:
                if race.is_over:
                    solver.stop_search()
        finally:
            while wait([proof], timeout=STOP_AGAIN).not_done:  # one that just begins is deaf
                solver.stop_search()
    _, bound = proof.result()
    if not is_bounding or not is_true_relaxation(problem):
        return False
    race.raise_bound(bound)
    return best is None and bound > horizon


@cache
def _compile() -> None:
    """Compile the kernels, or load what was compiled before, on a smallest problem."""
    robots = tuple(Robot(f"r{r}", (0, 0), {cap: 1}) for r, cap in enumerate("aab"))
    tasks = tuple(Task(f"t{k}", (k, 0), {"a": 1, "b": 1}) for k in range(2))
    problem = relax(Mission("smallest", Grid(2, 1), ("a", "b"), robots, tasks))
    search = ThresholdSearch(problem, seed=0)
    search.run(1)
    bound_makespan(problem)
