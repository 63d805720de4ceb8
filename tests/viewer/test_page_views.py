"""More than the plain map: shared cells, crowds, the Gantt view, files in and out, two records."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from toy_records import Tree, random_mission, small_mission, told_too, toy_record

from browsers import Opened, Opener
from teamformer.base.errors import TeamformerError
from teamformer.record.files.reading import record_from_tree


def three_in_one_cell() -> Tree:
    """Two robots that walk to one cell with three tasks, the last one hours of work."""
    mission = small_mission() | {"world": {"grid": [9, 7]}, "capabilities": ["lift", "scan"]}
    mission["robots"] = [
        {"name": "r1", "at": [1, 1], "can": ["lift"]},
        {"name": "r2", "at": [7, 5], "can": ["scan"]},
    ]
    mission["tasks"] = [
        {"name": name, "at": [4, 3], "needs": needs}
        for name, needs in [("unload", ["lift"]), ("inspect", ["scan"]), ("seal", ["lift", "scan"])]
    ]
    return toy_record(mission)


@pytest.mark.parametrize(
    ("caps", "width", "shown"),
    [
        (["lift", "scan", "weld"], 8, [["30L S"], ["2S W"], ["L 2S", "W"]]),
        (["c1", "c2", "c3"], 8, [["30c1 c2"], ["2c2 c3"], ["c1 2c2", "c3"]]),
        (["lift", "scan", "weld"], 60, [None, None, None]),
    ],
)
def test_a_task_shows_its_needs_and_never_their_sum(
    open_page: Opener, caps: list[str], width: int, shown: list[list[str] | None]
) -> None:
    """Where letters do not fit, the pieces of the outline alone show the kinds."""
    one, two, three = caps
    needs = [{one: 30, two: 1}, {two: 2, three: 1}, {one: 1, two: 2, three: 1}]
    robot = {"name": "r", "at": [0, 0], "can": dict.fromkeys(caps, 40)}
    tasks = [{"name": f"t{n}", "at": [n + 1, 2], "needs": need} for n, need in enumerate(needs)]
    mission = small_mission() | {"world": {"grid": [width, 7]}, "capabilities": caps}
    opened = open_page(toy_record(mission | {"robots": [robot], "tasks": tasks}))
    asked = [opened.page.evaluate(f"window.teamformer.needs({task}) ?? null") for task in range(3)]
    assert asked == shown
    spot = opened.page.evaluate("window.teamformer.taskBox(2)")
    opened.page.locator("#map").hover(position={"x": spot["x"], "y": spot["y"]})
    assert f"needs {one}, 2 x {two}, {three}" in opened.page.inner_text("#tip")


def test_tasks_in_one_cell_lie_side_by_side_and_can_each_be_clicked(open_page: Opener) -> None:
    opened = open_page(three_in_one_cell(), "#step=1")
    boxes = [opened.page.evaluate(f"window.teamformer.taskBox({task})") for task in range(3)]
    for one, other in [(0, 1), (0, 2), (1, 2)]:
        apart = max(abs(boxes[one][key] - boxes[other][key]) for key in ("x", "y"))
        assert apart >= boxes[one]["half"] + boxes[other]["half"]
    for box, name in zip(boxes, ["unload", "inspect", "seal"], strict=True):
        opened.click_map(box)
        assert opened.details().startswith(name)


def test_robots_that_come_leave_the_tasks_of_a_shared_cell_in_sight(open_page: Opener) -> None:
    tree = three_in_one_cell()
    opened = open_page(tree, f"#step={len(tree['steps'])}")
    spots = [opened.page.evaluate(f"window.teamformer.robotSpot({robot})") for robot in range(2)]
    for task in range(3):
        box = opened.page.evaluate(f"window.teamformer.taskBox({task})")
        for spot in spots:
            assert max(abs(box["x"] - spot["x"]), abs(box["y"] - spot["y"])) > box["half"]


@pytest.mark.parametrize(
    ("robots", "size", "detail"), [(39, 60, "robots"), (100, 60, "groups"), (300, 100, "density")]
)
def test_a_crowd_is_drawn_as_groups_and_a_large_one_by_density(
    open_page: Opener, robots: int, size: int, detail: str
) -> None:
    opened = open_page(toy_record(random_mission(robots, 8, 4, size, 2), steps=12), "#step=6")
    assert opened.page.evaluate("window.teamformer.detail()") == detail
    if detail != "robots":
        groups = opened.page.evaluate("window.teamformer.groups()")
        alone = robots - sum(group["count"] for group in groups)
        assert alone == 0 if detail == "density" else alone < 20
        before = opened.page.evaluate("window.teamformer.taskBox(0).half")
        opened.click_map(max(groups, key=lambda group: group["count"]))  # comes nearer
        opened.details()
        assert opened.page.evaluate("window.teamformer.taskBox(0).half") > before
    assert opened.errors == []


def test_the_first_view_says_how_to_start(open_page: Opener, dock: Tree) -> None:
    opened = open_page(dock)
    assert opened.page.inner_text("#status") == "At the start"
    assert " ".join(opened.page.inner_text("#start").split()) == "Play the mission 61 steps"
    opened.page.click("#start")
    opened.wait_until("document.querySelector('#status').innerText === 'Under way'")
    assert opened.page.evaluate("window.teamformer.step") > 0
    assert not opened.page.is_visible("#start")


def test_help_closes_with_the_key_that_opens_it(open_page: Opener, dock: Tree) -> None:
    opened = open_page(dock)
    opened.page.keyboard.press("?")
    assert opened.page.is_visible("#help-text")
    opened.page.keyboard.press("?")
    assert not opened.page.is_visible("#help-text")


def test_a_menu_closes_by_escape_and_by_a_click_elsewhere(open_page: Opener, dock: Tree) -> None:
    opened = open_page(dock, "#step=3&robot=r2")
    for close in (
        lambda: opened.page.keyboard.press("Escape"),
        lambda: opened.page.click("#details h2"),
    ):
        opened.page.click("#menu summary")
        assert opened.page.is_visible("#open")
        close()
        assert not opened.page.is_visible("#open")
    assert opened.details().startswith("r2")  # what was selected still is


def test_the_address_follows_and_leads_back(open_page: Opener, dock: Tree) -> None:
    opened = open_page(dock)
    opened.page.fill("#scrub", "33")
    opened.page.click("#tab-tasks")
    opened.page.click("text=seam")
    opened.page.keyboard.press("g")
    opened.wait_until("location.hash === '#step=33&task=seam&view=gantt'")
    again = open_page(dock, "#step=33&task=seam&view=gantt")
    assert again.shown_step() == 33
    assert again.details().startswith("seam")
    assert again.page.is_visible("#gantt")


def test_the_gantt_view_leads_to_robots_and_moments(open_page: Opener, dock: Tree) -> None:
    opened = open_page(dock)
    opened.page.keyboard.press("g")
    opened.details()
    box = opened.page.locator("#gantt").bounding_box()
    width = box["width"] - 96 - 54 - 6  # names, shares, margin
    opened.page.mouse.click(box["x"] + 96 + width * 33 / 61, box["y"] + 24 + 2.5 * 22)
    assert opened.shown_step() == 33
    assert opened.details().startswith("Team r2")  # r3, in row 3, has joined it
    opened.wait_until("location.hash === '#step=33&robot=r3&view=gantt'")
    opened.page.focus("#gantt")
    opened.page.keyboard.press("ArrowUp")
    opened.wait_until("location.hash === '#step=33&robot=r2&view=gantt'")
    assert "serving" in opened.page.inner_text("#phases")


def test_bars_are_named_by_their_own_task_and_tasks_done_are_marked(
    open_page: Opener, dock: Tree
) -> None:
    """r3 is in the team that does seam from 35 to 40; no bar is about two tasks."""
    opened = open_page(dock, "#view=gantt")
    row = opened.page.evaluate("window.teamformer.bars(2)")
    serving = [bar for bar in row["bars"] if bar["phase"] == "serving"]
    assert [(bar["task"], bar["from"], bar["to"]) for bar in serving] == [("seam", 35, 40)]
    assert {"task": "seam", "step": 40} in row["marks"]
    opened.page.select_option("#bars", "task")
    opened.details()
    seam = serving[0]
    x, y = (seam["left"] + seam["right"]) / 2, 24 + 2.5 * row["rowHeight"] - 8
    colour = opened.page.evaluate(PIXEL_OF_BARS, [x, y])
    task_colour = opened.page.evaluate("window.teamformer.taskColour(2)")
    assert colour == opened.page.evaluate(PIXEL_OF_COLOUR, task_colour)
    opened.page.mouse.move(*centre_of(opened, x, y + 8))
    opened.wait_until("document.querySelector('#gantt').title.startsWith('r3: serving, seam')")
    assert opened.errors == []


PIXEL_OF_BARS = """([x, y]) => {
  const canvas = document.querySelector("#gantt"), sharpness = window.devicePixelRatio;
  const at = canvas.getContext("2d").getImageData(x * sharpness, y * sharpness, 1, 1);
  return [...at.data];
}"""
PIXEL_OF_COLOUR = """(colour) => {
  const ctx = document.createElement("canvas").getContext("2d");
  ctx.fillStyle = colour;
  ctx.fillRect(0, 0, 1, 1);
  return [...ctx.getImageData(0, 0, 1, 1).data];
}"""


def centre_of(opened: Opened, x: float, y: float) -> tuple[float, float]:
    box = opened.page.locator("#gantt").bounding_box()
    return box["x"] + x, box["y"] + y


def test_names_and_shares_stay_in_sight_with_100_robots(open_page: Opener) -> None:
    """Rows keep a height at which names can be read; time is drawn wider and scrolls under them."""
    opened = open_page(toy_record(random_mission(100, 12, 100, 20, 30)), "#view=gantt")
    row = opened.page.evaluate("window.teamformer.bars(99)")
    assert row["rowHeight"] >= 13
    ends = "([x, y]) => " + INK_IN.format(width="90", height="200")
    opened.page.click("#zoom-in")
    opened.page.click("#zoom-in")
    opened.page.evaluate(
        "() => { const box = document.querySelector('.bars');"
        " box.scrollLeft = 200; box.scrollTop = 400; }"
    )
    opened.details()
    moved = opened.page.evaluate("window.teamformer.bars(99)")["bars"][0]["left"]
    assert moved == pytest.approx(row["bars"][0]["left"] - 200)
    width = opened.page.locator("#gantt").bounding_box()["width"]
    assert opened.page.evaluate(ends, [0, 40]) > 100  # letters
    assert opened.page.evaluate(ends, [width - 48, 40]) > 100
    opened.page.click("#zoom-fit")
    opened.details()
    assert opened.page.evaluate("document.querySelector('.bars').scrollLeft") == 0


INK_IN = """{{
  const canvas = document.querySelector("#gantt"), sharpness = window.devicePixelRatio;
  const [wide, high] = [Math.min({width}, canvas.width - x), {height}];
  const {{ data }} = canvas.getContext("2d").getImageData(x * sharpness, y * sharpness, wide, high);
  let dark = 0;
  for (let at = 0; at < data.length; at += 4) dark += data[at] + data[at + 1] + data[at + 2] < 400;
  return dark;
}}"""


def test_robots_say_how_they_spend_their_time(open_page: Opener, dock: Tree) -> None:
    opened = open_page(dock, "#step=40")
    opened.page.click("#tab-robots")
    texts = opened.page.locator(".row").all_inner_texts()
    assert len(texts) == 4
    assert "lost in step 36" in texts[3]
    shares = [int(part.split()[-1][:-1]) for part in texts[0].split("\n")[-1].split(", ")]
    assert abs(sum(shares) - 100) <= 2


def record_file(tree: Tree, path: Path) -> Path:
    path.write_text(json.dumps(tree), encoding="utf-8")
    return path


def choose(opened: Opened, button: str, path: Path) -> None:
    opened.page.click("#menu summary")
    with opened.page.expect_file_chooser() as chooser:
        opened.page.click(button)
    chooser.value.set_files(path)


def test_a_dropped_record_is_opened(open_page: Opener, dock: Tree) -> None:
    opened = open_page(dock, "#step=61")
    opened.drop(json.dumps(three_in_one_cell()))
    opened.wait_until("document.querySelector('#about').textContent.includes('2 robots')")
    assert opened.shown_step() == 0
    opened.page.keyboard.press("End")
    opened.shown_step()
    assert opened.page.inner_text("#status") == "Completed"
    assert opened.errors == []


def test_two_records_run_in_step(open_page: Opener, dock: Tree, tmp_path: Path) -> None:
    opened = open_page(dock)
    tasks = small_mission()["tasks"][:2]
    other = toy_record(small_mission() | {"name": "the other", "tasks": tasks})
    assert len(other["steps"]) < 61
    choose(opened, "#open-beside", record_file(other, tmp_path / "other.json"))
    title = "document.querySelector('.beside .caption strong')?.textContent"
    opened.wait_until(f"{title} === 'the other, toy'")
    for key, step, beside in [("ArrowRight", 1, 1), ("End", 61, len(other["steps"]))]:
        opened.page.keyboard.press(key)
        assert opened.shown_step() == step
        assert opened.page.evaluate("window.teamformer.besideSteps()") == [beside]
    opened.wait_until("document.querySelector('.beside').textContent.includes('completed')")
    opened.page.click(".beside >> text=Close")
    assert opened.page.locator(".beside").count() == 0
    assert opened.errors == []


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "it is not JSON"),
        ('{"teamformer": 1}', "it is no record of a trial"),
        ('{"teamformer_record": 4}', "it has format 4, and this page knows 3"),
        ('{"teamformer_record": 1}', "this page knows 3; run the mission again"),
        ('{"teamformer_record": 3}', "it is damaged"),
    ],
)
def test_what_is_no_record_is_refused_and_nothing_is_lost(
    open_page: Opener, dock: Tree, text: str, message: str
) -> None:
    opened = open_page(dock, "#step=7")
    opened.drop(text)
    opened.wait_until("!document.querySelector('#notice-box').hidden")
    assert message in opened.page.inner_text("#notice")
    assert opened.shown_step() == 7
    assert opened.errors == []


@pytest.mark.parametrize(
    ("keys", "value", "told"),
    [
        (("steps", 9), None, "its steps cannot be read"),
        (("steps", 39, "done"), [[99, 0]], "its steps cannot be read"),
        (("orders",), 3, "'orders' is no list"),
        (("mission", "tasks"), None, "its mission has no lists of robots, tasks and capabilities"),
    ],
)
def test_a_damaged_record_is_refused_as_a_whole(
    open_page: Opener, dock: Tree, keys: tuple[str | int, ...], value: object, told: str
) -> None:
    """Where it cannot be shown; `view` refuses the same and more, and the page stays as it was."""
    tree: Any = json.loads(json.dumps(dock))
    part = tree
    for key in keys[:-1]:
        part = part[key]
    part[keys[-1]] = value
    with pytest.raises(TeamformerError):
        record_from_tree(tree, "record")
    opened = open_page(dock, "#step=7")
    for is_beside in (False, True):
        opened.drop(json.dumps(tree), is_beside)
        opened.wait_until("document.querySelector('#notice').textContent.includes('damaged')")
        assert f"it is damaged ({told})" in opened.page.inner_text("#notice")
        opened.page.click("#notice-close")
    assert opened.shown_step() == 7
    assert opened.page.locator(".beside").count() == 0
    assert opened.page.inner_text("#name") == "Dock, early shift"
    assert opened.errors == []


def test_a_picture_is_saved(open_page: Opener, dock: Tree, tmp_path: Path) -> None:
    opened = open_page(dock, "#step=33")
    opened.page.click("#menu summary")
    with opened.page.expect_download() as download:
        opened.page.click("#save-picture")
    assert download.value.suggested_filename == "Dock-early-shift-33.png"
    data = download.value.path().read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    width = int.from_bytes(data[16:20], "big")
    assert width == opened.page.evaluate("document.getElementById('map').width")


def test_a_video_is_saved(open_page: Opener, dock: Tree) -> None:
    opened = open_page(dock, "#step=52")
    opened.page.click("#menu summary")
    with opened.page.expect_download() as download:
        opened.page.click("#save-video")
    data = download.value.path().read_bytes()
    assert data[:4] == b"\x1a\x45\xdf\xa3"  # EBML, of which WebM is made
    assert len(data) > 2000
    assert opened.shown_step() == 61


SIZES = [(1400, 900), (820, 1180), (390, 844)]


@pytest.mark.parametrize(("width", "height"), SIZES)
def test_map_panel_and_playback_are_in_sight(
    open_page: Opener, dock: Tree, width: int, height: int
) -> None:
    opened = open_page(dock, "#robot=r1")
    opened.page.set_viewport_size({"width": width, "height": height})
    opened.details()
    box = opened.page.locator("#map").bounding_box()
    assert box["y"] < 110
    assert box["height"] >= 0.34 * height
    for selector in ("#details h2", "#scrub", "#play", "#menu summary", "#help"):
        assert is_in_sight(opened, selector), selector
    page = "[document.documentElement.scrollWidth, document.documentElement.scrollHeight]"
    assert opened.page.evaluate(page) == [width, height]


def is_in_sight(opened: Opened, selector: str) -> bool:
    """Return whether the middle of an element is in the window with nothing over it."""
    box = opened.page.locator(selector).bounding_box()
    middle = [box["x"] + box["width"] / 2, box["y"] + box["height"] / 2]
    found = "([selector, x, y]) => !!document.elementFromPoint(x, y)?.closest(selector)"
    return bool(opened.page.evaluate(found, [selector, *middle]))


def test_on_a_plane_moments_are_in_seconds(open_page: Opener, dock: Tree) -> None:
    mission = dock["mission"] | {
        "world": {"plane": [9, 6], "step": 0.5, "arrival_radius": 0.05, "unit": 1.0},
    }
    opened = open_page({**dock, "mission": mission}, "#step=36&robot=r4")
    assert opened.details().startswith("r4\nDeselect\nLost at 18 s")
    assert opened.page.inner_text("#counter") == "Step 36 of 61\n18 s"
    opened.page.keyboard.press("End")
    opened.shown_step()
    assert "30.5 s 61 steps" in opened.page.inner_text("#figures").replace("\n", " ")


def test_a_robot_says_what_the_shared_plan_has_it_do(open_page: Opener, dock: Tree) -> None:
    """The plan is made anew when `late load` appears in 20."""
    plans = [[0, [["start"], [[0, 1], [0, 3], [2]]]], [20, [["task appeared"], [[0, 3], [1, 2]]]]]
    orders = [[0, [0, 1, 2]], [20, [1, 2]]]
    tree = told_too({**dock, "plans": plans, "orders": orders})
    opened = open_page(tree, "#step=3&robot=r1")
    assert "Why: the plan has r1, r2 do it together." in opened.details()
    opened.page.fill("#scrub", "21")
    told = "Why: the plan has r1, r4 do it together; planned anew after step 20: late load appears."
    assert told in opened.details()
    opened.page.fill("#scrub", "32")  # for seam
    assert "Why: the plan has r2, r3 do it together; planned anew" in opened.details()
    assert opened.errors == []


def test_messages_of_a_rehearsal_are_drawn_and_can_be_left_out(open_page: Opener) -> None:
    """A plan from r1 to r2: half a line, on the side of r1, in colour."""
    tree = three_in_one_cell()
    opened = open_page(tree, "#step=1")
    assert not opened.page.is_visible("#messages")
    tree["steps"][0]["heard"] = [[0, 1, "plan"]]
    opened = open_page(tree, "#step=1")
    opened.shown_step()
    assert opened.page.get_attribute("#messages", "aria-pressed") == "true"
    spots = [opened.page.evaluate(f"window.teamformer.robotSpot({robot})") for robot in range(2)]

    def pixels() -> list[list[int]]:
        """Return the colours a quarter and three quarters of the way from r1 to r2."""
        places = [
            [spots[0][axis] + part * (spots[1][axis] - spots[0][axis]) for axis in "xy"]
            for part in (0.25, 0.75)
        ]
        read = """(places) => { const map = document.getElementById('map');
            const sharp = map.width / map.getBoundingClientRect().width;
            const one = ([x, y]) => map.getContext('2d').getImageData(x * sharp, y * sharp, 1, 1);
            return places.map((place) => [...one(place).data]); }"""
        found: list[list[int]] = opened.page.evaluate(read, places)
        return found

    with_messages = pixels()
    opened.page.click("#messages")
    opened.shown_step()
    opened.page.evaluate("() => new Promise((done) => requestAnimationFrame(() => done()))")
    without = pixels()
    assert with_messages[0] != without[0]
    assert with_messages[1] == without[1]


@pytest.mark.parametrize(("width", "height"), SIZES)
def test_the_legend_of_capabilities_and_the_tools_are_all_in_sight(
    open_page: Opener, dock: Tree, width: int, height: int
) -> None:
    opened = open_page(dock, "#step=3")
    opened.page.set_viewport_size({"width": width, "height": height})
    opened.wait_for_a_frame()
    buttons = opened.page.locator("#tools button:visible").all()
    assert len(buttons) > 8
    for button in buttons:
        box = button.bounding_box()
        assert 0 <= box["x"] <= width - box["width"]
    if width == 390:
        assert opened.page.is_hidden("#lines")
        opened.page.click("#more")
        assert opened.page.is_visible("#lines")


def test_the_legend_of_a_crowd_lies_over_the_map_and_not_on_it(open_page: Opener) -> None:
    opened = open_page(toy_record(random_mission(60, 50, 4, 40, 2)), "#step=3")
    opened.page.set_viewport_size({"width": 390, "height": 844})
    opened.wait_until("window.teamformer.detail() !== 'robots'")
    opened.wait_for_a_frame()
    opened.wait_for_a_frame()
    lowest = max(item["y"] for item in opened.page.evaluate("window.teamformer.legend()"))
    world = opened.page.evaluate("JSON.parse(document.querySelector('#record').textContent)")
    height = world["mission"]["world"]["grid"][1]
    tops = [opened.page.evaluate(f"window.teamformer.pixelOf(0, {y}).y") for y in (0, height - 1)]
    assert lowest < min(tops)


def test_names_of_robots_do_not_lie_over_other_robots(open_page: Opener) -> None:
    robots = [
        {"name": f"robot-{x}-{y}", "at": [x, y], "can": {"lift": 1}}
        for x in range(4)
        for y in range(3)
    ]
    mission = small_mission() | {"robots": robots}
    mission["tasks"] = [{"name": "far", "at": [9, 7], "needs": {"lift": 1}}]
    opened = open_page(toy_record(mission), "#step=0")
    opened.page.set_viewport_size({"width": 820, "height": 1180})
    opened.wait_for_a_frame()
    opened.wait_for_a_frame()
    names = [it for it in opened.page.evaluate("window.teamformer.names()") if it["text"] != "far"]
    assert names
    for name in names:
        for robot in range(len(robots)):
            spot = opened.page.evaluate(f"window.teamformer.robotSpot({robot})")
            is_over = abs(spot["x"] - name["x"]) < name["half"] - 2 + spot["r"]
            assert not (is_over and abs(spot["y"] - name["y"]) < spot["r"] + 4)


def test_many_short_bars_are_no_white_lines(open_page: Opener) -> None:
    """The row of a robot that goes from task to task is as good as full."""
    opened = open_page(toy_record(random_mission(100, 300, 4, 60, 2)), "#view=gantt")
    opened.wait_until("document.querySelector('#gantt').width > 0")
    opened.wait_for_a_frame()
    opened.wait_for_a_frame()
    part = opened.page.evaluate(EMPTY_PART)
    assert part < 0.08


EMPTY_PART = """() => {
  const canvas = document.querySelector("#gantt");
  const { bars, rowHeight } = window.teamformer.bars(0);
  const sharpness = canvas.width / canvas.clientWidth;
  const [left, right] = [bars[0].left, bars.at(-1).right].map((x) => Math.round(x * sharpness));
  const y = Math.round((24 + rowHeight * 0.25) * sharpness);
  const { data } = canvas.getContext("2d").getImageData(left, y, right - left, 1);
  let empty = 0;
  for (let at = 0; at < data.length; at += 4) empty += data[at] > 200 && data[at + 2] > 200;
  return empty / (right - left);
}"""


def test_what_cannot_be_drawn_is_left_out_and_told_once(open_page: Opener) -> None:
    """The order names a task that is not there. All else is drawn, in frame after frame."""
    record = three_in_one_cell()
    record["orders"][0][1].append(99)
    opened = open_page(record)
    opened.page.click("#order")
    for step in (1, 2, 3):
        frames = opened.page.evaluate("window.teamformer.framesDrawn()")
        opened.page.keyboard.press("ArrowRight")
        opened.wait_until(f"window.teamformer.framesDrawn() > {frames}")
        assert opened.shown_step() == step
    told = opened.page.inner_text("#notice")
    assert told.startswith("Not all of the order can be shown: ")
    assert told.endswith(". Please report it with this record.")
    assert [error.split(":")[0] for error in opened.errors] == ["TypeError"]


def test_a_page_of_a_fleet_shows_all_views_though_nobody_knows_who_did_a_task(
    open_page: Opener,
) -> None:
    record = three_in_one_cell()
    for step in record["steps"]:
        step["done"] = [[task, None] for task, _ in step.get("done", [])]
    opened = open_page(record, f"#step={len(record['steps'])}")
    for view in ("gantt", "tasks", "robots", "plots", "map"):
        opened.page.evaluate(f"location.hash = 'view={view}&task=inspect'")
        opened.wait_for_a_frame()
        assert "not known by whom" in opened.details()
    opened.page.evaluate("window.teamformer.criticalPath()")
    assert opened.errors == []


@pytest.mark.parametrize(("width", "height"), [(1400, 900), (820, 1180), (390, 844)])
def test_long_names_push_nothing_off_the_screen(open_page: Opener, width: int, height: int) -> None:
    """A robot with a long name that is lost stands in the header; all of the name is its title."""
    mission = small_mission()
    name = "the robot with the long name " * 6
    mission["robots"][3]["name"] = name.strip()
    mission["name"] = name.strip()
    opened = open_page(toy_record(mission), "#step=40")
    opened.page.set_viewport_size({"width": width, "height": height})
    opened.wait_for_a_frame()
    assert opened.page.evaluate("document.documentElement.scrollWidth") == width
    status = opened.page.locator("#status").bounding_box()
    assert status["x"] + status["width"] <= width
    assert opened.page.locator("#name").bounding_box()["width"] > 100
    assert opened.page.get_attribute("#figures .lost dd", "title") == name.strip()


def test_the_list_of_robots_says_who_is_lost_and_all_that_robots_bring(
    open_page: Opener, dock: Tree
) -> None:
    opened = open_page(dock, "#step=40")
    opened.page.click("#tab-robots")
    opened.details()
    rows = opened.page.locator("#rows .row")
    assert rows.nth(3).locator(".text > span").all_inner_texts() == ["r4", "lost in step 36"]
    assert rows.nth(1).locator(".swatch").all_inner_texts() == ["S", "P"]


def test_the_gantt_chart_is_drawn_once_while_the_moment_goes_on(
    open_page: Opener, dock: Tree
) -> None:
    """Only the line of the moment moves; what is selected or stretched is drawn anew."""
    opened = open_page(dock, "#step=5&view=gantt")
    opened.details()
    opened.page.evaluate(COUNT_TEXTS)
    for _ in range(3):
        opened.page.keyboard.press("ArrowRight")
        opened.details()
        opened.wait_for_a_frame()
    assert opened.page.evaluate("window.textsDrawn") == 0
    opened.page.click("#zoom-in")
    opened.wait_for_a_frame()
    opened.wait_for_a_frame()
    drawn = opened.page.evaluate("window.textsDrawn")
    assert drawn > 0
    opened.page.keyboard.press("End")
    opened.page.click("#tab-robots")
    opened.page.click("#rows .row >> nth=0")
    opened.details()
    opened.wait_for_a_frame()
    assert opened.page.evaluate("window.textsDrawn") > drawn
    assert opened.errors == []


COUNT_TEXTS = """() => {
  window.textsDrawn = 0;
  const { fillText } = CanvasRenderingContext2D.prototype;
  CanvasRenderingContext2D.prototype.fillText = function (...words) {
    if (this.canvas.id !== "marks") window.textsDrawn++;
    return fillText.apply(this, words);
  };
}"""
