"""The search: sound schedules, good ones, and the same ones again."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from plain_plans import (
    RelaxedSchedule,
    fastest_makespan,
    find_faults,
    least_cost,
    schedule_of,
    tiny_world,
)
from random_worlds import random_world
from small_worlds import make, robot, task
from teamformer.files.drawn.generate import Spec, generate
from teamformer.planning.problem.relaxed_problem import Relaxed, relax
from teamformer.planning.relaxation.relaxed_plan import (
    empty_timing,
    hang_tasks,
    makespan_of,
    plan_without_spares,
    start_tasks,
)
from teamformer.planning.relaxation.threshold import ThresholdSearch


def search_schedule(problem: Relaxed, seed: int, rounds: int) -> RelaxedSchedule | None:
    search = ThresholdSearch(problem, seed)
    search.run(rounds)
    return None if search.best is None else schedule_of(problem, search.best)


@pytest.mark.parametrize("seed", range(3))
def test_finds_the_fastest_schedule_of_tiny_worlds(seed: int) -> None:
    rng = np.random.default_rng(seed)
    for _ in range(100):
        mission = tiny_world(rng)
        schedule = search_schedule(relax(mission), seed, rounds=400)
        assert schedule is not None
        assert find_faults(mission, schedule) == []
        assert schedule.makespan == fastest_makespan(mission)


@pytest.mark.parametrize("seed", range(3))
def test_finds_the_cheapest_schedule_of_tiny_worlds(seed: int) -> None:
    rng = np.random.default_rng(seed)
    for _ in range(40):
        drawn = tiny_world(rng)
        due = rng.integers(2, 8, len(drawn.tasks)).tolist()
        wanted = [replace(one, between=(0, by)) for one, by in zip(drawn.tasks, due, strict=True)]
        mission = replace(drawn, tasks=tuple(wanted), cost={"makespan": 1.0, "tardiness": 2.0})

        def cost(ends: Mapping[int, int], due: list[int] = due) -> float:
            late = sum(max(0, end - due[task]) for task, end in ends.items())
            return max(ends.values(), default=0) + 2.0 * late

        search = ThresholdSearch(relax(mission), seed)
        search.go_by_price()
        search.run(400)
        assert search.best is not None
        schedule = schedule_of(search.problem, search.best)
        assert find_faults(mission, schedule) == []
        assert cost(dict(enumerate(schedule.end))) == least_cost(mission, cost)


@pytest.mark.parametrize(("other", "is_waiting"), [(4, False), (9, True)])
def test_what_waits_for_a_task_is_pushed_by_it(other: int, is_waiting: bool) -> None:
    """`a` does t0 at 1 and t1 at 3, with `b`, for whom `a` has to wait if it comes from 9."""
    drawn = make([robot("a", 0), robot("b", other)], [task("a", 1), task("ab", 3)])
    problem = relax(replace(drawn, cost={"completion": 1.0}))
    plan = plan_without_spares(problem, [0, 1], [[0], [0, 1]])
    timing = empty_timing(problem, plan)
    start_tasks(problem, plan, timing)
    hang_tasks(problem, plan, timing)
    assert timing.push.tolist() == [0 if is_waiting else problem.prices.ends[1], 0]


def test_by_what_plans_cost_a_task_that_is_due_comes_first() -> None:
    """From 8 by 5 to 13 it takes 11 steps, and 13 the other way round; what is at 13 is due in 7.

    So the one costs 11 and twice 4, the other 13.
    """
    tasks = [replace(task("a", 13), between=(0, 7)), task("a", 5)]
    problem = relax(make([robot("a", 8)], tasks, cost={"makespan": 1.0, "tardiness": 2.0}))
    search = ThresholdSearch(problem, seed=0)
    search.run(20)
    assert search.best is not None
    assert search.best.order.tolist() == [1, 0]
    assert makespan_of(problem, search.best) == 11
    search.go_by_price()
    search.run(20)
    assert search.best is not None
    assert search.best.order.tolist() == [0, 1]
    assert makespan_of(problem, search.best) == 13


@pytest.mark.parametrize("seed", range(3))
def test_schedules_of_any_world_are_sound(seed: int) -> None:
    rng = np.random.default_rng(seed)
    missed = 0
    for _ in range(60):
        mission = random_world(rng)
        schedule = search_schedule(relax(mission), seed, rounds=100)
        if schedule:
            assert find_faults(mission, schedule) == []
        missed += schedule is None
    assert missed < 20  # robots are lost in many of these worlds


def test_the_same_seed_and_rounds_give_the_same_schedule() -> None:
    problem = relax(generate(Spec(robots=8, tasks=30), np.random.default_rng(0)))
    assert search_schedule(problem, 3, rounds=200) == search_schedule(problem, 3, rounds=200)
    assert search_schedule(problem, 3, rounds=200) != search_schedule(problem, 4, rounds=200)


def test_a_task_without_anybody_left_to_do_it_leaves_no_schedule() -> None:
    """a is 5 away from its task, and lost at step 5."""
    problem = relax(make([robot("a", 0, lost=5)], [task("a", 5)]))
    assert search_schedule(problem, 0, rounds=10) is None
    problem = relax(make([robot("a", 0, lost=6)], [task("a", 5)]))
    assert search_schedule(problem, 0, rounds=10) is not None


def test_hint_with_spare_robots_is_trimmed() -> None:
    problem = relax(make([robot("ab", 0), robot("a", 0), robot("b", 0)], [task("ab", 3)]))
    plan = plan_without_spares(problem, [0], [[0, 1, 2]])
    assert plan.coalition[0, : plan.size[0]].tolist() == [1, 2]  # the first that can be spared goes


def makespan_if_late(problem: Relaxed, schedule: RelaxedSchedule, late: int, start: int) -> int:
    """Return the makespan when one task may not start before a step."""
    appears = problem.appears.copy()
    appears[late] = start - 1
    plan = plan_without_spares(problem, schedule.order, schedule.coalitions)
    return int(start_tasks(problem._replace(appears=appears), plan, empty_timing(problem, plan))[0])


@pytest.mark.parametrize("seed", range(3))
def test_a_tail_is_what_follows_when_a_task_is_very_late(seed: int) -> None:
    rng = np.random.default_rng(seed)
    for _ in range(40):
        problem = relax(random_world(rng, with_losses=False))
        schedule = search_schedule(problem, seed, rounds=20)
        assert schedule is not None
        plan = plan_without_spares(problem, schedule.order, schedule.coalitions)
        timing = empty_timing(problem, plan)
        makespan, _, _ = start_tasks(problem, plan, timing)
        hang_tasks(problem, plan, timing)
        assert makespan == (timing.start + timing.tail).max()
        for late in range(len(schedule.coalitions)):
            end = makespan_if_late(problem, schedule, late, start=1000)
            assert end == 1000 + timing.tail[late]
