"""Linked starts and costs in mission files: read, written, refused."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from teamformer.base.errors import MissionError
from teamformer.files.mission_files import read_mission, write_mission
from teamformer.mission.checks.costs import cost_of
from teamformer.mission.checks.links import can_be_apart, groups_of
from teamformer.mission.checks.rules import rules_not_played
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.capabilities import covers, total
from teamformer.mission.parts.grid import Grid

X, Y, Z, ALONE = (Task(name, (1, 1), {"a": 1}, duration=2) for name in ("x", "y", "z", "alone"))
MISSION = Mission(
    "mission",
    Grid(9, 9),
    ("a",),
    tuple(Robot(name, (0, 0), {"a": 1}) for name in "pqr"),
    (X, replace(Y, starts={"x": (3, 4.5)}), replace(Z, starts={"y": (0, 0)}), ALONE),
    time="continuous",
    cost={"travel": 1, "tardiness": 2.5},
)


@pytest.mark.parametrize("name", ["mission.yaml", "mission.json"])
def test_what_is_written_is_read(name: str, tmp_path: Path) -> None:
    write_mission(MISSION, tmp_path / name)
    assert read_mission(tmp_path / name) == MISSION


def test_groups_are_linked_by_others_too() -> None:
    assert groups_of(MISSION.tasks) == [[0, 1, 2], [3]]


def test_a_cost_is_the_mean_by_weight() -> None:
    parts = {"makespan": 100.0, "travel": 10.0, "tardiness": 3.0, "max_tardiness": 2.0}
    assert cost_of({"travel": 1, "tardiness": 3}, parts) == (10 + 9) / 4
    assert cost_of({"makespan": 7}, parts) == 100


TASKS = MISSION.tasks


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"cost": {}}, "the cost has no weights; name makespan, travel, tardiness"),
        ({"cost": {"money": 1}}, "a cost has no 'money'; use makespan, travel"),
        ({"cost": {"travel": 0}}, "the weight of travel is 0; use 0.001 to"),
        ({"cost": {"travel": -1}}, "the weight of travel is -1; use 0.001 to"),
        ({"cost": {"travel": float("nan")}}, "the weight of travel is nan"),
        (
            {"tasks": (X, replace(Y, starts={"w": (0, 0)}))},
            "the start of task 'y' is linked with 'w', which is no task; name one",
        ),
        ({"tasks": (replace(X, starts={"x": (0, 0)}),)}, "task 'x' is linked with itself"),
        (
            {"tasks": (X, replace(Y, starts={"x": (4, 3)}))},
            "task 'y' starts 4 to 3 after 'x'; use [least, most], 0 or more and in this order",
        ),
        (
            {"tasks": (X, *TASKS[1:2], replace(Z, starts={"x": (0, 1), "y": (0, 1)}))},
            "the gaps between the starts of 'x', 'y', 'z' contradict one another",
        ),
        (
            {"tasks": (X, replace(Y, starts={"x": (0, 0)}, needs={"a": 3}))},
            "'x', 'y' are done by different robots, and all together lack a",
        ),
        (
            {"tasks": (X, replace(TASKS[1], after=("x",)))},
            "task 'y' is after 'x', with which its start is linked; drop after, the link says it",
        ),
        (
            {"tasks": (replace(X, after=("alone",)), TASKS[1], replace(ALONE, after=("y",)))},
            "'alone', 'x', or tasks whose starts are linked with theirs, wait for one another",
        ),
    ],
)
def test_what_cannot_be_is_refused(changes: dict[str, Any], told: str) -> None:
    with pytest.raises(MissionError) as caught:
        replace(MISSION, **changes)
    assert told in str(caught.value)


BOTH, ONLY_A = Robot("both", (0, 0), {"a": 1, "b": 1}), Robot("one", (0, 0), {"a": 1})


@pytest.mark.parametrize(
    ("robots", "x", "y", "can_be"),
    [
        ([BOTH, ONLY_A], {"b": 1}, {"a": 1}, True),
        ([BOTH, BOTH], {"b": 1}, {"a": 1}, True),
        ([BOTH, BOTH], {"a": 1, "b": 1}, {"a": 1, "b": 1}, True),
        ([BOTH, BOTH, ONLY_A], {"b": 2}, {"a": 1}, True),
        ([BOTH, BOTH], {"b": 2}, {"a": 0.5}, False),  # all bring 2 of either
        ([BOTH, ONLY_A, ONLY_A], {"b": 1}, {"a": 2}, True),
        ([BOTH, BOTH, ONLY_A], {"a": 1, "b": 1}, {"a": 1, "b": 1}, True),
        ([BOTH, BOTH, ONLY_A], {"a": 2, "b": 1}, {"a": 1, "b": 1}, True),
        ([BOTH, BOTH, ONLY_A], {"a": 1, "b": 2}, {"a": 1}, True),
        ([BOTH, BOTH, ONLY_A], {"b": 2}, {"a": 2}, False),  # `both` cannot be at two places
    ],
)
def test_tasks_that_need_the_same_robot_are_not_linked(
    robots: list[Robot], x: dict[str, float], y: dict[str, float], can_be: bool
) -> None:
    fleet = tuple(replace(robot, name=f"r{number}") for number, robot in enumerate(robots))
    tasks = (replace(X, needs=x), replace(Y, needs=y, starts={"x": (0, 0)}))
    wanted = {"capabilities": ("a", "b"), "robots": fleet, "tasks": tasks}
    if can_be:
        replace(MISSION, **wanted)
        return
    with pytest.raises(MissionError) as caught:
        replace(MISSION, **wanted)
    told = "'x', 'y' are done by different robots, and some robot is needed by two of them"
    assert told in str(caught.value)


@pytest.mark.parametrize("seed", range(30))
def test_robots_are_dealt_out_as_every_way_to_do_so_says(seed: int) -> None:
    rng = np.random.default_rng(seed)
    robots = [{"a": int(rng.integers(3)), "b": 0.5 * int(rng.integers(3))} for _ in range(5)]
    needs = [{"a": int(rng.integers(1, 4)), "b": 0.5 * int(rng.integers(4))} for _ in range(2)]
    for is_able in (np.ones((5, 2), bool), rng.random((5, 2)) < 0.7):
        ways = product((0, 1, 2), repeat=len(robots))
        groups = (
            [[robots[r] for r, to in enumerate(way) if to == n and is_able[r, n]] for n in (0, 1)]
            for way in ways
        )
        can_be = any(all(map(covers, map(total, group), needs)) for group in groups)
        assert can_be_apart(needs, robots, lambda r, n, able=is_able: able[r, n]) == can_be


FILE = """teamformer: 1
world: {grid: [9, 9]}
capabilities: [a]
robots: [{at: [0, 0], can: [a], count: 2}]
tasks:
  - {name: x, at: [1, 1], needs: [a]}
  - {name: y, at: [1, 1], needs: [a], starts: STARTS}
time: continuous
cost: COST
"""


@pytest.mark.parametrize(
    ("starts", "cost", "told"),
    [
        ("[x]", "{travel: 1}", ":7: starts of task 2 is a list; write {TASK: [least, most]}"),
        ("{x: 3}", "{travel: 1}", ":7: x of starts of task 2 is 3; write it as [least, most]"),
        (
            "{x: [3, soon]}",
            "{travel: 1}",
            ":7: entry 2 of x of starts of task 2 is the text 'soon'",
        ),
        ("{x: [3, 4]}", "{travl: 1}", ":9: cost has no key 'travl'; did you mean 'travel'?"),
        ("{x: [3, 4]}", "7", ":9: cost is 7; write a mapping of makespan, travel"),
        ("{x: [3, 4]}", "{travel: much}", ":9: travel of cost is the text 'much'; write a number"),
        ("{w: [3, 4]}", "{travel: 1}", ":7: the start of task 'y' is linked with 'w', which is no"),
    ],
)
def test_files_are_refused_by_line(starts: str, cost: str, told: str, tmp_path: Path) -> None:
    path = tmp_path / "mission.yaml"
    path.write_text(FILE.replace("STARTS", starts).replace("COST", cost))
    with pytest.raises(MissionError) as caught:
        read_mission(path)
    assert told in str(caught.value)


def test_missions_in_steps_have_neither() -> None:
    told = [problem.message for problem in rules_not_played(replace(MISSION, time="steps"))]
    remedy = "write time: continuous"
    assert told == [
        "in steps a cost may weigh makespan, tardiness, max_tardiness, completion, missed; "
        f"drop travel, or {remedy}",
        f"task 'y' has starts, which are for continuous time; {remedy}",
        f"task 'z' has starts, which are for continuous time; {remedy}",
    ]
