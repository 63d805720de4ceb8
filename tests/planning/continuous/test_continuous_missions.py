"""Missions in continuous time: what is made of them as coalition problems, and told of plans."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from teamformer.base.errors import MissionError, TeamformerError
from teamformer.files.mission_files import read_mission, write_mission
from teamformer.mission.checks.costs import cost_of
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Grid, Place
from teamformer.mission.parts.roads import Roads
from teamformer.planning.continuous.continuous_mission import pose_mission
from teamformer.planning.continuous.rules import PLANNERS, plan_continuous
from teamformer.planning.continuous.solve import judge, measuring, solve
from teamformer.planning.problem.coalition_plan import empty_plan
from teamformer.planning.problem.coalition_problem import CoalitionProblem, pose_problem
from teamformer.planning.problem.routes import MissionPlan
from teamformer.planning.problem.schedule import COST, MAKESPAN, schedule_of
from teamformer.planning.race import Race

POLICIES = pytest.mark.parametrize("policy", PLANNERS)
WITH_COST = pytest.mark.parametrize("policy", ["central", "plan"])


def mission(robots: list[Robot], tasks: list[Task], world: Grid) -> Mission:
    return Mission("small", world, ("a", "b"), tuple(robots), tuple(tasks), time="continuous")


def robot(name: str, *at: int, can: str = "a") -> Robot:
    return Robot(name, at, {can: 1})


def planned(mission: Mission, policy: str, seconds: float = 0.2) -> MissionPlan:
    plan = plan_continuous(pose_mission(mission), policy, seconds)
    assert plan is not None
    return plan


@POLICIES
def test_forming_costs_nothing_where_robots_stand_together(policy: str) -> None:
    """Who starts where a task is stands where those do who have done it."""
    tasks = [Task("here", (0, 0), {"a": 1}), Task("there", (3, 0), {"a": 1, "b": 1})]
    robots = [robot("r1", 0, 0), robot("r2", 0, 0, can="b")]
    source = replace(mission(robots, tasks, Grid(4, 1)), forming=5.0)
    assert planned(source, policy).makespan == 3


@pytest.mark.parametrize("at", [(0, 0), (1, 0)])
def test_forming_is_paid_for_where_robots_come_from_two_places(at: Place) -> None:
    tasks = [Task("there", (3, 0), {"a": 1, "b": 1})]
    robots = [robot("r1", 0, 0), Robot("r2", at, {"b": 1})]
    source = replace(mission(robots, tasks, Grid(4, 1)), forming=5.0)
    assert planned(source, "plan").makespan == (3 if at == (0, 0) else 8)


def test_two_tasks_in_one_place_are_one_place_to_form_at() -> None:
    tasks = [
        Task("one", (2, 0), {"a": 1}),
        Task("two", (2, 0), {"b": 1}),
        Task("both", (5, 0), {"a": 1, "b": 1}, after=("one", "two")),
    ]
    robots = [robot("r1", 0, 0), robot("r2", 0, 0, can="b")]
    source = replace(mission(robots, tasks, Grid(6, 1)), forming=4.0)
    assert planned(source, "plan").makespan == 5


def at_one_moment() -> CoalitionProblem:
    """Pose three tasks in one place, of no duration, each after the one with the next number."""
    return pose_problem(
        ways=[np.abs(np.array([2, 2, 2, 0])[:, None] - 2).repeat(3, axis=1)],
        home=[[0, 0, 0, 0]],
        pace=[0],
        origin=[3],
        counts=[[1]],
        needs=[[1], [1], [1]],
        duration=[0, 0, 0],
        precedence=[(1, 0), (2, 1)],
    )


def test_a_plan_does_what_happens_at_one_moment_in_its_order() -> None:
    problem = at_one_moment()
    found = solve(problem, 10.0)
    assert found is not None
    assert found.is_proven
    assert found.plan.order.tolist() == [2, 1, 0]
    assert schedule_of(problem, found.plan).start.tolist() == [2, 2, 2]


def test_tasks_of_no_duration_that_follow_one_another_are_planned() -> None:
    """They meet at `u0` after 8 cells of r1; `last` is 11 on for r2, and `first` starts with it."""
    tasks = [
        Task("first", (1, 3), {"a": 1}, after=("last",)),
        Task("last", (7, 0), {"b": 1}),
        Task("u0", (2, 6), {"a": 1, "b": 1}),
        Task("u1", (2, 7), {"b": 1}),
    ]
    robots = [robot("r1", 8, 4), robot("r2", 3, 5, can="b")]
    assert planned(mission(robots, tasks, Grid(10, 10)), "central", 1.0).makespan == 19


def weighed(**cost: float) -> Mission:
    """Return a mission in which each robot has a task near it, and the left one another."""
    tasks = [Task(f"t{x}", (x, 0), {"a": 1}) for x in (1, 38, 2)]
    robots = [robot("left", 0, 0), robot("right", 39, 0)]
    return replace(mission(robots, tasks, Grid(40, 1)), cost=cost)


@WITH_COST
def test_a_weight_counts_however_small_it_is_beside_another(policy: str) -> None:
    """Nobody is ever late: all that there is to gain is short ways, 2 and 1 cells."""
    plan = planned(weighed(travel=0.001, tardiness=1e6), policy)
    assert [len(route.stops) for route in plan.routes] == [2, 1]
    assert plan.cost == pytest.approx(3 * 0.001 / (0.001 + 1e6))


@pytest.mark.parametrize("travel", [1 / 3, 1e-3, 1e6])
def test_the_curve_ends_at_the_cost_that_is_told(travel: float) -> None:
    plan = planned(weighed(travel=travel, makespan=7.0), "central")
    assert plan.cost == pytest.approx(cost_of({"travel": travel, "makespan": 7}, _parts(plan)))
    assert plan.curve[-1][1] == pytest.approx(plan.cost, rel=1e-6)


def _parts(plan: MissionPlan) -> dict[str, float]:
    """Return what a plan without homes is judged by; here robots are never kept waiting."""
    return {"makespan": plan.makespan, "travel": sum(route.back for route in plan.routes)}


@pytest.mark.parametrize("seed", range(5))
def test_central_is_never_worse_than_the_shared_plan(seed: int) -> None:
    """However little time it has."""
    rng = np.random.default_rng(seed)
    spots = rng.integers(0, 30, size=(12, 2)).tolist()
    tasks = [
        Task(f"t{n}", (x, y), {"ab"[n % 2]: 1}, between=(0.0, 20.0), duration=2)
        for n, (x, y) in enumerate(spots)
    ]
    robots = [robot(f"r{n}", 15, 15, can="ab"[n % 2]) for n in range(4)]
    source = mission(robots, tasks, Grid(30, 30))
    source = replace(source, cost={"tardiness": 3000.0, "travel": 1.0, "makespan": 0.5})
    central, shared = (planned(source, policy, 0.0).cost for policy in ("central", "plan"))
    assert central is not None
    assert shared is not None
    assert central <= shared + 1e-9


@pytest.mark.parametrize("policy", ["central", "plan"])
def test_a_plan_in_which_robots_go_where_no_way_leads_is_refused(policy: str) -> None:
    """Two tasks that start together need two robots, and only one can get there.

    r1 one @ . r2
        .  two @ . .
    """
    tasks = [
        Task("one", (1, 0), {"a": 1}),
        Task("two", (1, 1), {"a": 1}, starts={"one": (0.0, 1.0)}),
    ]
    source = mission([robot("r1", 0, 0), robot("r2", 4, 0)], tasks, Grid(5, 2, rows=("..@..",) * 2))
    with pytest.raises(TeamformerError, match="all can get to their tasks") as raised:
        planned(source, policy)
    assert "drop a link" in raised.value.hint


@POLICIES
def test_robots_that_are_apart_do_what_they_can_get_to(policy: str) -> None:
    tasks = [Task("left", (1, 0), {"a": 1}), Task("right", (3, 0), {"a": 1})]
    robots = [robot("r1", 0, 0), robot("r2", 4, 0)]
    source = mission(robots, tasks, Grid(5, 1, rows=("..@..",)))
    assert planned(source, policy).makespan == 1


def test_the_best_plan_is_over_first_however_early_robots_are_home_on_average() -> None:
    """Two robots are there after 100 ticks; one that can do it alone after 101, and nobody else.

    What a search goes by, which counts the mean time at home too, is less for the latter.
    """
    problem = pose_problem(
        ways=[[[0], [100], [101]]],
        home=[[0, 0, 0]] * 3,
        pace=[0, 0, 0],
        origin=[1, 1, 2],
        counts=[[1], [1], [2]],
        needs=[[2]],
        duration=[0],
    )
    plans = [empty_plan(problem) for _ in range(2)]
    for plan, coalition in zip(plans, ([0, 1], [2]), strict=True):
        plan.size[0], plan.coalition[0, : len(coalition)] = len(coalition), coalition
    first, alone = (schedule_of(problem, plan) for plan in plans)
    assert first.total[MAKESPAN] < alone.total[MAKESPAN]
    assert first.total[COST] > alone.total[COST]
    for known, other in ((first, alone), (alone, first)):
        measured = measuring(problem)
        race = Race(partial(judge, problem), measured(known.plan), begun=0.0, deadline=0.0)
        race.offer(measured(other.plan))
        assert race.judgement.value == race.plan.worth == 100


def roads(**movers: list[list[float]]) -> Roads:
    return Roads(("p0", "p1", "p2"), {name: tuple(map(tuple, t)) for name, t in movers.items()})


def on_roads(world: Roads, robots: list[Robot], at: list[str], **more: Any) -> Mission:
    """Return tasks that need one robot, at places by name."""
    tasks = tuple(Task(f"t{n}", world.at(name), {"a": 1}) for n, name in enumerate(at))
    return Mission("roads", world, ("a", "b"), tuple(robots), tasks, time="continuous", **more)


@POLICIES
def test_roads_are_taken_in_the_direction_that_is_shorter(policy: str) -> None:
    """Round one way 1 + 2 + 3, round the other 20 + 30 + 10."""
    world = roads(ground=[[0, 1, 10], [20, 0, 2], [3, 30, 0]])
    mission = on_roads(world, [Robot("r", world.at("p0"), {"a": 1})], ["p1", "p2"], ends="home")
    made = planned(mission, policy)
    assert (made.makespan, made.order) == (6, (0, 1))


@POLICIES
def test_the_way_to_where_a_mission_ends_is_not_the_way_from_there(policy: str) -> None:
    world = roads(ground=[[0, 1, 10], [20, 0, 2], [3, 30, 0]])
    robot = Robot("r", world.at("p0"), {"a": 1}, speed=2)
    made = planned(on_roads(world, [robot], ["p1"], ends=world.at("p2")), policy)
    assert made.makespan == (1 + 2) / 2


def test_movers_have_roads_of_their_own() -> None:
    world = roads(ground=[[0, 9, 9]] * 3, air=[[0, 2, 4], [5, 0, 9], [6, 9, 0]])
    robots = [Robot("r", world.at("p0"), {"a": 1}), Robot("d", world.at("p0"), {"b": 1})]
    mission = on_roads(world, [robots[0], replace(robots[1], moves="air")], ["p1"], ends="home")
    both = replace(mission.tasks[0], needs={"a": 1, "b": 1})
    made = planned(replace(mission, tasks=(both,)), "plan")
    assert [route.back for route in made.routes] == [9 + 0, 9 + 5]
    assert [route.stops[0].arrive for route in made.routes] == [9, 2]


NONE = math.inf


@POLICIES
def test_where_there_is_no_direct_way_robots_go_by_other_places(policy: str) -> None:
    """From p0 to p2 only by p1: 1 + 2 there, and 3 + 4 back; a direct way is taken, if longer."""
    world = roads(ground=[[0, 1, NONE], [4, 0, 2], [NONE, 3, 0]])
    robot = Robot("r", world.at("p0"), {"a": 1})
    made = planned(on_roads(world, [robot], ["p2"], ends="home"), policy)
    assert (made.makespan, made.is_proven) == (10, policy == "central")
    assert world.ways == {"ground": ((0, 1, 3), (4, 0, 2), (7, 3, 0))}
    assert world.longest_way == 7
    longer = roads(ground=[[0, 1, 9], [4, 0, 2], [NONE, 3, 0]])
    assert planned(on_roads(longer, [robot], ["p2"]), policy).makespan == 9


@pytest.mark.parametrize("policy", ["plan", "central"])
def test_no_robot_goes_first_to_where_no_way_leads_on(policy: str) -> None:
    """p1 is near, but who is there stays there; round by p2 it is 5 + 7."""
    world = roads(ground=[[0, 1, 5], [NONE, 0, NONE], [NONE, 7, 0]])
    mission = on_roads(world, [Robot("r", world.at("p0"), {"a": 1})], ["p1", "p2"])
    made = planned(mission, policy)
    assert (made.makespan, made.order) == (12, (1, 0))


def test_a_mission_that_nobody_comes_home_from_is_refused() -> None:
    world = roads(ground=[[0, 1, 5], [NONE, 0, NONE], [NONE, 7, 0]])
    mission = on_roads(world, [Robot("r", world.at("p0"), {"a": 1})], ["p1"], ends="home")
    with pytest.raises(TeamformerError, match="no plan was found in which all can get to") as told:
        planned(mission, "central")
    assert "give ways a time under roads" in told.value.hint


def test_a_lane_may_be_closed_to_a_mover() -> None:
    """The narrow one has no way from p0 to p1, so it stays out of the task there."""
    world = roads(
        ground=[[0, 5, 5], [5, 0, 5], [5, 5, 0]], narrow=[[0, NONE, 1], [1, 0, 1], [1, NONE, 0]]
    )
    robots = [Robot("r", world.at("p0"), {"a": 1}), Robot("n", world.at("p0"), {"a": 1})]
    robots[1] = replace(robots[1], moves="narrow")
    made = planned(on_roads(world, robots, ["p1"]), "plan")
    assert (made.makespan, made.coalitions) == (5, ((0,),))
    needs_both = on_roads(world, robots, ["p2"])
    both = replace(needs_both.tasks[0], at=world.at("p1"), needs={"a": 2})
    with pytest.raises(MissionError, match="cannot be reached by robots that bring a"):
        replace(needs_both, tasks=(both,))


def test_roads_with_gaps_are_written_and_read_back(tmp_path: Path) -> None:
    world = roads(ground=[[NONE, 1, NONE], [4.5, 0, 2], [NONE, 3, 0]])
    mission = on_roads(world, [Robot("r", world.at("p0"), {"a": 1})], ["p2"])
    for name in ("m.yaml", "m.json"):
        write_mission(mission, tmp_path / name)
        assert read_mission(tmp_path / name).world == world
    text = (tmp_path / "m.yaml").read_text()
    for way in ("inf", ".inf", "Infinity"):
        (tmp_path / "m.yaml").write_text(text.replace("p2,,3,0", f"p2, {way}, 3, 0"))
        assert read_mission(tmp_path / "m.yaml").world == world


def test_no_bound_forgets_that_a_detour_may_be_shorter() -> None:
    """Home from t1 takes 50, by way of t0 2: a plan that is over at 3 is there, and proven."""
    world = roads(ground=[[0, 10, 1], [1, 0, 60], [50, 1, 0]])
    mission = on_roads(world, [Robot("r", world.at("p0"), {"a": 1})], ["p1", "p2"], ends="home")
    made = planned(mission, "central")
    assert (made.makespan, made.is_proven) == (3, True)
    assert made.bound == pytest.approx(3, abs=1e-5)
