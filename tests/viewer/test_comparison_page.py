"""Several records on one page: curves, maps and Gantt charts in step; the legend of crowds."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest
from toy_records import Tree, random_mission, small_mission, toy_record

import teamformer as tf
from browsers import Opened, Opener
from teamformer.record.files.writing import record_to_tree
from teamformer.viewer.html import comparison_page
from test_telling_events import clinic


@pytest.fixture(scope="session")
def fewer() -> Tree:
    """The dock with its first two tasks only, by another method."""
    return toy_record(small_mission() | {"tasks": small_mission()["tasks"][:2]}, method="quick")


@pytest.fixture
def compared(open_page: Opener, dock: Tree, fewer: Tree) -> Callable[..., Opened]:
    """Open the dock beside itself with fewer tasks, and a method that failed."""
    failed = [{"method": "central", "seed": 0, "why": "too large"}]

    def written(trees: list[Tree]) -> str:
        return comparison_page(trees, failed)

    def open_it(moment: str = "") -> Opened:
        return open_page([dock, fewer], moment, written=written)

    return open_it


def table_of(opened: Opened) -> list[list[str]]:
    rows = opened.page.locator("#compared tbody tr").all()
    return [row.locator("th, td").all_inner_texts() for row in rows]


def test_records_run_in_step_to_the_end_of_the_longest(
    compared: Callable[..., Opened], fewer: Tree
) -> None:
    opened = compared("#step=30")
    assert opened.page.evaluate("window.teamformer.besideSteps()") == [len(fewer["steps"])]
    assert opened.page.get_attribute("#scrub", "max") == "61"
    opened.page.keyboard.press("Home")
    opened.page.keyboard.press("ArrowRight")
    assert opened.shown_step() == 1
    assert opened.page.evaluate("window.teamformer.besideSteps()") == [1]
    assert opened.errors == []


def test_a_table_tells_the_makespans_and_what_failed(
    compared: Callable[..., Opened], fewer: Tree
) -> None:
    last = len(fewer["steps"])
    opened = compared("#step=61")
    opened.details()
    assert table_of(opened) == [
        ["toy", "4/4", "61", f"+{round(100 * (61 / last - 1))}%"],
        ["quick", "2/2", str(last), "+0%"],
        ["central, seed 0 failed: too large"],
    ]


CURVE = """([step, part]) => {
  const canvas = document.querySelector("canvas.curves");
  const { x, y } = window.teamformer.lineOf(step, part);
  const sharpness = canvas.width / canvas.clientWidth;
  const at = canvas.getContext("2d").getImageData(x * sharpness - 2, y * sharpness - 2, 4, 4).data;
  return Math.max(...Array.from({ length: 16 }, (_, n) => at[4 * n + 3] ? 255 - at[4 * n + 1] : 0));
}"""


def test_records_with_windows_are_compared_by_lateness_too(open_page: Opener) -> None:
    """Of two ways to two tasks the longer one is in time: 18 against 15 and 2 x 9 late."""
    mission = {
        **{"teamformer": 1, "name": "urgent", "world": {"grid": [12, 1]}, "capabilities": ["a"]},
        "robots": [{"name": "r", "at": [4, 0], "can": ["a"]}],
        "tasks": [
            {"name": "near", "at": [0, 0], "needs": ["a"]},
            {"name": "urgent", "at": [11, 0], "needs": ["a"], "between": [0, 7]},
        ],
    }
    trees = [toy_record(mission, method=name) for name in ("first", "second")]
    for tree, ends in zip(trees, ((4, 15), (18, 7)), strict=True):
        for step in tree["steps"]:
            step.pop("done", None)
        tree["steps"] = (tree["steps"] + [{}] * 18)[: max(ends)]
        for task, end in enumerate(ends):
            tree["steps"][end - 1]["done"] = [[task, 0]]
        tree["end"] |= {"status": "completed", "makespan": max(ends), "steps": max(ends)}
    opened = open_page(trees, written=comparison_page)
    opened.details()
    head = opened.page.locator("#compared th[scope=col]").all_inner_texts()
    assert head == ["method", "done", "makespan", "late", "to best"]
    rows = {row[0]: row[2:] for row in table_of(opened)}
    assert rows == {"first": ["15", "1 by 8", "+72%"], "second": ["18", "-", "+0%"]}


def test_records_are_compared_by_their_cost(open_page: Opener) -> None:
    """Two tasks by step 15, or one by step 5 and the other one missed: 15 and 5 + 20, by 21.

    Without a cost, what is missed counts before all else.
    """
    mission = {
        **{"teamformer": 1, "name": "choice", "world": {"grid": [12, 1]}, "capabilities": ["a"]},
        "cost": {"makespan": 1, "missed": 20},
        "until": 30,
        "robots": [{"name": "r", "at": [4, 0], "can": ["a"]}],
        "tasks": [
            {"name": "near", "at": [0, 0], "needs": ["a"]},
            {"name": "far", "at": [11, 0], "needs": ["a"], "optional": True},
        ],
    }
    both, one = (toy_record(mission, method=name) for name in ("both", "one"))
    both["steps"] = [{}] * 3 + [{"done": [[0, 0]]}] + [{}] * 10 + [{"done": [[1, 0]]}]
    one["steps"] = [{}] * 3 + [{"done": [[0, 0]]}, {"missed": [[1, "too far"]]}]
    for tree in (both, one):
        tree["end"] |= {"status": "completed", "makespan": len(tree["steps"])}
    opened = open_page([both, one], written=comparison_page)
    opened.details()
    rows = {row[0]: row[2:] for row in table_of(opened)}
    assert rows == {
        "both": ["15", "0.714286", "0", "+0%"],
        "one": ["5", "1.19048", "1", "+67%"],
    }
    del both["mission"]["cost"]
    opened = open_page([both, one], written=comparison_page)
    opened.details()
    rows = {row[0]: row[2:] for row in table_of(opened)}
    assert rows == {"both": ["15", "0", "+0%"], "one": ["5", "1", ""]}  # more is missed


def test_in_continuous_time_a_record_says_what_it_cost(open_page: Opener) -> None:
    """Its ways, which are in no other cost, are not worked out anew."""
    mission = replace(clinic(), cost={"makespan": 1.0, "travel": 1.0})
    tree = record_to_tree(tf.run(mission, "plan").record)
    dearer = {**tree, "method": "dearer", "end": {**tree["end"], "cost": 3.0}}
    tree["end"]["cost"] = 2.0
    opened = open_page([tree, dearer], written=comparison_page)
    opened.details()
    assert [row[-1] for row in table_of(opened)] == ["+0%", "+50%"]


def test_curves_pass_through_what_was_done(compared: Callable[..., Opened], dock: Tree) -> None:
    """Between two tasks done the line is at the height of those before, and not above."""
    opened = compared("#step=0")
    opened.details()
    done = [number for number, step in enumerate(dock["steps"], 1) for _ in step.get("done", [])]
    assert len(done) == 4
    middle = (done[2] + done[3]) / 2
    assert opened.page.evaluate(CURVE, [middle, 3 / 4]) > 60
    assert opened.page.evaluate(CURVE, [middle, 0.9]) == 0


def test_a_row_brings_its_record_to_the_front(compared: Callable[..., Opened]) -> None:
    opened = compared("#step=3&robot=r2")
    opened.page.click("#compared >> text=quick")
    assert opened.shown_step() == 3
    opened.wait_until("document.querySelector('#about').textContent.startsWith('Method quick')")
    assert opened.details().startswith("r2")
    assert "toy" in opened.page.inner_text(".map.beside .caption")
    assert [row[0] for row in table_of(opened)[:2]] == ["toy", "quick"]
    assert opened.errors == []


def test_tables_and_plots_are_of_the_record_in_front(compared: Callable[..., Opened]) -> None:
    """The slider's end is the longest record's: a plot of the other one stops at its own."""
    opened = compared("#step=61&view=tasks")
    rows = "[...document.querySelectorAll('#stage-tasks .rows .link')].map((it) => it.textContent)"
    opened.wait_until(f"{rows}.length === 4")
    opened.page.click("#compared >> text=quick")
    opened.wait_until(f"{rows}.length === 2")
    opened.page.keyboard.press("p")
    opened.details()
    opened.wait_for_a_frame()
    assert opened.page.evaluate("window.teamformer.curves().open.length") == 23  # done in 22
    assert opened.page.get_attribute("#plots", "aria-label").startswith("Step 22: open tasks 0")
    opened.page.click("#plots", position={"x": 52, "y": 60})
    assert opened.shown_step() == 0
    right = opened.page.locator("#plots").bounding_box()["width"] - 18
    opened.page.click("#plots", position={"x": right, "y": 60})
    assert opened.shown_step() == 61
    assert opened.errors == []


def test_a_page_saved_of_several_records_has_them_all(
    compared: Callable[..., Opened], open_page: Opener
) -> None:
    opened = compared("#step=30")
    opened.page.click("#compared >> text=quick")
    opened.page.click("#menu summary")
    with opened.page.expect_download() as saved:
        opened.page.click("#downloads >> text=This page")
    text = saved.value.path().read_text()
    again = open_page(None, "#step=61", written=lambda _: text)
    again.details()
    assert [row[0] for row in table_of(again)] == [
        *("toy", "quick", "central, seed 0 failed: too large")
    ]  # fmt: skip
    assert again.page.evaluate("window.teamformer.besideSteps()") == [22]
    assert again.errors == opened.errors == []


SIZE_OF_PICTURE = """async (bytes) => {
  const image = await createImageBitmap(new Blob([new Uint8Array(bytes)]));
  return [image.width, image.height];
}"""


@pytest.mark.parametrize("view", ["map", "gantt", "plots"])
def test_a_picture_is_of_all_that_is_drawn(compared: Callable[..., Opened], view: str) -> None:
    opened = compared(f"#step=30&view={view}")
    opened.details()
    opened.page.click("#menu summary")
    with opened.page.expect_download() as saved:
        opened.page.click("#save-picture")
    bytes_ = list(saved.value.path().read_bytes())
    boxes = [box.bounding_box() for box in opened.page.locator(f"#stage-{view} canvas").all()]
    assert len(boxes) == (1 if view == "plots" else 2)
    wide = max(box["x"] + box["width"] for box in boxes) - min(box["x"] for box in boxes)
    high = max(box["y"] + box["height"] for box in boxes) - min(box["y"] for box in boxes)
    assert opened.page.evaluate(SIZE_OF_PICTURE, bytes_) == [round(wide), round(high + 34)]
    assert opened.errors == []


def test_rows_of_records_are_one_stop_of_the_tab_key(compared: Callable[..., Opened]) -> None:
    opened = compared("#step=3")
    names = opened.page.locator("#compared button")
    assert [name.get_attribute("tabindex") for name in names.all()] == ["0", "-1"]
    names.first.focus()
    opened.page.keyboard.press("ArrowDown")
    opened.page.keyboard.press("Enter")
    opened.wait_until("document.querySelector('#about').textContent.startsWith('Method quick')")


def test_gantt_charts_stand_under_each_other_with_one_scale_of_time(
    compared: Callable[..., Opened],
) -> None:
    opened = compared("#step=3&view=gantt")
    opened.details()
    mine = opened.page.evaluate("window.teamformer.bars(0)")["bars"][0]
    other = opened.page.evaluate("window.teamformer.barsBeside(0, 0)")["bars"][0]
    assert mine["left"] == other["left"]
    scale = [(bar["right"] - bar["left"]) / (bar["to"] - bar["from"]) for bar in (mine, other)]
    assert scale[0] == pytest.approx(scale[1])
    opened.page.click("#zoom-in")
    opened.details()
    calls = ("bars(0)", "barsBeside(0, 0)")
    wider = [opened.page.evaluate(f"window.teamformer.{call}") for call in calls]
    widths = [bars["bars"][0]["right"] - bars["bars"][0]["left"] for bars in wider]
    assert widths[0] == pytest.approx(1.4 * (mine["right"] - mine["left"]))
    assert widths[1] == pytest.approx(1.4 * (other["right"] - other["left"]))
    assert opened.page.locator("#stage-gantt .of").all_inner_texts()[1].startswith("quick")


def test_a_row_of_any_chart_selects_its_robot(compared: Callable[..., Opened]) -> None:
    opened = compared("#view=gantt")
    opened.details()
    row = opened.page.evaluate("window.teamformer.barsBeside(0, 0)")["rowHeight"]
    beside = opened.page.locator("#stage-gantt canvas >> nth=1")
    beside.click(position={"x": 40, "y": 24 + 2.5 * row})
    assert opened.details().splitlines()[0] == "r3"
    assert opened.errors == []


def test_what_is_clicked_on_one_map_is_selected_in_all(compared: Callable[..., Opened]) -> None:
    opened = compared()
    opened.details()
    spot = opened.page.evaluate("window.teamformer.robotSpot(2)")
    beside = opened.page.locator(".map.beside canvas")
    place = opened.page.evaluate("window.teamformer.robotSpotBeside(0, 2)")
    assert spot == pytest.approx(place, abs=1)  # one camera
    beside.click(position={"x": place["x"], "y": place["y"]})
    assert opened.details().startswith("r3")


@pytest.mark.parametrize(("wide", "columns"), [(60, 1), (10, 2)])
def test_maps_are_stacked_where_they_are_wide(open_page: Opener, wide: int, columns: int) -> None:
    mission = small_mission() | {"world": {"grid": [wide, 12]}}
    mission["robots"] = [{"name": "r", "at": [0, 0], "can": ["lift"]}]
    mission["tasks"] = [{"name": "t", "at": [wide - 1, 0], "needs": ["lift"]}]
    trees = [toy_record(mission, method=name) for name in ("one", "other")]
    opened = open_page(trees, written=comparison_page)
    opened.details()
    boxes = [box.bounding_box() for box in opened.page.locator(".map canvas").all()]
    assert len({round(box["x"]) for box in boxes}) == columns
    assert len({round(box["y"]) for box in boxes}) == 3 - columns


def test_a_record_put_beside_keeps_the_step(open_page: Opener, dock: Tree, fewer: Tree) -> None:
    opened = open_page(dock, "#step=7")
    for count in (1, 2):
        opened.drop(json.dumps(fewer), is_beside=True)
        opened.wait_until(f"window.teamformer.besideSteps().length === {count}")
        assert opened.shown_step() == 7
    opened.page.locator(".map.beside >> text=Close").first.click()
    opened.wait_until("window.teamformer.besideSteps().length === 1")
    assert opened.shown_step() == 7
    assert opened.errors == []


PIXELS = """(spots) => {
  const canvas = document.getElementById("map"), sharpness = canvas.width / canvas.clientWidth;
  const ctx = canvas.getContext("2d");
  return spots.map(({ x, y }) => [...ctx.getImageData(x * sharpness, y * sharpness, 1, 1).data]);
}"""


def pixels(opened: Opened, spots: list[dict[str, float]]) -> list[list[int]]:
    found: list[list[int]] = opened.page.evaluate(PIXELS, spots)
    return found


def test_the_legend_of_density_has_the_colours_of_the_map(open_page: Opener) -> None:
    """All robots start in four corners of 75: the strongest colour of the legend is theirs."""
    mission = random_mission(300, 120, 2, 100, 1)
    for number, robot in enumerate(mission["robots"]):
        robot["at"] = [1 + 97 * (number % 2), 1 + 97 * (number // 2 % 2)]
    mission["world"] = {"grid": [100, 100]}
    for task in mission["tasks"]:
        task["at"] = [50, 50]
    opened = open_page(toy_record(mission, steps=1))
    opened.details()
    assert opened.page.evaluate("window.teamformer.detail()") == "density"
    legend = {row["text"]: row for row in opened.page.evaluate("window.teamformer.legend()")}
    assert list(legend)[:3] == [
        "1 robot in a square", "9 robots in a square", "75 robots in a square",
    ]  # fmt: skip
    corner = opened.page.evaluate("window.teamformer.pixelOf(1, 1)")
    square = [
        {"x": corner["x"] + right, "y": corner["y"] + down}
        for right in (-6, -3, 0, 3, 6)
        for down in (-3, 0, 3)  # squares are a pixel apart
    ]
    strongest, *around = pixels(opened, [legend["75 robots in a square"], *square])
    assert strongest in around
    [weakest] = pixels(opened, [legend["1 robot in a square"]])
    assert weakest not in around


def test_tasks_can_be_dimmed(open_page: Opener, dock: Tree) -> None:
    opened = open_page(dock, "#step=1")
    spot = opened.page.evaluate("window.teamformer.taskBox(2)")
    inside: dict[str, Any] = {"x": spot["x"] - spot["half"] + 1.5, "y": spot["y"]}
    [before] = pixels(opened, [inside])
    opened.page.click("#dim")
    opened.details()
    opened.wait_for_a_frame()
    [after] = pixels(opened, [inside])
    assert sum(after[:3]) > sum(before[:3])  # nearer to the white ground
    assert opened.page.evaluate("window.teamformer.taskBox(2)") == spot  # and still there to click


@pytest.mark.parametrize(("width", "height"), [(1400, 900), (820, 1180), (390, 844)])
def test_three_records_leave_no_part_of_the_stage_empty(
    open_page: Opener, dock: Tree, fewer: Tree, width: int, height: int
) -> None:
    """Where three maps leave a quarter, the curves fill it; on phones maps lie under each other."""
    trees = [dock, fewer, fewer | {"method": "third"}]
    opened = open_page(trees, "#step=30", written=comparison_page)
    page = opened.page
    page.set_viewport_size({"width": width, "height": height})
    opened.wait_until("window.teamformer.besideSteps().length === 2")
    opened.wait_for_a_frame()
    opened.wait_for_a_frame()
    boxes = [box.bounding_box() for box in page.locator("#stage-map > :visible").all()]
    stage = page.locator("#stage-map").bounding_box()
    if width > 480:
        covered = sum(box["width"] * box["height"] for box in boxes)
        assert covered > 0.9 * stage["width"] * stage["height"]
    else:
        assert len(boxes) == 3
        assert all(box["width"] == width and box["height"] >= 250 for box in boxes)
    captions = [box.bounding_box() for box in page.locator(".caption:visible").all()]
    assert all(  # over the map's upper edge, not on an axis
        caption["y"] + caption["height"] < box["y"] + 40
        for caption, box in zip(captions, boxes, strict=False)
    )
    page.keyboard.press("g")  # in other views the curves are in the panel
    opened.wait_until("document.querySelector('#compared canvas.curves') !== null")
