"""The search with batteries: its times against a plan carried out, its plans against all others."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

from charged_keys import drawn_with
from charging_missions import charged_mission
from teamformer.base.errors import MissionError
from teamformer.methods.by_name import load_method
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.charging import Battery, Charger
from teamformer.mission.parts.plane import Plane
from teamformer.planning.continuous.continuous_mission import pose_mission
from teamformer.planning.continuous.rules import plan_continuous
from teamformer.planning.continuous.solve import plan_together
from teamformer.planning.problem.charged_plans import charged_times, charged_totals
from teamformer.planning.problem.coalition_plan import plan_of_lists
from teamformer.planning.problem.coalition_problem import CoalitionProblem
from teamformer.planning.problem.schedule import MAKESPAN, schedule_of
from teamformer.planning.search.arc_search import ArcSearch
from teamformer.record.referee import judge
from teamformer.trials.trial import run_trial


def drawn(seed: int, room: int = 9, tasks: int = 6) -> CoalitionProblem:
    mission = charged_mission(seed, tasks=tasks, room=room)
    return pose_mission(mission).problem


@pytest.mark.parametrize("seed", range(6))
def test_times_of_a_graph_are_those_of_the_plan_carried_out(seed: int) -> None:
    problem = drawn(seed, tasks=10)
    search = ArcSearch(problem, seed)
    assert search.begin_anew()
    for part in range(1, 6):
        search.anneal(*search.heats, 0, 300 * part, 300 * part)
        if charged_totals(problem, search.present)[0] == math.inf:
            continue  # a robot runs dry; the graph goes on as if it had been rescued
        told = charged_times(problem, search.present)
        ends = [told.timed.end(task) for task in range(len(problem.needs))]
        tasks = len(problem.needs)
        assert np.allclose(search.graph.nodes.end[:tasks], ends, atol=50 * tasks, rtol=0)
        given_out = schedule_of(problem, search.present)
        assert np.allclose(given_out.end[:tasks], ends, atol=50 * tasks, rtol=0)
        assert given_out.total[MAKESPAN] == pytest.approx(max(told.back), abs=50 * tasks)


@pytest.mark.parametrize("seed", range(4))
def test_times_of_a_graph_with_permits_are_no_earlier_than_by_the_order(seed: int) -> None:
    problem = pose_mission(drawn_with("zones", seed, tasks=10)).problem
    batteries = problem.batteries._replace(room=np.full_like(problem.batteries.room, 9))
    problem = problem._replace(batteries=batteries)
    search = ArcSearch(problem, seed)
    assert search.begin_anew()
    for part in range(1, 6):
        search.anneal(*search.heats, 0, 300 * part, 300 * part)
        told = charged_times(problem, search.present)
        ends = [told.timed.end(task) for task in range(len(problem.needs))]
        if math.isfinite(sum(ends)):
            assert (np.array(ends) <= search.graph.nodes.end[: len(ends)] + 50 * len(ends)).all()


def all_plans(problem: CoalitionProblem) -> float:
    """Return the least makespan of all orders with all coalitions without a spare robot."""
    robots, best = range(len(problem.counts)), math.inf
    coalitions = []
    for need in problem.needs:
        able = [
            who
            for size in range(1, len(robots) + 1)
            for who in itertools.combinations(robots, size)
            if (problem.counts[list(who)].sum(axis=0) >= need).all()
        ]
        coalitions.append([w for w in able if not any(set(o) < set(w) for o in able)])
    for order in itertools.permutations(range(len(problem.needs))):
        for who in itertools.product(*coalitions):
            plan = plan_of_lists(order, who)
            best = min(best, charged_totals(problem, plan)[0])
    return best


@pytest.mark.parametrize("seed", range(3))
def test_of_small_missions_no_plan_is_better(seed: int) -> None:
    mission = charged_mission(seed, robots=3, tasks=4)
    problem = pose_mission(mission).problem
    made = plan_together(problem)
    assert made is not None
    assert made.worth <= all_plans(problem) * 1.0000001


def test_a_robot_that_is_not_able_for_a_task_is_not_in_its_coalition() -> None:
    # From the charger at [0, 0] the task is 30 away: b, with 59 of energy, does not come back.
    robots = tuple(
        Robot(name, (0, 0), {"lift": 1}, battery=Battery(lasts, 10))
        for name, lasts in (("b", 59.0), ("a", 60.0))
    )
    mission = Mission(
        "far",
        Plane(40, 40),
        ("lift",),
        robots,
        (Task("x", (30, 0), {"lift": 1}), Task("y", (5, 0), {"lift": 1})),
        time="continuous",
        chargers=(Charger((0, 0)),),
    )
    problem = pose_mission(mission).problem
    assert [bool((problem.counts[r] >= problem.needs[0]).all()) for r in (0, 1)] == [False, True]
    assert [bool((problem.counts[r] >= problem.needs[1]).all()) for r in (0, 1)] == [True, True]
    made = plan_together(problem)
    assert made is not None
    assert made.plan.coalition[0, : made.plan.size[0]].tolist() == [1]


def test_rules_without_search_count_with_charging_as_they_choose() -> None:
    """a is 5 away from x, but has to charge first, 20 away, and b is there at 10."""
    battery = Battery(60, 18)
    near = Robot("a", (20, 0), {"lift": 1}, battery=replace(battery, starts=0.4))
    far = Robot("b", (35, 0), {"lift": 1}, battery=battery)
    task = Task("x", (25, 0), {"lift": 1}, duration=3)
    chargers = (Charger((0, 0)),)
    mission = Mission(
        "m", Plane(40, 9), ("lift",), (near, far), (task,), time="continuous", chargers=chargers
    )
    for method in ("soonest", "reactive"):
        made = plan_continuous(pose_mission(mission), method, 0)
        assert made is not None
        assert [len(route.stops) for route in made.routes] == [0, 1]
        assert made.makespan == 13.0


def test_an_optional_task_that_no_battery_lasts_for_is_missed() -> None:
    """From the charger it is 30 to x and 30 back, and a battery lasts 50; z comes after it."""
    robot = Robot("a", (0, 0), {"lift": 1}, battery=Battery(50, 10))
    tasks = (
        Task("x", (30, 0), {"lift": 1}, optional=True),
        Task("y", (5, 0), {"lift": 1}, duration=2),
        Task("z", (6, 0), {"lift": 1}, optional=True, after=("x",)),
    )
    mission = Mission(
        "m", Plane(40, 9), ("lift",), (robot,), tasks, time="continuous", until=90.0,
        chargers=(Charger((0, 0)),),
    )  # fmt: skip
    for method in ("plan", "soonest", "reactive", "central"):
        made = plan_continuous(pose_mission(mission), method, 0.1)
        assert made is not None
        assert made.missed == (0, 2)
        trial = run_trial(mission, load_method(method, 0.1))
        assert judge(trial.record).findings == ()
        assert (trial.record.end.missed, trial.record.end.makespan) == (("x", "z"), 7.0)
        [why] = [event.why for event in trial.record.events if event.task == 0 and event.why]
        assert why == "too far for its battery"
    with pytest.raises(MissionError, match="task 'x' is too far from chargers"):
        replace(mission, tasks=(replace(tasks[0], optional=False), tasks[1]))
