"""The page of a mission in continuous time while it runs: its clock, incidents, roads."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from browsers import Opened
from live_server import Served, serving_session
from teamformer.files.mission_files import mission_from_tree
from teamformer.live.continuous.running_course import RunningCourse
from teamformer.live.session import Session
from teamformer.methods.by_name import load_method

pytest.importorskip("uvicorn", reason="the extra `live` is not installed")

ROADS = "place,yard,hall,dock\nyard,0,3,5.5\nhall,4,0,2.5\ndock,6,2,0\n"


@pytest.fixture
def served(tmp_path: Path) -> Iterator[Served]:
    """A robot from the yard to the hall, where it stays 1.5, and to the dock: all over at 7."""
    tasks = [
        {"name": "first", "at": "hall", "needs": ["a"], "duration": 1.5},
        {"name": "then", "at": "dock", "needs": ["a"], "after": ["first"]},
    ]
    robots = [{"name": "r0", "at": "yard", "can": ["a"]}]
    tree = {"teamformer": 1, "name": "site", "time": "continuous", "world": {"roads": ROADS}}
    mission = mission_from_tree(tree | {"capabilities": ["a"], "robots": robots, "tasks": tasks})
    run = RunningCourse(mission, lambda: load_method("plan"), 0)
    with serving_session(Session(run, tmp_path / "out", run.usual_speed(4.0))) as server:
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
    opened.wait_until(f"document.querySelector('{selector}')?.textContent.includes({text!r})")


def test_a_mission_on_roads_is_watched_and_steered(opened: Opened, served: Served) -> None:
    page = opened.page
    wait_for(opened, "#outlook", "all done at 7.")
    assert page.input_value("#speed") == "5"  # ticks of 0.02: 0.1 units a second
    page.keyboard.press("ArrowRight")  # until something happens
    wait_for(opened, "#counter", "Time 3 of 3")
    page.click("text=New task …")
    page.select_option("select[name=place]", "yard")
    page.fill(".needs", "1")
    page.fill("[name=title]", "back")
    page.click("text=Add task")
    wait_for(opened, "#notice", "Incident at time 3.001: task back at yard that needs a.")
    wait_for(opened, "#incidents", "3: task back at yard that needs a")
    page.evaluate("location.hash = '#robot=r0'")
    page.click("text=Lose r0 …")
    page.click("text=Yes, lose r0")
    wait_for(opened, "#notice", "Incident at time 3.002: robot r0 lost.")
    wait_for(opened, "#outlook", "Given up at 3")
    page.click("text=Bring r0 back")
    wait_for(opened, "#status", "Paused")
    page.keyboard.press("Space")
    page.select_option("#speed", label="5 units/s")
    wait_for(opened, "#status", "Completed")
    record = served.session.mission.record()
    assert record.end.makespan == pytest.approx(3.003 + 1.5 + 2.5 + 6)
    assert page.inner_text("#figures").count("of 3") == 1
