"""Pins: robots that take part in any case, and tasks that are only for some."""

from __future__ import annotations

from pathlib import Path

import pytest

from teamformer.base.errors import MissionError
from teamformer.files.mission_files import read_mission, write_mission
from teamformer.methods.by_name import load_method
from teamformer.mission.model import Mission
from teamformer.record.referee.judge import judge
from teamformer.trials.planned import plan_mission
from teamformer.trials.trial import run_trial

MISSION = """\
teamformer: 1
world: {rows: ["......@.", "......@."]}
capabilities: [lift, scan]
robots:
  - {name: near, at: [3, 0], can: [lift]}
  - {name: far, at: [0, 0], can: {lift: 2}}
  - {name: eye, at: [0, 1], can: [scan]}
  - {name: cut off, at: [7, 0], can: [lift]}
tasks:
  - {name: crate, at: [5, 0], needs: [lift]}
"""


def mission(folder: Path, pins: str, text: str = MISSION) -> Mission:
    path = folder / "m.yaml"
    path.write_text(text.replace("needs: [lift]}\n", f"needs: [lift], {pins}}}\n"))
    return read_mission(path)


def who_did(mission: Mission, method: str) -> tuple[int | None, set[str]]:
    """Return the makespan, and who was in the team that did the last task."""
    record = run_trial(mission, load_method(method, time_limit=0.0), 0).record
    assert judge(record).findings == ()
    [(_, slot)] = [pair for step in record.steps for pair in step.done]
    rows: dict[int, set[int]] = {r: {r} for r in range(len(mission.robots))}
    for step in record.steps:
        for one, other in step.joins:
            rows[min(one, other)] = rows.pop(one) | rows.pop(other)
    return record.end.makespan, {mission.robots[r].name for r in rows[slot]}


@pytest.mark.parametrize("method", ["plan", "crews", "central", "heuristic", "join-fitting"])
@pytest.mark.parametrize(
    ("pins", "makespan", "who"),
    [
        ("only: [near, far]", 2, {"near"}),
        ("only: [far]", 5, {"far"}),
        ("with: [far]", 5, {"far"}),
        ("only: [far, eye], with: [eye]", 7, {"far", "eye"}),
    ],
)
def test_who_is_pinned_does_it(
    tmp_path: Path, pins: str, makespan: int, who: set[str], method: str
) -> None:
    """From x = 3 it is 2 cells, from x = 0 5, with the other row 6; a join takes a step."""
    assert who_did(mission(tmp_path, pins), method) == (makespan, who)


def test_plans_in_continuous_time_keep_pins(tmp_path: Path) -> None:
    text = MISSION.replace("teamformer: 1\n", "teamformer: 1\ntime: continuous\n")
    made = plan_mission(mission(tmp_path, "with: [eye]", text), "plan", 1.0)
    assert made is not None
    assert made.makespan == 6.0
    assert made.coalitions == ((0, 2),)
    made = plan_mission(mission(tmp_path, "only: [far]", text), "plan", 1.0)
    assert made is not None
    assert made.coalitions == ((1,),)


def test_pins_are_said_in_capabilities(tmp_path: Path) -> None:
    pinned = mission(tmp_path, "only: [near, far], with: [near]")
    assert pinned.capabilities == ("lift", "scan", "lift of near, far", "robot near")
    assert pinned.tasks[0].needs == {"lift of near, far": 1, "robot near": 1}
    assert pinned.robots[0].can == {"lift": 1, "lift of near, far": 1, "robot near": 1}
    assert pinned.robots[1].can == {"lift": 2, "lift of near, far": 2}
    assert pinned.robots[2].can == {"scan": 1}
    write_mission(pinned, tmp_path / "again.yaml")
    assert read_mission(tmp_path / "again.yaml").tasks == pinned.tasks


def test_a_name_stands_for_all_robots_of_its_entry(tmp_path: Path) -> None:
    text = MISSION.replace("at: [3, 0], can: [lift]", "at: [3, 0], can: [lift], count: 2")
    by_group = mission(tmp_path, "only: [near, eye], with: [near]", text)
    by_robot = mission(tmp_path, "only: [near-1, near-2, eye], with: [near-2, near-1]", text)
    assert by_group == by_robot
    assert by_group.tasks[0].needs == {
        "lift of near-1, near-2, eye": 1,
        "robot near-1": 1,
        "robot near-2": 1,
    }
    as_team = mission(tmp_path, "only: [near]", f"{text}teams: [[near]]\n")
    assert as_team.teams == ((0, 1),)


def test_a_robot_of_its_own_goes_before_a_group_of_that_name(tmp_path: Path) -> None:
    text = MISSION.replace("name: far", "name: near, count: 2")
    assert "lift of near" in mission(tmp_path, "only: [near]", text).tasks[0].needs


@pytest.mark.parametrize(
    ("pins", "message"),
    [
        ("only: [nobody]", "there is no robot 'nobody'; write the name of one"),
        ("with: []", "with names no robot; name one, or drop it"),
        ("only: near", "only of task 1 is the text 'near'; write a list"),
        ("only: [eye]", "task 'crate' is only for robots that together lack lift; name more"),
        ("only: [near], with: [far]", "task 'crate' is with 'far', but only for others; add it"),
        ("with: [cut off]", "task 'crate' is with 'cut off', which no way leads there; move one"),
        (
            "only: [cut off]",
            "task 'crate' is only for robots that together lack lift, as no way leads 'cut off'",
        ),
    ],
)
def test_pins_that_nobody_can_meet(tmp_path: Path, pins: str, message: str) -> None:
    with pytest.raises(MissionError) as told:
        mission(tmp_path, pins)
    assert f"m.yaml:10: {message}" in str(told.value)
    assert len(str(told.value).splitlines()) == 1


def test_no_pins_with_tasks_that_may_need_anything(tmp_path: Path) -> None:
    text = MISSION + "arrivals: {rate: 0.1, until: 9}\n"
    with pytest.raises(MissionError, match=r"m.yaml:11: tasks that appear at random may need"):
        mission(tmp_path, "with: [near]", text)
