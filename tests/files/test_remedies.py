"""What a message advises is tried: it helps, and leads to no message that advises to go back."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import teamformer as tf
from small_worlds import make, robot, task
from teamformer.base.errors import MissionError, TeamformerError
from teamformer.cli.verbs.missions.draw_map import draw_map
from teamformer.files.mission_files import read_mission
from teamformer.mission.checks.rules import (
    VERBS,
    rules_not_known_beforehand,
    rules_not_planned,
    rules_not_played,
    rules_of_robotarium,
)
from teamformer.mission.model import Absence, Arrivals, Breakdown, Delays, Mission
from teamformer.mission.parts.grid import Grid

FIRST, SECOND = task("a", 9), task("a", 3)
MISSION = make([robot("a", 0), robot("a", 5)], [FIRST, SECOND])


def tasks(**first: Any) -> Mission:
    """Return the mission with its first task changed."""
    return replace(MISSION, tasks=(replace(MISSION.tasks[0], **first), MISSION.tasks[1]))


def robots(**first: Any) -> Mission:
    """Return the mission with its first robot changed."""
    return replace(MISSION, robots=(replace(MISSION.robots[0], **first), MISSION.robots[1]))


FLYING = replace(robots(moves="air"), world=Grid(20, 2, ("." * 20, "@" * 20)))
OTHERS_FOR = {
    "after": (tasks(after=("t1",)), "run compare plan live"),
    "between": (tasks(between=(0, 90)), "run compare plan live"),
    "cancelled": (tasks(cancelled=9), "run compare live"),
    "cancelled, with a window": (tasks(cancelled=9, between=(0, 90)), "run compare live"),
    "flying": (FLYING, "run compare plan live"),
    "unsure duration": (tasks(lasts=(1, 3)), "run compare plan live"),
    "unsure needs": (tasks(may_need={"a": 0.5}), "run compare plan live"),
    "unsure place": (tasks(within=2.0), "run compare plan live"),
    "breakdowns": (robots(breaks=Breakdown(0.01, (1, 2))), "run compare plan live"),
    "delays": (robots(delays=Delays(0.1)), "run compare plan live"),
    "unsure and arrivals": (
        replace(tasks(lasts=(1, 3)), arrivals=Arrivals(0.1, 5)),
        "run compare plan live",
    ),
}


@pytest.mark.parametrize("name", OTHERS_FOR)
def test_the_verbs_that_robots_of_their_own_send_to_take_the_mission(name: str) -> None:
    mission, verbs = OTHERS_FOR[name]
    told = [problem.message for problem in rules_of_robotarium(mission)]
    assert told
    for message in told:
        if "which the Robotarium" in message:
            named = re.findall("`([a-z]+)`", message)
            assert named == verbs.split()
            assert [list(VERBS[verb](mission)) for verb in named] == [[] for _ in named]


def test_what_keeps_a_plan_from_being_made_beforehand_is_run() -> None:
    mission = tasks(cancelled=9)
    [problem] = rules_not_known_beforehand(mission)
    assert problem.message.endswith(
        "; drop cancelled, or use `teamformer run` with its default method"
    )
    assert list(rules_not_played(mission)) == []
    assert tf.run(mission).completed
    assert list(rules_not_planned(tasks(cancelled=None))) == []
    with pytest.raises(MissionError, match="use `teamformer run` with its default"):
        tf.run(mission, method="central", seconds=0.1)


@pytest.mark.parametrize(
    "mission",
    [
        replace(MISSION, ends="home"),
        replace(MISSION, forming=2.0),
        replace(MISSION, cost={"travel": 1.0}),
        tasks(starts={"t1": (0, 9)}),
    ],
)
def test_what_steps_do_not_know_is_planned_in_continuous_time(mission: Mission) -> None:
    [problem] = rules_not_played(mission)
    assert problem.message.endswith("write time: continuous")
    assert list(rules_not_planned(replace(mission, time="continuous"))) == []


def test_what_many_have_is_told_once_with_their_names() -> None:
    many = [task("a", 3) for _ in range(15)]
    mission = make([robot("a", 0)], many)
    late = replace(mission, tasks=tuple(replace(t, between=(0, 90)) for t in mission.tasks))
    [problem] = rules_of_robotarium(late)
    named = "task 't0' has between (likewise 't1', 't2', 't3', 't4', 't5', 9 more), which the Robot"
    assert problem.message.startswith(named)
    assert problem.where == ("tasks", 0, "between")
    lost = tuple(replace(it, absences=(Absence(3),)) for it in MISSION.robots)
    [problem] = rules_not_planned(replace(MISSION, robots=lost, time="continuous"))
    told = "robot 'r0' is lost (likewise 'r1'), which a plan made in advance does not count with"
    assert problem.message.startswith(told)
    assert list(rules_not_planned(replace(MISSION, time="continuous"))) == []


FILE = """\
teamformer: 1
world: {grid: [8, 8]}
capabilities: [lift]
robots: [{name: a, at: [0, 1], can: [lift], count: 3}]
tasks: [{name: x, at: [6, 1], needs: [lift]}]
"""


def told_of(folder: Path, text: str) -> str:
    path = folder / "m.yaml"
    path.write_text(text)
    with pytest.raises(MissionError) as error:
        read_mission(path)
    return str(error.value).replace(f"{path}:", "")


@pytest.mark.parametrize(
    ("wrong", "told", "remedy"),
    [
        ("deadline: 20", "'deadline'; write between: [0, 20] if it is late", "between: [0, 20]"),
        ("time_window: [1, 9]", "'time_window'; write between: [0, 20]", "between: [1, 9]"),
        ("Priority: 2", "'Priority'; write weight: 2 if its end and lateness", "weight: 2"),
        ("depends_on: []", "'depends_on'; write after", "after: []"),
    ],
)
def test_words_that_others_have_for_keys(
    tmp_path: Path, wrong: str, told: str, remedy: str
) -> None:
    text = FILE.replace("needs: [lift]", f"needs: [lift], {wrong}")
    assert f"5: task 1 has no key {told}" in told_of(tmp_path, text)
    (tmp_path / "m.yaml").write_text(text.replace(wrong, remedy))
    assert len(read_mission(tmp_path / "m.yaml").tasks) == 1


def test_a_capability_in_other_letters_is_told_once_with_the_one_that_is_meant(
    tmp_path: Path,
) -> None:
    first, *_ = told_of(tmp_path, FILE.replace("can: [lift]", "can: [Lift]")).splitlines()
    assert first.endswith(
        "can 'Lift', which is not under capabilities; add it there, or write 'lift'"
    )
    assert told_of(tmp_path, FILE.replace("can: [lift]", "can: [lift, Lift]")) == first
    added = FILE.replace("can: [lift]", "can: [lift, Lift]").replace(
        "s: [lift]\n", "s: [lift, Lift]\n"
    )
    (tmp_path / "m.yaml").write_text(added)
    assert read_mission(tmp_path / "m.yaml").robots[2].can == {"lift": 1, "Lift": 1}


def test_a_record_that_stands_for_a_mission_is_named(tmp_path: Path) -> None:
    record = tf.run(MISSION).save(tmp_path) / "record.json"
    with pytest.raises(MissionError) as error:
        read_mission(record)
    assert str(error.value) == (
        f"{record}:2: this is the record of a run, and no mission; "
        "name a mission, or use `view`, `check` or `export`"
    )
    assert tf.check(record).is_legal


@pytest.mark.parametrize("seconds", [-1, float("nan"), "soon", None])
@pytest.mark.parametrize(
    "call",
    [
        lambda seconds: tf.plan(MISSION, seconds=seconds),
        lambda seconds: tf.run(MISSION, method="central", seconds=seconds),
        lambda seconds: tf.compare(MISSION, methods=["plan"], seconds=seconds),
        lambda seconds: tf.advise(MISSION, seconds=seconds),
    ],
)
def test_times_to_search_are_told(call: Callable[[Any], object], seconds: object) -> None:
    with pytest.raises(TeamformerError, match=r"^seconds is ") as error:
        call(seconds)
    assert error.value.hint == "write a number of seconds, 0 or more"


def test_view_says_that_roads_have_no_map(tmp_path: Path) -> None:
    roads = '{roads: "from, p, q\\np, 0, 1\\nq, 1, 0\\n"}\ntime: continuous'
    text = FILE.replace("{grid: [8, 8]}", roads).replace("[0, 1]", "p").replace("[6, 1]", "q")
    (tmp_path / "m.yaml").write_text(text)
    with pytest.raises(TeamformerError, match="its world is of roads, which have no map") as error:
        draw_map(tmp_path / "m.yaml")
    assert error.value.hint == "`teamformer plan MISSION --out DIR` draws a plan as a Gantt chart"
