"""Missions in continuous time, with an end, precedence and windows: read, written, refused."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from teamformer.base.errors import MissionError
from teamformer.files.drawn.named_settings import world_of
from teamformer.files.mission_files import read_mission, write_mission
from teamformer.mission.checks.rules import (
    rules_not_planned,
    rules_not_played,
    rules_not_run,
    rules_of_fleets,
    rules_of_robotarium,
)
from teamformer.mission.model import Absence, Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.world.env import TeamFormation

ROBOT = Robot("r", (0, 0), {"a": 1})
MISSION = Mission(
    "mission",
    Grid(9, 9),
    ("a",),
    (ROBOT, replace(ROBOT, name="s")),
    (
        Task("x", (3, 3), {"a": 1}, duration=2.25),
        Task("y", (4, 4), {"a": 2}, after=("x",), between=(1.5, 80)),
    ),
    time="continuous",
    ends=(8, 8),
    forming=0.5,
)


@pytest.mark.parametrize("name", ["mission.yaml", "mission.json"])
def test_what_is_written_is_read(name: str, tmp_path: Path) -> None:
    write_mission(MISSION, tmp_path / name)
    assert read_mission(tmp_path / name) == MISSION


def test_circles_are_named() -> None:
    tasks = [Task(name, (1, 1), {"a": 1}, after=(after,)) for name, after in ("xz", "yx", "zy")]
    with pytest.raises(MissionError) as caught:
        replace(MISSION, tasks=tuple(tasks))
    assert str(caught.value) == (
        "'x', which is after 'z', which is after 'y', which is after 'x'; "
        "break this circle, drop one of these"
    )


def test_a_circle_is_found_behind_others() -> None:
    ways = {"v": (), "w": ("v",), "x": ("w", "z"), "y": ("x",), "z": ("w", "y")}
    tasks = tuple(Task(name, (1, 1), {"a": 1}, after=after) for name, after in ways.items())
    with pytest.raises(MissionError, match="'x', which is after 'z', which is after 'y'"):
        replace(MISSION, tasks=tasks)
    replace(MISSION, tasks=(*tasks[:2], replace(tasks[2], after=("w",)), *tasks[3:]))


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({}, "missions in continuous time are not played in steps"),
        ({"time": "steps"}, "in steps missions end with the last task"),
        ({"time": "steps", "ends": None}, "in steps forming_steps says what forming takes"),
    ],
)
def test_the_simulator_refuses_what_it_does_not_play(changes: dict[str, object], told: str) -> None:
    tasks = (replace(MISSION.tasks[0], duration=2), MISSION.tasks[1])
    mission = replace(MISSION, tasks=tasks, **changes)  # type: ignore[arg-type]
    with pytest.raises(MissionError, match=told):
        TeamFormation([mission])


def test_precedence_and_windows_are_for_all_but_the_robotarium() -> None:
    tasks = (replace(MISSION.tasks[0], duration=2), MISSION.tasks[1])
    mission = replace(MISSION, tasks=tasks, time="steps", ends=None, forming=0)
    assert list(rules_not_played(mission)) == []
    assert list(rules_of_fleets(mission)) == []
    told = [problem.message for problem in rules_of_robotarium(mission)]
    rest = "which the Robotarium does not know; drop {0}, or use `run`, `compare`, `plan`"
    assert told == [
        f"task 'y' has {key}, {rest.format(key)} or `live`" for key in ("after", "between")
    ]


def test_usual_missions_are_played() -> None:
    usual = replace(
        MISSION, tasks=(Task("x", (3, 3), {"a": 1}),), time="steps", ends=None, forming=0
    )
    assert list(rules_not_played(usual)) == []


@pytest.mark.parametrize(
    ("changes", "where"),
    [
        ({"duration": 1_000_000}, "duration"),
        ({"appears": 1_000_000}, "appears"),
        ({"between": (999_999.5, 2e6)}, "between"),
        ({"lasts": (1_000_000, 1_000_000)}, "duration"),
        ({"duration": 999_999}, None),
        ({"duration": 1_000_000, "cancelled": 5}, None),
        ({"lasts": (1, 10**9)}, None),
    ],
)
def test_missions_are_played_for_a_million_steps_at_most(
    changes: dict[str, Any], where: str | None
) -> None:
    """A task that comes after such a one is not blamed; a lower step limit ends the mission."""
    first, second = (replace(task, between=None, after=(), duration=1) for task in MISSION.tasks)
    tasks = (replace(first, **changes), second)
    usual = replace(MISSION, tasks=tasks, time="steps", ends=None, forming=0, step_limit=0)
    told = [problem.where for problem in rules_not_played(usual)]
    assert told == ([] if where is None else [("tasks", 0, where)])
    assert list(rules_not_played(replace(usual, step_limit=100))) == []
    chain = replace(usual, tasks=(tasks[0], replace(second, after=("x",))), step_limit=0)
    assert [problem.where for problem in rules_not_played(chain)][: len(told)] == told


def test_losses_are_run_and_not_planned_in_advance() -> None:
    lost = (replace(ROBOT, absences=(Absence(2.5, 4.25),)), MISSION.robots[1])
    mission = replace(MISSION, robots=lost)
    assert list(rules_not_run(mission)) == []
    told = "robot 'r' is lost, which a plan made in advance does not count with; drop lost, or use"
    [problem] = rules_not_planned(mission)
    assert problem.message.startswith(told)


@pytest.mark.parametrize(
    ("absences", "told"),
    [
        ((Absence(0),), "robot 'r' is lost at 0; use a time after 0, up to 1e9"),
        ((Absence(2, 2),), "robot 'r' is lost at 2 and back at 2; it must be back later"),
        ((Absence(2), Absence(3)), "robot 'r' is lost at 3, but has not come back before"),
        ((Absence(2, 4), Absence(3)), "robot 'r' is lost at 3; use a time after 4, up to 1e9"),
    ],
)
def test_times_of_losses_are_in_order(absences: tuple[Absence, ...], told: str) -> None:
    with pytest.raises(MissionError) as refused:
        replace(MISSION, robots=(replace(ROBOT, absences=absences), MISSION.robots[1]))
    assert str(refused.value).startswith(told)


def test_unreachable_ends_are_refused() -> None:
    island = Grid(3, 1, ("..@",))
    with pytest.raises(MissionError, match="inside an obstacle"):
        replace(MISSION, world=island, ends=(2, 0), tasks=(Task("x", (1, 0), {"a": 1}),))
    apart = Grid(3, 1, (".@.",))
    with pytest.raises(MissionError, match="robot 'r' has no way to where the mission ends"):
        replace(MISSION, world=apart, ends=(2, 0), tasks=(Task("x", (0, 0), {"a": 1}),))


def test_what_has_to_be_sure_refuses_all_that_is_not() -> None:
    mission = world_of("4N4T-C4-mixed", 0)
    told = {problem.where[-1]: problem.message for problem in rules_of_robotarium(mission)}
    assert set(told) == {"breaks", "duration", "may_need"}
    assert "write one number" in told["duration"]
    assert all("or use `run`, `compare`, `plan` or `live`" in text for text in told.values())
    assert list(rules_of_fleets(mission)) == []
    assert list(rules_of_robotarium(world_of("4N4T-C4", 0))) == []


def test_tasks_that_appear_at_random_are_for_who_need_not_be_sure() -> None:
    mission = world_of("4N4T-C4-calls", 0)
    [told] = rules_of_robotarium(mission)
    assert told.where == ("arrivals",)
    assert "drop arrivals, or use `run`, `compare`, `plan` or `live`" in told.message
    assert list(rules_not_played(mission)) == []


def test_continuous_time_takes_what_is_not_sure() -> None:
    mission = replace(world_of("4N4T-C4-mixed", 0), time="continuous")
    assert list(rules_not_run(mission)) == []
