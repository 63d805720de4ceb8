"""Missions that robots have no room for are refused, with the distance needed."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from teamformer.base.errors import MissionError
from teamformer.files.mission_files import read_mission, write_mission
from teamformer.mission.model import Absence, Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.mission.parts.plane import Plane
from teamformer.robotarium.mission_checks import apart_needed, check_mission, find_problems
from teamformer.robotarium.random_missions import random_mission


def mission(*robots: tuple[float, float], tasks: dict[tuple[float, float], int]) -> Mission:
    """Robots that can all do the same, and tasks that need so many of them."""
    return Mission(
        name="small",
        world=Plane(3.2, 2.0, step=0.99),
        capabilities=("a",),
        robots=tuple(Robot(f"r{r}", at, {"a": 1}) for r, at in enumerate(robots)),
        tasks=tuple(Task(f"t{k}", at, {"a": n}) for k, (at, n) in enumerate(tasks.items())),
    )


TWO = ((0.5, 0.5), (0.5, 1.5))


def test_room_at_the_exact_edge() -> None:
    """Two robots stand 0.23 m apart, 0.115 m from their task, 0.12 m from a wall: 0.235 m."""
    check_mission(mission(*TWO, tasks={(0.235, 1.0): 2}))
    with pytest.raises(
        MissionError, match=r"0.234 m from a wall.* 2 robots around it needs 0.235 m"
    ):
        check_mission(mission(*TWO, tasks={(0.234, 1.0): 2}))


def test_rings_must_not_touch() -> None:
    """Rings of 0.115 m and 0 m, with 0.23 m between them."""
    assert apart_needed(2, 1) == pytest.approx(0.345)
    check_mission(mission(*TWO, tasks={(1.0, 1.0): 2, (1.346, 1.0): 1}))
    with pytest.raises(MissionError, match=r"'t0' and 't1' are 0.344 m apart.* need 0.345 m"):
        check_mission(mission(*TWO, tasks={(1.0, 1.0): 2, (1.344, 1.0): 1}))


def test_starts_too_near() -> None:
    check_mission(mission((0.5, 0.5), (0.75, 0.5), tasks={(1.5, 1.0): 1}))
    with pytest.raises(MissionError, match=r"'r0' and 'r1' start 0.240 m apart; they need 0.25 m"):
        check_mission(mission((0.5, 0.5), (0.74, 0.5), tasks={(1.5, 1.0): 1}))
    with pytest.raises(MissionError, match=r"'r0' starts 0.100 m from a wall; it needs 0.12 m"):
        check_mission(mission((0.1, 0.5), tasks={(1.5, 1.0): 1}))


def test_at_most_twenty_robots() -> None:
    places = [(0.3 + 0.3 * x, 0.5 + 0.4 * y) for x in range(7) for y in range(3)]
    check_mission(mission(*places[:20], tasks={(2.7, 1.7): 1}))
    with pytest.raises(MissionError, match="there are 21 robots; Robotarium has 20"):
        check_mission(mission(*places, tasks={(2.7, 1.7): 1}))


def test_what_is_not_staged() -> None:
    good = mission(*TWO, tasks={(1.5, 1.0): 2})
    lost = (replace(good.robots[0], absences=(Absence(9),)), good.robots[1])
    for bad, message in (
        (replace(good, world=Plane(4.0, 2.0)), r"use world: \{plane: \[3.2, 2\]"),
        (replace(good, world=Plane(3.2, 2.0, step=0.1)), "robots need 0.33 s or more"),
        (replace(good, robots=(*lost, Robot("r9", (2.0, 1.0), {"a": 1}))), "lost"),
    ):
        with pytest.raises(MissionError, match=message):
            check_mission(bad)
    robots, tasks = (Robot("r", (0, 0), {"a": 1}),), (Task("t", (1, 1), {"a": 1}),)
    grid = Mission("grid", Grid(4, 2), ("a",), robots, tasks)
    with pytest.raises(MissionError, match="is a plane"):
        check_mission(grid)


def test_random_missions_are_possible_and_repeat() -> None:
    for seed in range(20):
        one = random_mission(20, 5, 10, np.random.default_rng(seed))
        check_mission(one)
        assert one == random_mission(20, 5, 10, np.random.default_rng(seed))


def test_what_is_wrong_in_a_file_is_told_by_line(tmp_path: Path) -> None:
    path = tmp_path / "small.yaml"
    write_mission(mission((0.5, 0.5), (0.7, 0.5), tasks={(0.1, 1.0): 2}), path)
    lines = path.read_text().splitlines()
    r1, t0 = (next(n for n, line in enumerate(lines, 1) if name in line) for name in ("r1", "t0"))
    with pytest.raises(MissionError) as caught:
        read_mission(path, find_problems)
    first, second = str(caught.value).splitlines()
    assert first.startswith(f"{path}:{r1}: robots 'r0' and 'r1' start 0.200 m apart")
    assert second.startswith(f"{path}:{t0}: task 't0' is 0.100 m from a wall")
