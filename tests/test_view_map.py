"""`teamformer view` of a mission or a map: its free cells as text."""

from __future__ import annotations

from pathlib import Path

import pytest

from teamformer.base.errors import TeamformerError
from teamformer.cli.terminal.console import out
from teamformer.cli.verbs.missions.draw_map import draw_map

MISSION = """\
teamformer: 1
name: yard
world: {rows: ["...........@", ".@@@.......@"], y_axis: AXIS}
capabilities: [lift]
robots: [{at: [0, 0], can: [lift]}]
tasks: [{at: [5, 1], needs: [lift]}]
"""


def drawn(path: Path) -> list[str]:
    with out.capture() as printed:
        assert draw_map(path) == 0
    return printed.get().splitlines()


def test_the_free_cells_of_a_mission_are_drawn_with_their_numbers(tmp_path: Path) -> None:
    path = tmp_path / "yard.yaml"
    path.write_text(MISSION.replace("AXIS", "down"))
    head, *rows = drawn(path)
    assert head == "yard: 12 x 2 cells, 19 free (. free, @ blocked, r robot, t task)"
    assert rows == ["  0         10", "0 r..........@", "1 .@@@.t.....@"]
    path.write_text(MISSION.replace("AXIS", "up"))  # the row with y = 0 lies at the bottom
    assert drawn(path)[1:] == ["  0         10", "1 .@@@.t.....@", "0 r..........@"]


def test_a_mission_that_is_wrong_is_drawn_to_be_mended(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "yard.yaml"
    path.write_text(MISSION.replace("AXIS", "down").replace("at: [5, 1]", "at: [11, 1]"))
    assert drawn(path)[2:] == ["0 ...........@", "1 .@@@.......@"]
    assert "inside an obstacle; the nearest free cell is [10, 1]" in capsys.readouterr().err


def test_a_map_alone_is_drawn(tmp_path: Path) -> None:
    path = tmp_path / "hall.map"
    path.write_text("type octile\nheight 2\nwidth 3\nmap\n..@\n.T.\n")
    assert drawn(path) == ["hall: 3 x 2 cells, 4 free (. free, @ blocked)", "  0", "0 ..@", "1 .@."]


def test_a_plane_has_no_cells(tmp_path: Path) -> None:
    path = tmp_path / "plane.yaml"
    world = "world: {plane: [4, 3]}"
    path.write_text(
        MISSION.replace(MISSION.splitlines()[2], world).replace("at: [5, 1]", "at: [2, 1]")
    )
    with pytest.raises(TeamformerError, match="is a plane, which has no cells"):
        draw_map(path)
