"""Drafts of missions, good and bad, as pages send them."""

from __future__ import annotations

import pytest

from teamformer.base.errors import TeamformerError
from teamformer.live.drawing.drafts import EMPTY, can_be_drawn, open_draft, problems_of, read_draft
from teamformer.live.running.messages import read_files

GOOD = EMPTY | {
    "robots": [{"at": [1, 1], "can": ["lift"]}],
    "tasks": [{"at": [2, 2], "needs": ["lift"]}],
}


def test_a_good_draft_is_a_mission() -> None:
    assert problems_of(GOOD) == []
    assert read_draft(GOOD).tasks[0].at == (2, 2)


def test_an_empty_draft_says_what_it_lacks() -> None:
    assert [problem["message"] for problem in problems_of(EMPTY)] == [
        "there is no robot; add one",
        "there is no task; add one",
    ]


def test_a_draft_may_be_in_continuous_time() -> None:
    draft = GOOD | {"time": "continuous"}
    assert problems_of(draft) == []
    assert read_draft(draft).time == "continuous"


@pytest.mark.parametrize("tree", [None, [], 3, {}, {"world": 3}, GOOD | {"robots": [7]}])
def test_what_is_no_draft_is_told_and_not_drawn(tree: object) -> None:
    assert problems_of(tree)
    assert not can_be_drawn(tree)


ABOUT = """\
image: floor.pgm
resolution: 0.05
origin: [-1.0, 2.0, 0.0]
negate: 0
occupied_thresh: 0.65
free_thresh: 0.196
"""


def image(width: int, height: int) -> bytes:
    """Return a picture that is free but for its lower left pixel."""
    shades = [254] * (width * height)
    shades[-width] = 0
    return f"P5 {width} {height} 255\n".encode() + bytes(shades)


def test_a_ros_map_and_its_image_are_an_empty_draft_on_it() -> None:
    draft = open_draft("floor.yaml", ABOUT, {"floor.pgm": image(3, 2)})
    assert draft["name"] == "floor"
    assert draft["world"]["rows"] == ["@..", "..."]  # the bottom row of a picture is y = 0
    assert draft["world"]["frame"] == {"cell": 0.05, "origin": [-1.0, 2.0, 0.0]}
    assert draft["robots"] == []


def test_large_ros_maps_come_in_larger_cells() -> None:
    world = open_draft("floor.yaml", ABOUT, {"floor.pgm": image(250, 30)})["world"]
    assert world["frame"]["cell"] == pytest.approx(0.15)
    assert (len(world["rows"]), len(world["rows"][0])) == (10, 84)
    assert world["rows"][0][:2] == "@."


def test_a_map_without_its_image_is_told() -> None:
    with pytest.raises(TeamformerError, match=r"^floor.pgm: there is no such file"):
        open_draft("floor.yaml", ABOUT)


def test_a_mission_comes_with_the_map_that_it_names() -> None:
    text = (
        "teamformer: 1\nworld: {map: yard.map}\ncapabilities: [lift]\n"
        "robots:\n  - {at: [0, 0], can: [lift]}\ntasks:\n  - {at: [2, 0], needs: [lift]}\n"
    )
    rows = b"type octile\nheight 1\nwidth 3\nmap\n...\n"
    draft = open_draft("shift.yaml", text, {"yard.map": rows})
    assert draft["world"] == {"rows": ["..."], "y_axis": "down"}
    assert read_draft(draft).name == "shift"


@pytest.mark.parametrize("beside", [[], {"a": 3}, {"a": "no base64!"}])
def test_files_that_are_none_are_refused(beside: object) -> None:
    with pytest.raises(TeamformerError, match="'beside' must hold files by name"):
        read_files({"do": "open", "beside": beside})
