"""Plans in continuous time: timed by a second plain evaluator, and against every plan there is."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import strategies as st

from missions import continuous_missions
from plain_times import Times, Ways, all_plans, times_of
from teamformer.base.errors import TeamformerError
from teamformer.files.mission_files import mission_from_tree
from teamformer.mission.model import Mission
from teamformer.planning.continuous.continuous_mission import pose_mission
from teamformer.planning.continuous.rules import plan_continuous
from teamformer.planning.problem.routes import MissionPlan
from teamformer.record.files.writing import save_record
from teamformer.record.referee import judge
from teamformer.record.telling.whole import path_of_record
from teamformer.trials.continuous_trial import carry_out
from teamformer.trials.routes import routes_of
from teamformer.trials.start_plan import read_start_plan
from tiny import (
    MOST_PLANS_IN_STEPS,
    NEAR,
    ROBOTS,
    TASKS,
    count_plans,
    gap_in_continuous_time,
)
from watching import fuzzed

METHODS = st.sampled_from(["plan", "reactive", "central"])
PLAN = "plan FILE --method {method} --time-limit 0.05"
SECONDS = 0.05


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("plans")


def planned(mission: Mission, method: str) -> MissionPlan | None:
    """Return a plan; None where it is told that there is none.

    That is where linked tasks need robots that cannot be had at once, which no check foresees.
    """
    try:
        return plan_continuous(pose_mission(mission), method, SECONDS)
    except TeamformerError:
        has_shifts = any(robot.shifts for robot in mission.robots)  # too short for some loads
        if (
            not any(task.starts for task in mission.tasks)
            and mission.cost is None
            and not has_shifts
        ):
            raise
        return None


def plainly_timed(mission: Mission, made: MissionPlan) -> Times:
    """Return the times of a plan's routes by a second evaluator."""
    routes = [[stop.task for stop in route.stops] for route in made.routes]
    times = times_of(mission, routes, Ways(mission), made.order)
    assert times is not None, "robots wait for one another for ever"
    return times


@fuzzed(25, PLAN, mission=continuous_missions(), method=METHODS)
def test_a_plan_takes_as_long_as_it_says(mission: Any, method: str) -> None:
    source = mission_from_tree(mission)
    made = planned(source, method)
    if made is None:
        return
    times = plainly_timed(source, made)
    for route in made.routes:
        for stop in route.stops:
            assert stop.start == pytest.approx(times.start[stop.task], abs=NEAR)
            assert stop.end == pytest.approx(stop.start + times.takes[stop.task], abs=NEAR)
            assert stop.arrive <= stop.start + NEAR
        assert route.back == pytest.approx(times.back[route.robot], abs=NEAR)
    assert made.makespan == pytest.approx(times.makespan, abs=NEAR)
    assert made.late == pytest.approx(times.late, abs=NEAR)
    if source.cost is None:
        assert made.cost is None
    else:
        assert made.cost == pytest.approx(times.cost, rel=NEAR, abs=NEAR)


@fuzzed(15, PLAN, mission=continuous_missions(3, 3), method=METHODS)
def test_a_tiny_mission_has_no_better_plan_than_is_proven(mission: Any, method: str) -> None:
    source = mission_from_tree(mission)
    made = planned(source, method)
    plans = list(all_plans(source, Ways(source)))
    if made is None:
        return
    assert plans, "a plan was made where there is none"
    if source.cost is not None:
        assert made.cost is not None
        best = min(times.cost for times in plans if times.cost is not None)
        assert made.cost >= best - NEAR * max(1.0, best)
        assert made.least_cost is not None
        assert made.least_cost <= best + NEAR
        if made.is_proven:
            assert made.cost == pytest.approx(best, rel=NEAR, abs=NEAR)
        return
    soonest = min(times.makespan for times in plans)
    assert soonest - NEAR <= made.makespan
    assert made.bound <= soonest + NEAR
    if made.is_proven:
        assert made.makespan == pytest.approx(soonest, abs=NEAR)


@fuzzed(6, "plan FILE --method central", mission=continuous_missions())
def test_central_is_never_worse_than_the_shared_plan(mission: Any) -> None:
    source = mission_from_tree(mission)
    plan, best = (planned(source, method) for method in ("plan", "central"))
    if plan is None:
        return
    assert best is not None, "central finds no plan where there is one"
    judged = [pose_mission(source).worth_of(one) for one in (plan, best)]
    assert judged[1] <= judged[0] + NEAR


@fuzzed(15, "plan FILE --from PLAN --time-limit 0", mission=continuous_missions(), method=METHODS)
def test_what_begins_with_a_plan_is_never_worse(mission: Any, method: str, folder: Path) -> None:
    """Whoever made that plan: its record is read, judged as any plan, and given back if best."""
    source = mission_from_tree(mission)
    made = planned(source, method)
    if made is None:
        return
    file = folder / "plan.json"
    save_record(carry_out(source, made, method), file)
    posed = pose_mission(source)
    again = plan_continuous(posed, "central", 0.0, read_start_plan(file, source))
    assert again is not None
    worst = posed.worth_of(made)
    assert posed.worth_of(again) <= worst + NEAR * max(1.0, worst)


@fuzzed(10, PLAN, mission=continuous_missions(), method=st.just("plan"))
def test_the_default_cost_written_out_makes_the_same_plan(mission: Any, method: str) -> None:
    source = replace(mission_from_tree(mission), cost=None)
    if not any(task.between for task in source.tasks):
        return
    written = replace(source, cost={"makespan": 1, "tardiness": 2})
    plans = [planned(one, method) for one in (source, written)]
    assert len({plan if plan is None else plan.routes for plan in plans}) == 1


@fuzzed(6, "plan FILE --method central", mission=continuous_missions(ROBOTS, TASKS))
def test_no_tiny_mission_has_a_better_plan(mission: Any) -> None:
    """Orders, and coalitions with robots to spare or without."""
    source = mission_from_tree(mission)
    if count_plans(source) <= MOST_PLANS_IN_STEPS:
        assert gap_in_continuous_time(source, "central", 10 * SECONDS) == 0.0


@fuzzed(25, PLAN, mission=continuous_missions(), method=METHODS)
def test_the_critical_path_adds_up(mission: Any, method: str) -> None:
    source = mission_from_tree(mission)
    made = planned(source, method)
    if made is None or not made.makespan:
        return
    record = carry_out(source, made, method)
    path = path_of_record(record)
    ends = [stretch.end for stretch in path]
    assert [stretch.begin for stretch in path] == [0, *ends[:-1]]
    assert ends[-1] == made.makespan
    for stretch in path:
        assert stretch.end > stretch.begin
        if stretch.doing in ("waiting", "idle"):
            raise AssertionError(f"nobody knows why: {stretch}")


@fuzzed(25, PLAN, mission=continuous_missions(), method=METHODS)
def test_a_plan_is_carried_out_as_it_was_made(mission: Any, method: str) -> None:
    source = mission_from_tree(mission)
    made = planned(source, method)
    if made is None:
        return
    record = carry_out(source, made, method)
    assert judge(record).findings == ()
    assert record.end.makespan == pytest.approx(made.makespan, abs=NEAR)
    for route, planned_route in zip(routes_of(record), made.routes, strict=True):
        assert [stop.task for stop in route.stops] == [it.task for it in planned_route.stops]
        for stop, it in zip(route.stops, planned_route.stops, strict=True):
            times = (it.arrive, it.start, it.end)
            assert (stop.arrive, stop.start, stop.end) == pytest.approx(times, abs=NEAR)
