"""The examples: they are read, and show what they say they show."""

from __future__ import annotations

from pathlib import Path

import pytest

from teamformer.files.mission_files import read_mission
from teamformer.methods.scripted.heuristic import Heuristic
from teamformer.methods.scripted.joining import JoinAll
from teamformer.methods.seam.protocol import Policy
from teamformer.mission.model import Mission
from teamformer.mission.parts.capabilities import covers, total
from teamformer.trials.trial import run_trials

EXAMPLES = Path(__file__).parents[2] / "examples"


def example(name: str) -> Mission:
    return read_mission(EXAMPLES / f"{name}.yaml")


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.yaml")), ids=lambda path: path.stem)
def test_every_example_is_read(path: Path) -> None:
    assert len(read_mission(path).tasks) >= 3


@pytest.mark.parametrize("policy", [JoinAll(), Heuristic()], ids=["join-all", "heuristic"])
def test_every_example_can_be_done_and_takes_teamwork(policy: Policy) -> None:
    missions = [read_mission(path) for path in sorted(EXAMPLES.glob("*.yaml"))]
    missions = [mission for mission in missions if mission.time == "steps"]
    for mission, tally in zip(missions, run_trials(missions, policy), strict=True):
        assert tally.status == "completed", mission.name
        assert tally.joins > 0
        assert max(task.appears for task in mission.tasks) < tally.steps  # all of it is seen
        assert all(away.lost < tally.steps for r in mission.robots for away in r.absences)


def test_the_warehouse_shows_what_a_mission_can_hold() -> None:
    mission = example("warehouse")
    assert (mission.world.width, mission.world.height) == (24, 16)
    assert any("@" in row for row in mission.world.rows)
    assert 6 <= len(mission.robots) <= 8
    assert len(mission.capabilities) == 4
    assert any(len(robot.can) == 2 for robot in mission.robots)
    assert any(robot.speed < 1 for robot in mission.robots)
    assert any(max(task.needs.values()) == 2 for task in mission.tasks)
    assert any(task.duration for task in mission.tasks)
    assert any(task.appears for task in mission.tasks)


def test_four_robots_are_the_papers_smallest_test() -> None:
    mission = example("four-robots")
    assert (mission.world.width, mission.world.height) == (10, 10)
    assert (len(mission.robots), len(mission.tasks), len(mission.capabilities)) == (4, 4, 4)
    assert (mission.sensing_radius, mission.join_radius) == (1.0, 0.0)


def test_after_the_breakdown_every_task_can_still_be_done() -> None:
    mission = example("breakdown")
    left = total(robot.can for robot in mission.robots if not robot.absences)
    assert any(robot.absences for robot in mission.robots)
    assert all(covers(left, task.needs) for task in mission.tasks)


def test_late_tasks_are_unknown_at_the_start() -> None:
    appears = [task.appears for task in example("late-tasks").tasks]
    assert min(appears) == 0
    assert max(appears) > 0
