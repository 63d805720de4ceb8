"""The constraint model alone, without a search before it, against every schedule there is."""

from __future__ import annotations

import numpy as np
import pytest

from plain_plans import RelaxedSchedule, fastest_makespan, find_faults, schedule_of, tiny_world
from small_worlds import make, robot, task
from teamformer.mission.model import Mission
from teamformer.planning.problem.relaxed_problem import relax
from teamformer.planning.relaxation.cp_sat import (
    build_circuits,
    latest_makespan,
    make_solver,
    minimise,
)


def solve_alone(mission: Mission) -> tuple[int | None, list[RelaxedSchedule]]:
    """Return the least makespan and all schedules seen on the way."""
    problem, seen = relax(mission), list[RelaxedSchedule]()
    horizon = latest_makespan(problem)
    has_seen_all, bound = minimise(
        build_circuits(problem, 0, horizon),
        make_solver(seed=0),
        lambda plan: seen.append(schedule_of(problem, plan)),
    )
    assert has_seen_all
    return (bound if bound <= horizon else None), seen


@pytest.mark.parametrize("seed", range(4))
def test_agrees_with_every_schedule_there_is(seed: int) -> None:
    rng = np.random.default_rng(seed)
    makespans = []
    for _ in range(50):
        mission = tiny_world(rng, speeds=(1.0, 0.5, 0.8, 2.0, 1.7), losses=0.3)
        makespan, schedules = solve_alone(mission)
        assert makespan == fastest_makespan(mission)
        assert [find_faults(mission, schedule) for schedule in schedules] == [[]] * len(schedules)
        if makespan is not None:
            assert schedules[-1].makespan == makespan
        makespans.append(makespan)
    assert 0 < makespans.count(None) < 25  # robots are lost too early now and then


def test_services_in_one_place_overlap() -> None:
    """a walks 3 to two services of 5 and 2 steps, then 4 on: it leaves when both are over.

    a . . T U . . V        3 + 5 + 4 = 12
    """
    tasks = [task("a", 3, duration=5), task("a", 3, duration=2), task("a", 7)]
    makespan, [*_, schedule] = solve_alone(make([robot("a", 0)], tasks))
    assert makespan == 12
    assert sorted(schedule.start[:2]) == [3, 3]


def test_like_robots_may_share_a_task() -> None:
    """Four alike, in one place, and tasks at both ends of which each needs two: 4 steps, not 12."""
    robots = [robot("a", 4) for _ in range(4)]
    makespan, _ = solve_alone(make(robots, [task("aa", 0), task("aa", 8)]))
    assert makespan == 4
