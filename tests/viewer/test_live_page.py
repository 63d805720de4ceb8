"""A live mission in a real browser: started, disturbed, looked back at, saved."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from conftest import Opened
from live_server import Served, serving, small_mission
from teamformer.model import Absence
from teamformer.referee import judge
from teamformer.sim.replay.reading import read_replay

pytest.importorskip("uvicorn", reason="the extra `live` is not installed")


@pytest.fixture
def served(tmp_path: Path) -> Iterator[Served]:
    with serving(small_mission(), tmp_path / "out") as server:
        yield server


@pytest.fixture
def opened(browser: Any, served: Served) -> Iterator[Opened]:
    context = browser.new_context(viewport={"width": 1280, "height": 800})
    found = Opened(context.new_page())
    found.page.on("pageerror", lambda error: found.errors.append(str(error)))
    found.page.goto(f"http://{served.address}/")
    found.wait_until("window.teamformer !== undefined")
    yield found
    context.close()
    assert found.errors == []


def wait_for(opened: Opened, selector: str, text: str) -> None:
    opened.wait_until(f"document.querySelector('{selector}')?.textContent.includes({text!r})", 30)


def step_to(opened: Opened, step: int, begun: int = 0) -> None:
    for number in range(begun + 1, step + 1):
        opened.page.keyboard.press("ArrowRight")
        opened.wait_until(f"window.teamformer.last === {number}")


def test_a_mission_starts_with_a_click_and_ends(opened: Opened) -> None:
    assert opened.page.inner_text("#start") == "Start the mission"
    wait_for(opened, "#outlook", "all done at step 13")
    opened.page.click("#start")
    opened.wait_until("window.teamformer.step === 13", 30)
    wait_for(opened, "#status", "Completed")
    wait_for(opened, "#mission h2", "Live, over")


def test_a_task_is_added_where_one_clicks_and_a_robot_lost(
    opened: Opened, served: Served, tmp_path: Path
) -> None:
    page = opened.page
    step_to(opened, 4)
    opened.click_map(page.evaluate("window.teamformer.pixelOf(3, 2)"))
    assert [page.input_value(f"[name={key}]") for key in "xy"] == ["3", "2"]
    page.fill("[name='cap 1']", "1")
    page.fill("[name=title]", "extra")
    page.click("#new-task >> text=What would that cost?")
    wait_for(opened, "#answer", "With task extra at [3, 2] that needs scan: all done at step")
    page.click("text=Add task")
    wait_for(opened, "#incidents", "4: task extra at [3, 2] that needs scan")
    page.click("#tab-robots")
    page.click(".row >> text=r1")
    page.click("text=Lose r1")
    wait_for(opened, "#incidents", "4: robot r1 lost")
    wait_for(opened, "#details", "r1 counts for nothing from the next step on")
    assert page.locator("text=Lose r1").count() == 0
    step_to(opened, 6, begun=4)
    page.click("text=Bring r1 back")
    wait_for(opened, "#details", "r1 is there again from the next step on")
    wait_for(opened, "#incidents", "6: robot r1 back")
    page.keyboard.press(" ")
    wait_for(opened, "#status", "Completed")
    page.click("#mission >> text=Save")
    wait_for(opened, "#notice", "replay.json")
    record = read_replay(tmp_path / "out" / "replay.json")
    assert judge(record).findings == ()
    assert record.scenario.tasks[-1].name == "extra"
    assert record.scenario.robots[0].absences == (Absence(5, 7),)
    assert page.inner_text("#figures").split("\n")[1] == "4 of 4"


def test_one_looks_back_while_the_mission_goes_on(opened: Opened) -> None:
    step_to(opened, 5)
    opened.page.keyboard.press("Home")
    assert opened.shown_step() == 0
    opened.page.keyboard.press(" ")
    opened.wait_until("window.teamformer.last === 13", 30)
    assert opened.shown_step() == 0
    opened.page.keyboard.press("End")
    assert opened.shown_step() == 13


def test_a_task_in_a_wall_is_refused_in_the_page(opened: Opened, served: Served) -> None:
    opened.page.click("text=New task …")
    opened.page.fill("[name=x]", "5")
    opened.page.fill("[name=y]", "1")
    opened.page.fill("[name='cap 0']", "1")
    opened.page.click("text=Add task")
    wait_for(opened, "#notice", "Not done: task")
    assert "inside an obstacle; move it" in opened.page.inner_text("#notice")
    assert served.session.mission.incidents == []


def test_a_server_that_ends_is_told(browser: Any, tmp_path: Path) -> None:
    page = browser.new_page()
    with serving(small_mission(), tmp_path) as server:
        page.goto(f"http://{server.address}/")
        opened = Opened(page)
        opened.wait_until("window.teamformer !== undefined")
    wait_for(opened, "#mission h2", "connection lost")
    page.click("text=Save")
    wait_for(opened, "#notice", "The server is not there; nothing was done")
    page.close()
