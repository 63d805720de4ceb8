"""The central solver against every schedule there is, on tiny worlds; its limits and reports."""

from __future__ import annotations

import signal
import threading
import time
from dataclasses import replace

import numpy as np
import pytest

from plain_plans import fastest_makespan, find_faults, schedule_of, tiny_world
from random_worlds import random_world
from small_worlds import make, robot, task
from teamformer.files.drawn.generate import Spec, generate
from teamformer.methods.scripted.heuristic import Heuristic
from teamformer.methods.scripted.joining import JoinAll
from teamformer.mission.model import Mission
from teamformer.mission.parts.grid import Grid
from teamformer.planning.bounds.makespan import bound_makespan
from teamformer.planning.problem.relaxed_problem import relax
from teamformer.planning.relaxation.solve import solve
from teamformer.trials.trial import run_trials


def crowd(tasks: int = 100, seed: int = 0) -> Mission:
    """Return a world in which nothing can be proven in seconds: 20 robots, 5 of each kind."""
    spec = Spec(robots=20, tasks=tasks, capabilities=4, world=Grid(20, 20))
    return generate(spec, np.random.default_rng(seed))


@pytest.mark.parametrize("seed", range(4))
def test_finds_and_proves_the_fastest_schedule(seed: int) -> None:
    rng = np.random.default_rng(seed)
    for _ in range(60):
        mission = tiny_world(rng)
        solution = solve(mission, time_limit=10.0)
        assert solution.plan is not None
        assert find_faults(mission, schedule_of(relax(mission), solution.plan)) == []
        assert solution.value == fastest_makespan(mission)
        assert (solution.status, solution.bound) == ("optimal", solution.value)


def test_says_when_robots_are_lost_too_early() -> None:
    """Each task can be done, but not both: b is lost after the 5 steps to either.

    U . . . . b . . . . T
    """
    mission = make([robot("b", 5, lost=6)], [task("b", 10), task("b", 0)])
    solution = solve(mission, time_limit=5.0)
    assert (solution.status, solution.plan, solution.value) == ("infeasible", None, None)
    impossible = make([robot("a", 0, lost=5)], [task("a", 5)])
    assert solve(impossible, time_limit=5.0).status == "infeasible"
    assert solve(mission, time_limit=0.0).status == "unknown"


@pytest.mark.parametrize("seed", range(2))
def test_nothing_beats_its_bound_by_the_rules(seed: int) -> None:
    """Also where robots are slow and do tasks in passing."""
    rng = np.random.default_rng(seed)
    missions = [random_world(rng) for _ in range(60)]
    solutions = [solve(mission, time_limit=1.0) for mission in missions]
    for policy in (JoinAll(), Heuristic()):
        for solution, tally in zip(solutions, run_trials(missions, policy), strict=True):
            if tally.status == "completed":
                assert solution.bound <= tally.steps
                assert solution.status != "infeasible"


def test_slow_robots_leave_the_proof_open() -> None:
    """Cells 1 and 2 take 2 + 2 relaxed steps at 0.8, but 3 in passing: 4 is no bound."""
    solution = solve(make([robot("a", 0, speed=0.8)], [task("a", 1), task("a", 2)]), 60.0)
    assert (solution.value, solution.status) == (4, "feasible")
    assert solution.bound <= 3
    assert solution.seconds < 30.0  # it does not go on searching for what is not there


@pytest.mark.parametrize("limit", [0.3, 1.0])
def test_keeps_to_its_time_limit(limit: float) -> None:
    begun = time.perf_counter()
    solution = solve(crowd(), limit)
    assert limit <= time.perf_counter() - begun < limit + 10  # however busy the machine is
    assert solution.status == "feasible"


def test_its_bound_is_at_least_that_of_each_capability() -> None:
    mission = crowd(tasks=40)
    solution = solve(mission, 1.0)
    assert solution.value is not None
    assert bound_makespan(relax(mission)) <= solution.bound <= solution.value


def test_no_time_gives_the_first_plan() -> None:
    mission = crowd()
    solution = solve(mission, 0.0)
    assert solution.plan is not None
    assert find_faults(mission, schedule_of(relax(mission), solution.plan)) == []
    assert solution.seconds < 0.5


def test_the_same_seed_gives_the_same_schedule_where_it_is_proven() -> None:
    for seed in range(5):
        mission = generate(Spec(robots=4, tasks=8), np.random.default_rng(seed))
        one, other = (solve(mission, 20.0, seed=3) for _ in range(2))
        assert one.status == "optimal"
        assert one.plan is not None
        assert other.plan is not None
        assert one.plan.order.tolist() == other.plan.order.tolist()
        assert one.plan.coalition.tolist() == other.plan.coalition.tolist()


@pytest.mark.parametrize(
    "spec",
    [
        Spec(robots=20, tasks=100, world=Grid(20, 20)),  # it searches
        Spec(
            robots=40, tasks=20, capabilities=40, requirements=20, world=Grid(20, 20)
        ),  # it proves
    ],
)
def test_an_interrupt_ends_all_threads(spec: Spec) -> None:
    solve(generate(Spec(), np.random.default_rng(0)), 0.1)  # compiles
    main, others = threading.get_ident(), set(threading.enumerate())
    interrupt = threading.Timer(1.5, lambda: signal.pthread_kill(main, signal.SIGINT))
    begun, limit = time.perf_counter(), 120.0
    interrupt.start()
    with pytest.raises(KeyboardInterrupt):
        solve(generate(spec, np.random.default_rng(0)), limit)
    assert time.perf_counter() - begun < limit / 2  # however busy the machine is
    assert set(threading.enumerate()) <= others


def test_joining_costs_are_no_part_of_the_relaxed_problem() -> None:
    mission = generate(Spec(), np.random.default_rng(0))
    values = {solve(replace(mission, forming_steps=n), 5.0).value for n in (0, 1)}
    assert len(values) == 1
