"""Files that are written anew keep what people wrote beside the data."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import pytest

from teamformer.files.mission_files import read_mission
from teamformer.files.yaml import reader
from teamformer.live.drawing.comments import rewrite
from teamformer.live.drawing.drafts import open_draft, write_draft

TEXT = """\
# the yard behind the hall
teamformer: 1
name: yard
world: {grid: [8, 4]}   # metres
capabilities: [lift, scan]
robots:
  - {name: ann, at: [0, 0], can: [lift]}   # the old one
  - {name: bob, at: [1, 0], can: [scan], speed: 0.50}
tasks:
  # the gate first
  - {name: "gate", at: [3, 2], needs: [lift, scan]}
sensing_radius: 2 # cells
"""


def tree_of(text: str) -> dict[str, Any]:
    value = reader.parse(text).value
    assert isinstance(value, dict)
    return copy.deepcopy(value)


def test_what_is_not_changed_is_written_as_it_was() -> None:
    assert rewrite(TEXT, tree_of(TEXT)) == TEXT


def test_only_what_is_changed_is_written_anew() -> None:
    tree = tree_of(TEXT)
    tree["robots"][0]["at"] = [2, 1]
    tree["robots"].append({"name": "no", "at": [5, 0], "can": {"lift": 2}})
    del tree["sensing_radius"]
    expected = TEXT.replace("ann, at: [0, 0]", "ann, at: [2, 1]")
    expected = expected.replace(
        "speed: 0.50}\n", 'speed: 0.50}\n  - {name: "no", at: [5, 0], can: {lift: 2}}\n'
    )
    assert rewrite(TEXT, tree) == expected.replace("sensing_radius: 2 # cells\n", "")


def test_a_comment_goes_with_its_entry() -> None:
    tree = tree_of(TEXT)
    del tree["robots"][0]
    written = rewrite(TEXT, tree)
    assert written is not None
    assert "the old one" not in written
    assert "# the yard behind the hall" in written
    assert tree_of(written) == tree


@pytest.mark.parametrize("text", ["- a\n", "a: [\n", "teamformer: 1\nteamformer: 1\n"])
def test_what_is_no_such_file_is_not_rewritten(text: str) -> None:
    assert rewrite(text, {"teamformer": 1}) is None


def test_a_file_opened_and_saved_keeps_its_comments(tmp_path: Path) -> None:
    tree = open_draft("yard.yaml", TEXT)
    tree["tasks"][0]["duration"] = 3
    path = write_draft(tree, "again.yaml", tmp_path, TEXT)
    changed = TEXT.replace("needs: [lift, scan]}", "needs: [lift, scan], duration: 3}")
    assert path.read_text(encoding="utf-8") == changed
    assert read_mission(path).tasks[0].duration == 3
