"""Tasks that may be left out, and when a mission is over: what is read, written and refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from teamformer.base.errors import MissionError
from teamformer.files.mission_files import mission_from_tree, read_mission, write_mission
from teamformer.files.trees.writer import mission_to_tree
from teamformer.mission.checks.rules import rules_of_fleets, rules_of_robotarium

Tree = dict[str, Any]


def tree(*tasks: Tree, **keys: Any) -> Tree:
    """Return a file with a robot and tasks x, y, ... beside each other, in continuous time."""
    placed = [
        {"name": name, "at": [3, 2], "needs": ["lift"]} | task
        for name, task in zip("xyz", tasks, strict=False)
    ]
    return {
        "teamformer": 1,
        "world": {"grid": [4, 3]},
        "capabilities": ["lift"],
        "robots": [{"name": "a", "at": [0, 0], "can": ["lift"], "count": 2}],
        "tasks": placed,
        "time": "continuous",
    } | keys


MAY = {"optional": True}


def test_what_is_read_is_written() -> None:
    cost = {"makespan": 1.0, "missed": 10.0}
    mission = mission_from_tree(tree(MAY | {"weight": 3}, {}, until=7.5, cost=cost))
    assert [task.optional for task in mission.tasks] == [True, False]
    assert (mission.until, mission.cost, mission.tasks[0].weight) == (7.5, cost, 3)
    written = mission_to_tree(mission)
    assert (written["until"], written["tasks"][0]["optional"]) == (7.5, True)
    assert "optional" not in written["tasks"][1]
    assert mission_from_tree(written) == mission


@pytest.mark.parametrize(
    ("wrong", "told"),
    [
        (
            tree(MAY),
            ["task 'x' is optional, but the mission has no until; write until: TIME, the time by "
             "which as much as possible is to be done"],
        ),
        (
            tree(MAY, {"after": ["x"]}, until=9),
            ["task 'y' is after 'x', which may be left out; make 'y' optional, too, or drop 'x' "
             "from after"],
        ),
        (
            tree(MAY, {"starts": {"x": [0, 5]}}, until=9),
            ["task 'x' is optional and 'y' is not, but their starts are linked; make both "
             "optional, or drop the link"],
        ),
        (
            tree(MAY, until=9, cost={"makespan": 1}),
            ["tasks are optional, but the cost has no missed, so that none is worth its way; add "
             "missed to the cost, or drop the cost"],
        ),
        (
            tree({}, until=9, cost={"makespan": 1, "missed": 2}),
            ["the cost counts what is missed, but no task is optional; make tasks optional, or "
             "drop missed"],
        ),
        (tree({}, until=0), ["the mission is over at 0; use a time after 0, up to 1e9, counted "
                             "from the mission's start"]),
        (tree({}, until=1.5, time="steps"), ["until is 1.5; write a whole number"]),
        (
            tree({"optional": "yes"}, until=9),
            ["optional of task 1 is the text 'yes'; write true or false"],
        ),
    ],
)  # fmt: skip
def test_mistakes_are_told_with_what_to_do(wrong: Tree, told: list[str]) -> None:
    with pytest.raises(MissionError) as caught:
        mission_from_tree(wrong)
    assert [problem.message for problem in caught.value.problems] == told


def test_several_mistakes_are_told_at_once() -> None:
    both = tree(MAY, {"starts": {"x": [0, 5]}}, {"after": ["x"]}, cost={"makespan": 1})
    with pytest.raises(MissionError) as caught:
        mission_from_tree(both)
    places = [problem.where for problem in caught.value.problems]
    assert places == [
        ("tasks", 0, "optional"),
        ("cost",),
        ("tasks", 2, "after", 0),
        ("tasks", 1, "starts"),
    ]


def test_what_cannot_end_in_time_is_told_of_files(tmp_path: Path) -> None:
    """x takes 4 and y comes after it and takes 5: it ends at 9 at the earliest."""
    chain = ({"duration": 4}, {"duration": 5, "after": ["x"]})
    told = "task 'y' ends at 9 at the earliest, but the mission is over at 8"
    assert _refused(tmp_path, tree(*chain, until=8)) == [
        f"{told}; raise until, or make the task optional"
    ]
    assert _refused(tmp_path, tree(*chain, until=9)) == []
    may = (chain[0] | MAY, chain[1] | MAY)
    assert _refused(tmp_path, tree(*may, until=4)) == []  # x alone is something
    assert _refused(tmp_path, tree(*may, until=3)) == [
        "the first task ends at 4 at the earliest, but the mission is over at 3; raise until"
    ]


def _refused(folder: Path, given: Tree) -> list[str]:
    path = folder / "mission.json"
    write_mission(mission_from_tree(given), path)
    try:
        read_mission(path)
    except MissionError as error:
        return [problem.message for problem in error.problems]
    return []


def test_the_robotarium_does_not_know_until_and_fleets_do() -> None:
    mission = mission_from_tree(tree(MAY, {}, until=9, time="steps"))
    told = [problem.message for problem in rules_of_robotarium(mission)]
    assert any("until" in message for message in told)
    assert list(rules_of_fleets(mission)) == []
