"""Robots that fly: walls are in nobody's way who flies, and in everybody's who does not."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from coordinations import RandomPlans
from random_worlds import random_decision, random_world
from teamformer.base.errors import MissionError, TeamformerError
from teamformer.files.drawn.named_settings import world_of
from teamformer.files.mission_files import read_mission
from teamformer.methods.by_name import load_method
from teamformer.methods.coordinators.crews import Crews
from teamformer.methods.coordinators.shared_plan import SharedPlan
from teamformer.mission.model import Absence, Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.record.referee.judge import judge
from teamformer.trials.trial import run_trial
from teamformer.world.env import Decision, TeamFormation
from twins import Twin

WALL = Grid(5, 3, ("..@..", "..@..", "....."))
"""A wall with a way around it at the bottom, y = 2."""


def flyer(can: str, x: int, y: int = 0, speed: float = 1.0, **more: object) -> Robot:
    return Robot(f"{can}{x}", (x, y), dict.fromkeys(can, 1), speed, moves="air", **more)  # type: ignore[arg-type]


def walker(can: str, x: int, y: int = 0, speed: float = 1.0) -> Robot:
    return Robot(f"{can}{x}", (x, y), dict.fromkeys(can, 1), speed)


def mission(robots: list[Robot], tasks: list[Task], **rules: object) -> Mission:
    return Mission("m", WALL, ("a", "b"), tuple(robots), tuple(tasks), **rules)  # type: ignore[arg-type]


def makespan(mission: Mission, method: str = "plan") -> int | None:
    trial = run_trial(mission, load_method(method, time_limit=0.0), 0)
    assert judge(trial.record).findings == ()
    return trial.record.end.makespan


@pytest.mark.parametrize("method", ["plan", "crews", "central", "heuristic", "join-all"])
def test_a_flyer_takes_the_straight_way_and_a_walker_the_way_around(method: str) -> None:
    """From (1, 0) to (3, 0): 2 cells over the wall, 6 around it."""
    there = Task("t", (3, 0), {"a": 1})
    assert makespan(mission([flyer("a", 1)], [there]), method) == 2
    assert makespan(mission([walker("a", 1)], [there]), method) == 6


def test_a_team_with_anybody_on_the_ground_walks() -> None:
    """Together 6 cells around; apart the flyer is there early and joins the walker: 6, and one."""
    both = Task("t", (3, 0), {"a": 1, "b": 1})
    robots = [flyer("a", 1), walker("b", 1)]
    assert makespan(mission(robots, [both], teams=((0, 1),))) == 6
    assert makespan(mission(robots, [both])) == 7


def test_a_mixed_team_is_as_slow_as_its_slowest_on_the_way_of_the_walker() -> None:
    """At half a cell a step 6 cells take 12 steps; apart, 6 steps around and a join take 7."""
    both = Task("t", (3, 0), {"a": 1, "b": 1})
    robots = [flyer("a", 1, speed=0.5), walker("b", 1)]
    env = TeamFormation([mission(robots, [both], teams=((0, 1),))])
    for _ in range(11):
        env.step(Decision(env.view().counts.copy()))
    assert env.worlds.tasks["done_at"][0].tolist() == [-1]
    env.step(Decision(env.view().counts.copy()))
    assert env.worlds.tasks["done_at"][0].tolist() == [12]
    assert makespan(mission(robots, [both], teams=((0, 1),))) == 12
    assert makespan(mission(robots, [both])) == 7


def test_what_is_lost_over_a_wall_comes_back_there_and_flies_on() -> None:
    """Lost in the step in which it enters the wall, back three steps later, then one cell more."""
    away = (Absence(1, 4),)
    robot = replace(flyer("a", 1), absences=away)
    assert makespan(mission([robot], [Task("t", (3, 0), {"a": 1})])) == 5


def test_nobody_walks_to_a_partner_that_is_over_a_wall() -> None:
    """The flyer stands over the wall after a step; who wants to join it on foot stays."""
    robots = [flyer("a", 1), walker("b", 0)]
    task = Task("t", (4, 0), {"a": 1, "b": 1})
    env = TeamFormation([mission(robots, [task], sensing_radius=5.0, join_radius=5.0)])
    stay = env.view().counts.copy()
    env.step(Decision(stay))
    assert (env.worlds.teams["x"][0] == [2, 1]).all()  # one over the wall, one towards the gap
    wanted = env.view().counts.copy()
    wanted[1] = [1, 1]
    before = env.worlds.teams[["x", "y"]][0, 1]
    env.worlds.tasks["x"][0] = 2  # keep the flyer where it is
    env.step(Decision(wanted))
    assert env.worlds.teams[["x", "y"]][0, 1] == before


def test_an_island_is_for_those_who_fly(tmp_path: Path) -> None:
    island = Grid(3, 1, (".@.",))
    there = Task("t", (2, 0), {"a": 1})
    alone = Mission("m", island, ("a", "b"), (flyer("a", 0), walker("b", 0)), (there,))
    for method in ("plan", "crews", "central", "heuristic"):
        assert makespan(alone, method) == 2
    with pytest.raises(MissionError, match="cannot be reached by robots that bring b; move it"):
        replace(alone, tasks=(replace(there, needs={"a": 1, "b": 1}),))


def test_a_file_says_how_robots_move(tmp_path: Path) -> None:
    path = tmp_path / "m.yaml"
    text = (
        "teamformer: 1\nworld: {rows: ['.@.']}\ncapabilities: [a, b]\nrobots:\n"
        "  - {name: eye, at: [0, 0], can: [a], moves: air}\n"
        "  - {name: cart, at: [0, 0], can: [b], moves: ground}\n"
        "tasks:\n  - {at: [2, 0], needs: [a]}\n"
    )
    path.write_text(text)
    assert [robot.flies for robot in read_mission(path).robots] == [True, False]
    path.write_text(text.replace("moves: air", "moves: water"))
    with pytest.raises(TeamformerError) as told:
        read_mission(path)
    assert "m.yaml:5: moves of robot 1 is 'water'; write ground or air" in str(told.value)
    path.write_text(text.replace("needs: [a]", "needs: [a, b]"))
    with pytest.raises(TeamformerError) as told:
        read_mission(path)
    message = "m.yaml:8: task 't1' cannot be reached by robots that bring b; move it, open the map"
    assert message in str(told.value)


def with_flyers(rng: np.random.Generator) -> Mission:
    """Return a world with many walls, maybe with islands, and robots of which some fly."""
    while True:
        mission = random_world(rng)
        world = mission.world
        assert isinstance(world, Grid)
        flies = rng.random(len(mission.robots)) < 0.5
        is_used = {thing.at for thing in (*mission.robots, *mission.tasks)}
        rows = tuple(
            "".join(
                "@" if rng.random() < 0.35 and (x, y) not in is_used else "."
                for x in range(world.width)
            )
            for y in range(world.height)
        )
        robots = tuple(
            replace(robot, moves="air" if up else "ground")
            for robot, up in zip(mission.robots, flies, strict=True)
        )
        try:
            return replace(mission, world=replace(world, rows=rows), robots=robots, step_limit=0)
        except MissionError:
            continue


@pytest.mark.parametrize("part", range(3))
@pytest.mark.thorough
def test_steps_with_flyers_are_what_the_plain_twin_does(part: int) -> None:
    rng = np.random.default_rng([part, 40])
    for number in range(40):
        coordinator = {0: None, 1: RandomPlans(number), 2: SharedPlan()}[number % 3]
        mission = with_flyers(rng)
        env = TeamFormation([mission], coordinator=coordinator)
        twin = Twin(env)
        while env.is_running[0] and env.tally().steps < 30:
            view = env.view()
            is_planned = coordinator is not None and rng.random() < 0.6
            decision = env.planned_decision(view) if is_planned else random_decision(view, rng)
            twin.step(view, decision)


@pytest.mark.parametrize("method", ["plan", "crews", "heuristic"])
def test_missions_with_flyers_end_and_are_legal(method: str) -> None:
    rng = np.random.default_rng(41)
    player = {"plan": SharedPlan(), "crews": Crews()}.get(method) or load_method(method)
    for _ in range(25):
        mission = with_flyers(rng)
        trial = run_trial(mission, player, 0)
        assert trial.record.end.status in ("completed", "infeasible")
        assert judge(trial.record).findings == ()


@pytest.mark.parametrize("kind", ["", "-lost", "-arrivals", "-all"])
@pytest.mark.thorough
def test_the_family_is_played_legally(kind: str) -> None:
    mission = world_of(f"air-ground{kind}", 3)
    assert any(robot.flies for robot in mission.robots)
    assert {robot.flies for robot in mission.robots if "scan" not in robot.can} == {False}
    trial = run_trial(mission, load_method("plan"), 0)
    assert trial.record.end.status == "completed"
    assert judge(trial.record).findings == ()
