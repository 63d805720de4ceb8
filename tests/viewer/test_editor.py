"""From an empty page to a checked record: drawn, saved, run, disturbed, explained, run again."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from browsers import Opened
from live_server import Served, serving_editor
from teamformer.files.mission_files import read_mission
from teamformer.methods.by_name import load_method
from teamformer.mission.model import Absence
from teamformer.record.files.reading import read_record
from teamformer.record.referee import judge
from teamformer.trials.trial import run_trial

pytest.importorskip("uvicorn", reason="the extra `live` is not installed")

ROBOTS = [(1, y) for y in range(1, 7)]
TASKS = [(5, 2), (8, 7), (12, 3), (14, 8), (10, 5), (6, 8), (13, 1), (9, 1)]


@pytest.fixture
def served(tmp_path: Path) -> Iterator[Served]:
    with serving_editor(tmp_path / "out", speed=8) as server:
        yield server


@pytest.fixture
def begun(browser: Any, served: Served) -> Iterator[Opened]:
    """The editor as it opens, with a mission to change."""
    context = browser.new_context(viewport={"width": 1400, "height": 900})
    found = Opened(context.new_page())
    found.page.on("pageerror", lambda error: found.errors.append(str(error)))
    found.page.goto(f"http://{served.address}/")
    found.wait_until("window.teamformer !== undefined")
    yield found
    context.close()
    assert found.errors == []


@pytest.fixture
def opened(begun: Opened) -> Opened:
    """The editor with an empty map."""
    begun.page.click("#mission >> text=New")
    wait_for(begun, "#about", "0 robots")
    return begun


def test_the_editor_offers_only_what_means_something_there(begun: Opened) -> None:
    page = begun.page
    begun.wait_until("window.teamformer.teams().length === 3")
    shown = {button.inner_text() for button in page.locator("button:visible").all()}
    assert not shown & {"Lines", "Trails", "Order", "Dim", "Gantt", "Events", "Teams", "Map"}
    assert page.is_hidden("#filter")
    assert page.is_hidden("#rings")
    undo, redo = (page.get_by_role("button", name=name, exact=True) for name in ("Undo", "Redo"))
    assert (undo.is_disabled(), redo.is_disabled()) == (True, True)
    page.click("[data-tool=robot]")
    click(begun, 8, 8)
    begun.wait_until("window.teamformer.teams().length === 4")
    assert (undo.is_disabled(), redo.is_disabled()) == (False, True)
    undo.click()
    begun.wait_until("window.teamformer.teams().length === 3")
    assert (undo.is_disabled(), redo.is_disabled()) == (True, False)


TOP = "(part) => document.querySelector(part).getBoundingClientRect().top"
BOTTOM = "(part) => document.querySelector(part).getBoundingClientRect().bottom"


def click(opened: Opened, x: float, y: float) -> None:
    opened.details()
    opened.click_map(opened.page.evaluate(f"window.teamformer.pixelOf({x}, {y})"))


def wait_for(opened: Opened, selector: str, text: str) -> None:
    opened.wait_until(f"document.querySelector('{selector}')?.textContent.includes({text!r})")


def draw(opened: Opened) -> None:
    opened.page.click("[data-tool=robot]")
    for place in ROBOTS[:3]:
        click(opened, *place)
    opened.page.fill("[name='kit lift']", "0")
    opened.page.fill("[name='kit scan']", "1")
    for place in ROBOTS[3:]:
        click(opened, *place)
    opened.page.click("[data-tool=task]")
    opened.page.fill("[name='kit lift']", "0")
    opened.page.fill("[name='kit scan']", "1")
    for place in TASKS[:4]:
        click(opened, *place)
    opened.page.fill("[name='kit lift']", "1")
    for place in TASKS[4:]:
        click(opened, *place)


def test_a_mission_is_drawn_run_disturbed_explained_and_run_again(
    opened: Opened, served: Served, tmp_path: Path
) -> None:
    page = opened.page
    wait_for(opened, "#problems", "")
    draw(opened)
    opened.wait_until("!document.querySelector('#problems li')")
    page.click("#mission >> text=Save")
    wait_for(opened, "#notice", "Saved: ")
    drawn = read_mission(tmp_path / "out" / "mission.yaml")
    assert [robot.at for robot in drawn.robots] == ROBOTS
    assert [task.at for task in drawn.tasks] == TASKS
    assert [dict(task.needs) for task in drawn.tasks][3:5] == [{"scan": 1}, {"lift": 1, "scan": 1}]
    with page.expect_event("load", timeout=60_000):
        page.click("#mission >> text=Run")
    opened.wait_until("window.teamformer !== undefined")
    wait_for(opened, "#start-text", "Start the mission")
    for step in range(1, 11):
        page.keyboard.press("ArrowRight")
        opened.wait_until(f"window.teamformer.last === {step}")
    click(opened, 3, 8)
    page.fill("[name='cap 0']", "1")
    page.fill("[name=title]", "late load")
    page.click("text=Add task")
    wait_for(opened, "#incidents", "10: task late load at [3, 8] that needs lift")
    for step in range(11, 16):
        page.keyboard.press("ArrowRight")
        opened.wait_until(f"window.teamformer.last === {step}")
    page.click("#tab-robots")
    page.click(".row >> text=r1")
    wait_for(opened, "#details", "Why: ")
    assert page.evaluate(f"({BOTTOM})('.lists') <= ({TOP})('.transport')")
    page.click("text=Lose r1 …")
    page.click("text=Yes, lose r1")
    wait_for(opened, "#incidents", "16: robot r1 lost")
    page.keyboard.press(" ")
    wait_for(opened, "#mission h2", "Live, over")
    page.click("#mission >> text=Save")
    wait_for(opened, "#notice", "mission.yaml")
    record = read_record(tmp_path / "out" / "record.json")
    assert judge(record).findings == ()
    mission = read_mission(tmp_path / "out" / "mission.yaml")
    assert (mission.tasks[-1].appears, mission.robots[0].absences[0].lost) == (10, 16)
    again = run_trial(mission, load_method("join-fitting"))
    assert again.record.end.makespan == record.end.makespan
    assert record.end.status == "completed"


def test_what_is_wrong_is_told_in_the_words_of_the_file_reader(opened: Opened) -> None:
    page = opened.page
    wait_for(opened, "#problems .hint", "there is no robot; add one")  # which is no fault
    click(opened, 3, 3)  # selects nothing: the tool is not one that draws
    page.click("[data-tool=task]")
    page.fill("[name='kit lift']", "2")
    click(opened, 3, 3)
    wait_for(opened, "#problems", "there is no robot; add one")
    page.click("[data-tool=robot]")
    click(opened, 5, 5)
    assert page.input_value("[name='kit lift']") == "1"  # what tasks need is another matter
    wait_for(opened, "#problems", "task 't1' needs 2 x lift but all robots together have 1 x lift")
    page.click("#problems >> text=all robots together")
    opened.details()
    assert page.input_value("#thing [name=title]") == "t1"


def test_undo_redo_and_keys(opened: Opened) -> None:
    page = opened.page
    page.click("[data-tool=robot]")
    click(opened, 2, 2)
    click(opened, 4, 4)
    teams = "window.teamformer.teams().map((team) => team.place)"
    page.keyboard.press("ArrowRight")
    page.keyboard.press("ArrowUp")
    assert page.evaluate(teams) == [[2, 2], [5, 5]]
    page.keyboard.press("Delete")
    assert page.evaluate(teams) == [[2, 2]]
    page.keyboard.press("Control+z")
    assert page.evaluate(teams) == [[2, 2], [5, 5]]
    for _ in range(3):
        page.click("#mission >> text=Undo")
    assert page.evaluate(teams) == []
    page.click("#mission >> text=Undo")  # what was there before the new one
    assert len(page.evaluate(teams)) == 3
    page.click("#mission >> text=Redo")
    assert page.evaluate(teams) == []
    page.click("#mission >> text=Redo")
    assert page.evaluate(teams) == [[2, 2]]


def test_things_are_dragged_and_walls_painted(opened: Opened, tmp_path: Path) -> None:
    page = opened.page
    draw(opened)
    opened.details()
    corner = page.locator("#map").bounding_box()

    def drag(tool: str, *places: tuple[int, int]) -> None:
        page.click(f"[data-tool={tool}]")
        for number, (x, y) in enumerate(places):
            spot = page.evaluate(f"window.teamformer.pixelOf({x}, {y})")
            page.mouse.move(corner["x"] + spot["x"], corner["y"] + spot["y"], steps=4)
            if number == 0:
                page.mouse.down()
        page.mouse.up()
        opened.details()

    drag("move", ROBOTS[0], (2, 9))
    drag("wall", (7, 3), (7, 5))
    page.fill("#file-name", "walls.yaml")
    page.click("#mission >> text=Save")
    wait_for(opened, "#notice", "walls.yaml")
    mission = read_mission(tmp_path / "out" / "walls.yaml")
    assert mission.robots[0].at == (2, 9)
    blocked = [(x, y) for y in range(10) for x in range(16) if not mission.world.is_free((x, y))]
    assert blocked == [(7, 3), (7, 4), (7, 5)]


def test_files_are_opened_and_saved_in_the_folder_only(opened: Opened, tmp_path: Path) -> None:
    page = opened.page
    path = tmp_path / "shift.yaml"
    path.write_text(
        "teamformer: 1\nname: shift\nworld:\n  rows: |\n    ...\n    .@.\n"
        "capabilities: [lift]\nrobots:\n  - {at: [0, 0], can: [lift]}\n"
        "tasks:\n  - {at: [2, 1], needs: [lift]}\nsensing_radius: .inf\n"
    )
    with page.expect_file_chooser() as chooser:
        page.click("#mission >> text=Open …")
    chooser.value.set_files(path)
    wait_for(opened, "#name", "shift")
    page.fill("#file-name", "../shift.yaml")
    page.click("#mission >> text=Save")
    wait_for(opened, "#notice", "Not done: name a file in the folder")
    page.fill("#file-name", "again.yaml")
    page.click("#mission >> text=Save")
    wait_for(opened, "#notice", "again.yaml")
    assert read_mission(tmp_path / "out" / "again.yaml") == read_mission(path)
    path.write_text("teamformer: 1\nnmae: shift\n")
    with page.expect_file_chooser() as chooser:
        page.click("#mission >> text=Open …")
    chooser.value.set_files(path)
    wait_for(opened, "#notice", "shift.yaml:2: the file has no key 'nmae'")
    assert page.inner_text("#name") == "shift"


def test_a_ros_map_is_opened_with_its_image(opened: Opened, tmp_path: Path) -> None:
    about = tmp_path / "floor.yaml"
    about.write_text(
        "image: floor.pgm\nresolution: 0.05\norigin: [0.0, 0.0, 0.0]\n"
        "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
    picture = tmp_path / "floor.pgm"
    picture.write_bytes(b"P5 4 2 255\n" + bytes([254, 254, 254, 254, 0, 254, 254, 254]))
    with opened.page.expect_file_chooser() as chooser:
        opened.page.click("#mission >> text=Open …")
    chooser.value.set_files([picture, about])
    wait_for(opened, "#name", "floor")
    assert opened.page.input_value("#file-name") == "floor.yaml"


def test_a_new_name_is_taken_up_by_all_that_refer_to_it(opened: Opened, tmp_path: Path) -> None:
    """Half of the new name is another task's name for a moment; unnamed ones have names too."""
    page = opened.page
    path = tmp_path / "chain.yaml"
    path.write_text(
        "teamformer: 1\nworld: {grid: [9, 3]}\ncapabilities: [lift]\n"
        "robots:\n  - {name: cart, at: [0, 0], can: [lift], count: 2}\n"
        "  - {at: [1, 0], can: [lift]}\n"
        "tasks:\n  - {name: dig, at: [2, 1], needs: [lift]}\n"
        "  - {name: pour, at: [4, 1], needs: [lift], after: [dig]}\n"
        "  - {at: [6, 1], needs: [lift], after: [dig, pour]}\n"
        "  - {name: end, at: [8, 1], needs: [lift], after: [t3]}\n"
        "teams: [[cart-1, cart-2]]\n"
    )
    with page.expect_file_chooser() as chooser:
        page.click("#mission >> text=Open …")
    chooser.value.set_files(path)
    wait_for(opened, "#name", "chain")

    def rename(x: int, y: int, name: str) -> None:
        click(opened, x, y)
        opened.details()
        page.fill("#thing [name=title]", "")
        page.type("#thing [name=title]", name)

    rename(2, 1, "pourer")
    rename(6, 1, "wait")
    rename(0, 0, "truck")
    rename(1, 0, "eye")
    page.click("#mission >> text=Save")
    wait_for(opened, "#notice", "Saved: ")
    drawn = read_mission(tmp_path / "out" / "chain.yaml")
    assert [(task.name, task.after) for task in drawn.tasks] == [
        ("pourer", ()),
        ("pour", ("pourer",)),
        ("wait", ("pourer", "pour")),
        ("end", ("wait",)),
    ]
    assert [robot.name for robot in drawn.robots] == ["truck-1", "truck-2", "eye"]
    assert drawn.teams == ((0, 1),)


def test_losses_and_returns_are_lists_of_steps(opened: Opened, tmp_path: Path) -> None:
    page = opened.page
    page.click("[data-tool=robot]")
    click(opened, 2, 2)
    page.fill("#thing [name=lost]", "9, 40")
    wait_for(opened, "#problems", "is lost at step 40, but was lost in step 9")
    page.fill("#thing [name=back]", "20")
    page.click("[data-tool=task]")
    click(opened, 4, 4)
    opened.wait_until("!document.querySelector('#problems li')")
    page.click("#mission >> text=Save")
    wait_for(opened, "#notice", "Saved: ")
    text = (tmp_path / "out" / "mission.yaml").read_text()
    assert "lost: [9, 40], back: 20}" in text


def test_fractions_are_drawn_saved_run_and_added(opened: Opened, tmp_path: Path) -> None:
    """Two robots of 12.5 and 20.25 do what needs 32.75 together, and what is added: 0.125."""
    page = opened.page
    page.click("[data-tool=robot]")
    page.fill("[name='kit lift']", "12.5")
    click(opened, 2, 2)
    click(opened, 2, 3)
    page.fill("#thing [name='count lift']", "20.25")
    page.click("[data-tool=task]")
    page.fill("[name='kit lift']", "32.751")
    click(opened, 4, 2)
    wait_for(opened, "#problems", "needs 32.751 x lift but all robots together have 32.75 x lift")
    page.fill("#thing [name='count lift']", "32.75")
    opened.wait_until("!document.querySelector('#problems li')")
    page.click("#mission >> text=Save")
    wait_for(opened, "#notice", "Saved: ")
    drawn = read_mission(tmp_path / "out" / "mission.yaml")
    assert [robot.can for robot in drawn.robots] == [{"lift": 12.5}, {"lift": 20.25}]
    assert drawn.tasks[0].needs == {"lift": 32.75}
    with page.expect_event("load", timeout=60_000):
        page.click("#mission >> text=Run")
    opened.wait_until("window.teamformer !== undefined")
    wait_for(opened, "#start-text", "Start the mission")
    page.keyboard.press("ArrowRight")
    opened.wait_until("window.teamformer.last === 1")
    click(opened, 6, 6)
    page.fill("[name='cap 0']", "0.125")
    page.click("text=Add task")
    wait_for(opened, "#incidents", "1: task t2 at [6, 6] that needs 0.125 x lift")


def test_from_the_example_to_its_mission_and_back(begun: Opened, served: Served) -> None:
    """What the editor begins with runs; after its mission it is there again, to be changed."""
    page = begun.page
    begun.wait_until("window.teamformer.teams().length === 3")
    page.wait_for_timeout(400)  # the file reader has been asked
    assert page.locator("#problems li").count() == 0
    run(begun)
    page.keyboard.press("ArrowRight")
    begun.wait_until("window.teamformer.last === 1")
    page.click("text=Back to the drawing …")
    with page.expect_event("load", timeout=60_000):
        page.get_by_role("button", name="Back to the drawing", exact=True).click()
    begun.wait_until("window.teamformer?.teams().length === 3")
    page.click("[data-tool=robot]")
    click(begun, 4, 4)
    begun.wait_until("window.teamformer.teams().length === 4")
    run(begun)
    assert len(served.session.session.mission.source.robots) == 4
    with page.expect_event("load", timeout=60_000):  # nothing would be lost, so it is not asked
        page.click("text=Back to the drawing …")
    begun.wait_until("window.teamformer?.teams().length === 4")


def run(opened: Opened) -> None:
    with opened.page.expect_event("load", timeout=60_000):
        opened.page.click("text=Run the mission")
    opened.wait_until("window.teamformer !== undefined")
    wait_for(opened, "#start-text", "Start the mission")


HOLD_BACK = """() => {
  const { send } = WebSocket.prototype;
  window.heldBack = [];
  WebSocket.prototype.send = function (text) {
    window.heldBack.push(() => {
      WebSocket.prototype.send = send;
      this.send(text);
    });
  };
}"""
"""Has what a page says wait; what it says later goes its way once the first has been sent."""

PLACES = "window.teamformer.teams().map(({ place }) => place).join(' ')"


def test_two_pages_draw_one_mission(begun: Opened, served: Served) -> None:
    """What one draws the other shows; who was late is told, and goes back to the own drawing."""
    other = Opened(begun.page.context.new_page())
    other.page.goto(f"http://{served.address}/")
    other.wait_until("window.teamformer?.teams().length === 3")
    begun.page.click("[data-tool=robot]")
    click(begun, 4, 4)
    other.wait_until("window.teamformer.teams().length === 4")
    wait_for(other, "#notice", "Another page is drawing too.")
    other.page.click("[data-tool=robot]")
    click(other, 5, 5)
    begun.wait_until("window.teamformer.teams().length === 5")
    begun.page.click("#mission >> text=Undo")  # of what the other page has drawn
    other.wait_until("window.teamformer.teams().length === 4")
    other.page.evaluate(HOLD_BACK)
    click(other, 7, 7)
    other.wait_until("window.heldBack.length === 1")
    click(begun, 8, 8)
    other.wait_until(f"{PLACES}.includes('8,8')")
    other.page.evaluate("window.heldBack.forEach((send) => send())")
    wait_for(other, "#notice", "another page has changed the drawing")
    assert "7,7" not in other.page.evaluate(PLACES)
    other.page.click("#mission >> text=Undo")
    begun.wait_until(f"{PLACES}.includes('7,7')")
    assert "8,8" not in begun.page.evaluate(PLACES)
    assert other.errors == []


def test_what_was_drawn_can_be_undone_after_its_mission(begun: Opened) -> None:
    page = begun.page
    begun.wait_until("window.teamformer.teams().length === 3")
    page.click("[data-tool=robot]")
    click(begun, 4, 4)
    click(begun, 5, 5)
    page.click("#mission >> text=Undo")
    run(begun)
    with page.expect_event("load", timeout=60_000):
        page.click("text=Back to the drawing …")
    begun.wait_until("window.teamformer?.teams().length === 4")
    page.click("#mission >> text=Redo")
    begun.wait_until("window.teamformer.teams().length === 5")
    for _ in range(2):
        page.click("#mission >> text=Undo")
    begun.wait_until("window.teamformer.teams().length === 3")
    assert page.get_by_role("button", name="Undo", exact=True).is_disabled()


@pytest.mark.parametrize(("width", "height"), [(1400, 900), (820, 1180), (390, 844)])
def test_what_a_robot_brings_is_in_sight(begun: Opened, width: int, height: int) -> None:
    begun.page.set_viewport_size({"width": width, "height": height})
    begun.wait_for_a_frame()
    click(begun, 1, 4)
    begun.details()
    floor = begun.page.locator(".transport").bounding_box()["y"]
    for selector in ("text=Run the mission", "[name='count lift']", "[name='count scan']"):
        box = begun.page.locator(selector).bounding_box()
        assert 0 <= box["y"] <= floor - box["height"]


def test_fields_of_keys_say_what_they_mean_and_are_written(begun: Opened, tmp_path: Path) -> None:
    page = begun.page
    click(begun, 1, 4)
    wanted = {"note": "leaks oil", "speed": "0.5", "lost": "9, 40", "back": "20"}
    for name, text in wanted.items():
        page.fill(f"#thing [name={name}]", text)
    page.check("#thing [name=moves]")
    help_of_lost = page.get_attribute("#thing [name=lost]", "title")
    assert help_of_lost is not None
    assert help_of_lost.startswith("the step from which the robot is out of the mission")
    page.fill("#file-name", "keys.yaml")
    page.click("#mission >> text=Save")
    wait_for(begun, "#notice", "keys.yaml")
    robot = read_mission(tmp_path / "out" / "keys.yaml").robots[1]
    assert (robot.note, robot.speed, robot.moves) == ("leaks oil", 0.5, "air")
    assert robot.absences == (Absence(9, 20), Absence(40))
