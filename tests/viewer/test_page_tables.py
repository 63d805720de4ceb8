"""Tables, plots, downloads and the Tab key of a record's page, held against the record itself."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path
from typing import Any

import pytest
from toy_records import Tree, random_mission, toy_record

from browsers import Opened, Opener
from teamformer.files.mission_files import read_mission
from teamformer.record.files.reading import read_record

TABLE = "[...document.querySelectorAll('#stage-{} .rows [role=row]')]"
ROWS = TABLE + ".map((row) => [...row.children].map((cell) => cell.textContent))"


def rows_of(opened: Opened, kind: str) -> list[list[str]]:
    """Return the cells of the rows in sight, once the page shows its step."""
    opened.details()
    return opened.page.evaluate(ROWS.format(kind))  # type: ignore[no-any-return]


def column(opened: Opened, kind: str, number: int) -> list[str]:
    return [row[number] for row in rows_of(opened, kind)]


def sort_by(opened: Opened, name: str) -> None:
    opened.page.click(f"[role=columnheader] >> text={name} >> visible=true")


def saved_table(saved: Any) -> list[list[str]]:
    return list(csv.reader(io.StringIO(saved.value.path().read_text())))


@pytest.fixture
def lane() -> Tree:
    """r1 walks three cells to its task, which is late by one; r2 cannot do anything."""
    return toy_record(
        {
            "teamformer": 1,
            "name": "lane",
            "world": {"grid": [6, 1]},
            "capabilities": ["lift", "scan"],
            "robots": [
                {"name": "r1", "at": [0, 0], "can": ["lift"]},
                {"name": "r2", "at": [5, 0], "can": ["scan"]},
            ],
            "tasks": [{"name": "=t", "at": [3, 0], "needs": ["lift"], "between": [0, 2]}],
        }
    )


def test_a_lane_by_hand(open_page: Opener, lane: Tree) -> None:
    opened = open_page(lane, "#step=2&view=tasks")
    assert rows_of(opened, "tasks") == [["=t", "on the way", "r1", "3", "1 step", "lift"]]
    opened.page.keyboard.press("End")
    assert rows_of(opened, "tasks")[0][1:5] == ["done", "r1", "3", "1 step"]
    opened.page.keyboard.press("r")
    assert rows_of(opened, "robots") == [
        ["r1", "has just done =t", "-", "1", "0%", "lift"],
        ["r2", "idle", "-", "0", "100%", "scan"],
    ]
    opened.page.keyboard.press("Home")
    assert [row[2:5] for row in rows_of(opened, "robots")] == [["=t", "0", "-"], ["-", "0", "-"]]
    curves = opened.page.evaluate("window.teamformer.curves()")
    assert (curves["open"], curves["idle"], curves["way"]) == (
        [1, 1, 1, 0], [0, 1, 1, 1], [0, 1, 2, 3],
    )  # fmt: skip
    opened.page.keyboard.press("p")
    opened.page.keyboard.press("ArrowRight")
    opened.details()
    opened.wait_for_a_frame()
    label = opened.page.get_attribute("#plots", "aria-label")
    assert label == "Step 1: open tasks 1, idle robots 1, way of all robots 1 cell"
    assert opened.errors == []


def test_tasks_are_sorted_and_filtered(open_page: Opener, dock: Tree) -> None:
    ends = {task: n for n, step in enumerate(dock["steps"], 1) for task, _ in step.get("done", [])}
    names = [task["name"] for task in dock["mission"]["tasks"]]
    by_end = [names[task] for task in sorted(ends, key=lambda task: ends[task])]
    opened = open_page(dock, "#step=37&view=tasks")
    assert column(opened, "tasks", 0) == names
    assert dict(zip(names, column(opened, "tasks", 1), strict=True))["seam"] == "under way"
    assert column(opened, "tasks", 3) == [str(ends[task]) for task in range(len(names))]
    sort_by(opened, "End")
    assert column(opened, "tasks", 0) == by_end
    sort_by(opened, "End")
    assert column(opened, "tasks", 0) == by_end[::-1]
    header = opened.page.locator("[role=columnheader][aria-sort=descending]")
    assert header.inner_text().startswith("End")
    sort_by(opened, "End")
    assert column(opened, "tasks", 0) == names
    opened.page.fill("#stage-tasks input", "weld")
    assert column(opened, "tasks", 0) == ["seam", "late load"]
    assert opened.page.inner_text("#stage-tasks [role=status]") == "2 of 4"
    with opened.page.expect_download() as saved:
        opened.page.click("#stage-tasks >> text=Save as CSV")
    told = saved_table(saved)
    assert told == [["Task", "State", "Who", "End", "Needs"], *rows_of(opened, "tasks")]
    opened.page.click("#stage-tasks >> text=late load")
    opened.wait_until("location.hash === '#step=37&task=late+load&view=tasks'")


def test_names_are_no_formulas_in_a_table_that_is_saved(open_page: Opener, lane: Tree) -> None:
    opened = open_page(lane, "#step=3&view=tasks")
    with opened.page.expect_download() as saved:
        opened.page.click("#stage-tasks >> text=Save as CSV")
    assert saved.value.path().read_text().splitlines()[1].startswith("'=t,done,r1,3")


def test_filters_and_files_know_all_that_a_cell_says(open_page: Opener, lane: Tree) -> None:
    """A task that five robots do together, for fourteen capabilities; what is absent is empty."""
    caps = [f"c{number}" for number in range(14)]
    robots = [{"name": f"r{n}", "at": [0, 0], "can": caps[n::5]} for n in range(5)]
    task = {"name": "all", "at": [1, 0], "needs": caps}
    mission = lane["mission"] | {"capabilities": caps, "robots": robots, "tasks": [task]}
    opened = open_page(toy_record(mission), "#step=99&view=tasks")
    [row] = rows_of(opened, "tasks")
    assert row[2] == "r0 + 4 more"
    assert row[4].endswith("2 more")
    for wanted, found in (("r3", 1), ("c13", 1), ("r7", 0)):
        opened.page.fill("#stage-tasks input", wanted)
        assert len(rows_of(opened, "tasks")) == found
    opened.page.fill("#stage-tasks input", "")
    with opened.page.expect_download() as saved:
        opened.page.click("#stage-tasks >> text=Save as CSV")
    assert saved_table(saved)[1][2:] == ["r0, r1, r2, r3, r4", row[3], ", ".join(caps)]
    opened.page.keyboard.press("r")
    rows_of(opened, "robots")
    with opened.page.expect_download() as saved:
        opened.page.click("#stage-robots >> text=Save as CSV")
    assert [row[2] for row in saved_table(saved)] == ["Next", "", "", "", "", ""]


def test_the_next_task_is_what_a_robot_then_does(open_page: Opener) -> None:
    tree = toy_record(random_mission(12, 10, 3, 10, 2))
    opened = open_page(tree, "#step=0&view=robots")
    told = opened.page.evaluate("window.teamformer.told()")
    first: dict[str, str] = {}
    for _, kind, who, task in sorted(told):
        for robot in who.split(", ") if kind == "done" else ():
            first.setdefault(robot, task)
    assert dict(zip(column(opened, "robots", 0), column(opened, "robots", 2), strict=True)) == {
        robot["name"]: first.get(robot["name"], "-") for robot in tree["mission"]["robots"]
    }


def test_rows_are_one_stop_of_the_tab_key(open_page: Opener, dock: Tree) -> None:
    opened = open_page(dock, "#step=3&view=tasks")
    opened.details()
    opened.page.locator("#stage-tasks .rows .link").first.focus()
    opened.page.keyboard.press("ArrowDown")
    opened.page.keyboard.press("ArrowDown")
    opened.page.keyboard.press("Enter")
    opened.wait_until("location.hash.includes('task=seam')")
    opened.details()
    assert opened.page.evaluate("document.activeElement.textContent") == "seam"  # filled anew since


STOPS = """() => [...document.querySelectorAll(
  "button, a[href], input, select, summary, canvas[tabindex], [tabindex]")]
  .filter((it) => it.tabIndex >= 0 && !it.disabled && it.checkVisibility()).length"""


def test_the_tab_order_does_not_grow_with_events(open_page: Opener) -> None:
    """With a robot selected, whose story grows, and events listed below."""
    tree = toy_record(random_mission(6, 60, 2, 12, 2))
    stops = []
    for step in (2, len(tree["steps"])):
        opened = open_page(tree, f"#step={step}&robot=r1")
        assert "History of r1" in opened.details()
        stops.append(opened.page.evaluate(STOPS))
    assert max(stops) <= min(stops) + 6  # what the details of the moment have: links, a team
    assert max(stops) < 60


def test_arrows_walk_through_a_story(open_page: Opener, dock: Tree) -> None:
    opened = open_page(dock, "#step=0&robot=r1")
    opened.details()
    story = opened.page.locator("#details .story button")
    story.first.focus()
    opened.page.keyboard.press("ArrowDown")
    assert opened.page.evaluate("document.activeElement.textContent") == story.nth(1).inner_text()
    assert story.nth(1).get_attribute("tabindex") == "0"
    assert story.first.get_attribute("tabindex") == "-1"


def saved_from_menu(opened: Opened, text: str, folder: Path, name: str) -> Path:
    opened.page.click("#menu summary")
    with opened.page.expect_download() as saved:
        opened.page.click(f"#downloads >> text={text}")
    path = folder / name
    path.write_bytes(saved.value.path().read_bytes())
    return path


def test_a_saved_page_gives_its_mission_its_record_and_itself(
    open_page: Opener, browser: Any, tmp_path: Path
) -> None:
    mission = random_mission(4, 5, 2, 8, 2) | {"name": "</script> & <b>", "sensing_radius": ".inf"}
    tree = toy_record(mission)
    opened = open_page(tree, "#step=5&view=gantt")
    record = saved_from_menu(opened, "Record", tmp_path, "record.json")
    assert json.loads(record.read_text()) == tree
    (tmp_path / "plain.json").write_text(json.dumps(tree))
    assert read_record(record) == read_record(tmp_path / "plain.json")
    drawn = read_mission(saved_from_menu(opened, "Mission", tmp_path, "mission.json"))
    assert drawn == read_record(record).mission
    page = saved_from_menu(opened, "This page", tmp_path, "page.html")
    again = Opened(browser.new_page())
    again.page.on("pageerror", lambda error: again.errors.append(str(error)))
    again.page.goto(page.as_uri())
    assert again.shown_step() == 0
    assert again.page.evaluate("window.teamformer.told()") == opened.page.evaluate(
        "window.teamformer.told()"
    )
    assert again.page.inner_text("#name") == "</script> & <b>"
    assert again.page.evaluate("document.querySelectorAll('#tabs button').length") == 5
    assert again.errors == opened.errors == []
    again.page.close()


def test_menus_close_by_escape_and_by_clicks_elsewhere(open_page: Opener, dock: Tree) -> None:
    page = open_page(dock).page
    for leave in (lambda: page.keyboard.press("Escape"), lambda: page.click("#about")):
        page.click("#menu summary")
        assert page.is_visible("#downloads")
        leave()
        assert page.is_hidden("#downloads")


def test_on_a_tablet_all_rows_of_a_mission_are_in_sight(open_page: Opener, lane: Tree) -> None:
    """And on a phone a shadow says that a table goes on at its side."""
    mission = lane["mission"]
    tasks = [mission["tasks"][0] | {"name": f"t{number}"} for number in range(14)]
    opened = open_page(toy_record(mission | {"tasks": tasks}), "#view=tasks")
    opened.page.set_viewport_size({"width": 820, "height": 1180})
    opened.wait_for_a_frame()
    rows = opened.page.locator("#stage-tasks .rows").bounding_box()
    assert rows["height"] >= 14 * 32
    opened.page.set_viewport_size({"width": 390, "height": 844})
    across = opened.page.locator("#stage-tasks .across")
    assert across.evaluate("(box) => box.scrollWidth > box.clientWidth")
    assert (
        across.evaluate("(box) => getComputedStyle(box).backgroundAttachment").count("local") == 2
    )
