"""The reactive rule on missions: nobody decides about tasks that no way leads to."""

from __future__ import annotations

from teamformer.files.mission_files import mission_from_tree
from teamformer.planning.continuous.continuous_mission import pose_mission
from teamformer.planning.continuous.reactive import react
from teamformer.planning.continuous.rules import plan_continuous
from teamformer.planning.problem.coalition_problem import pose_problem

ISLANDS = {
    "teamformer": 1,
    "time": "continuous",
    "world": {"rows": [".", "@", "."]},
    "capabilities": ["a"],
    "robots": [{"at": [0, 0], "can": ["a"]}, {"at": [0, 2], "can": ["a"]}],
    "tasks": [
        {"at": [0, 0], "needs": ["a"]},
        {"at": [0, 0], "needs": ["a"]},
        {"at": [0, 2], "needs": ["a"]},
    ],
}
"""A robot on each side of a wall. The one below has nothing to do any more before the other."""


def test_what_all_robots_together_cannot_do_is_not_planned() -> None:
    problem = pose_problem(
        ways=[[[0, 0]] * 3],
        home=[[0, 0, 0]],
        pace=[0],
        origin=[2],
        counts=[[1, 0]],
        needs=[[1, 0], [0, 1]],
        duration=[1, 1],
    )
    assert react(problem) is None


def test_whoever_is_on_the_other_side_of_a_wall_is_not_sent() -> None:
    made = plan_continuous(pose_mission(mission_from_tree(ISLANDS)), "reactive", 0.0)
    assert made is not None
    stops = [{stop.task for stop in route.stops} for route in made.routes]
    assert stops == [{0, 1}, {2}]
    assert made.makespan == 0.0
