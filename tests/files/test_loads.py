"""Loads in files: read, written back, and refused where nobody can carry them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from teamformer.base.errors import MissionError
from teamformer.files.mission_files import mission_from_tree, mission_to_tree, read_mission
from teamformer.mission.checks.rules import rules_not_played, rules_of_fleets
from teamformer.robotarium.mission_checks import find_problems

MISSION = """\
teamformer: 1
world:
  rows: ["....@.", "....@."]
capabilities: [lift]
robots: [{at: [0, 0], can: [lift]}]
tasks:
  - name: crate
    at: [3, 1]
    needs: [lift]
    to: [5, 0]
"""


def read(folder: Path, text: str) -> Any:
    path = folder / "crate.yaml"
    path.write_text(text)
    return read_mission(path)


def test_load_that_no_way_leads_to_is_refused(tmp_path: Path) -> None:
    with pytest.raises(MissionError) as caught:
        read(tmp_path, MISSION)
    assert str(caught.value).endswith(
        "crate.yaml:10: nobody can bring the load of task 'crate' from [3, 1] to [5, 0]: "
        "no way leads there; move one of the two or open the map"
    )


def test_loads_are_written_as_they_were_read(tmp_path: Path) -> None:
    mission = read(tmp_path, MISSION.replace("[5, 0]", "[0, 1]\n    unload: 3"))
    assert (mission.tasks[0].to, mission.tasks[0].unload) == ((0, 1), 3)
    tree = mission_to_tree(mission)
    assert tree["tasks"][0]["to"] == [0, 1]
    assert tree["tasks"][0]["unload"] == 3
    assert mission_from_tree(tree) == mission


def test_robots_that_cannot_carry_yet_say_so(tmp_path: Path) -> None:
    mission = read(tmp_path, MISSION.replace("[5, 0]", "[0, 1]"))
    assert list(rules_not_played(mission)) == []
    assert list(rules_of_fleets(mission)) == []  # fleets can
    problem = next(find_problems(mission))
    assert problem.where == ("tasks", 0, "to")
    assert problem.message == (
        "task 'crate' has a load, which the Robotarium cannot carry yet; "
        "drop to and unload, or use `teamformer run`, `compare` or `live`"
    )
