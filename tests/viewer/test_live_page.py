"""A live mission in a real browser: started, disturbed, looked back at, saved."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import pytest
from toy_records import Tree

from browsers import Opened
from live_server import Served, serving, serving_session, small_mission
from small_worlds import late_pair, make, robot, task
from teamformer.base.errors import TeamformerError
from teamformer.live.drawing.drafts import Draft
from teamformer.live.keeping.autosave import Autosave, Identity
from teamformer.live.running.incidents import Incident
from teamformer.live.running.what_if import IsOver, WhatIf, what_if
from teamformer.live.session import Session
from teamformer.live.steps.mission_with_past import RunningMission
from teamformer.live.workshop import Workshop
from teamformer.methods.by_name import Method, load_method
from teamformer.methods.scripted.join_fitting import JoinFitting
from teamformer.mission.coordination import Known, Plan
from teamformer.mission.model import Absence
from teamformer.record.files.reading import read_record
from teamformer.record.referee import judge
from teamformer.world.env import Decision
from teamformer.world.view import View

pytest.importorskip("uvicorn", reason="the extra `live` is not installed")


@pytest.fixture
def served(tmp_path: Path) -> Iterator[Served]:
    with serving(small_mission(), tmp_path / "out") as server:
        yield server


@contextmanager
def opening(browser: Any, served: Served) -> Iterator[Opened]:
    context = browser.new_context(viewport={"width": 1280, "height": 800})
    found = Opened(context.new_page())
    found.page.on("pageerror", lambda error: found.errors.append(str(error)))
    found.page.goto(f"http://{served.address}/")
    found.wait_until("window.teamformer !== undefined")
    yield found
    context.close()
    assert found.errors == []


@pytest.fixture
def opened(browser: Any, served: Served) -> Iterator[Opened]:
    with opening(browser, served) as found:
        yield found


def wait_for(opened: Opened, selector: str, text: str) -> None:
    opened.wait_until(f"document.querySelector('{selector}')?.textContent.includes({text!r})")


def step_to(opened: Opened, step: int, begun: int = 0) -> None:
    for number in range(begun + 1, step + 1):
        opened.page.keyboard.press("ArrowRight")
        opened.wait_until(f"window.teamformer.last === {number}")


def test_a_mission_starts_with_a_click_and_ends(opened: Opened) -> None:
    assert opened.page.inner_text("#start") == "Start the mission"
    wait_for(opened, "#outlook", "all done at step 13")
    opened.page.click("#start")
    opened.wait_until("window.teamformer.step === 13")
    wait_for(opened, "#status", "Completed")
    wait_for(opened, "#mission h2", "Live, over")
    assert opened.page.inner_text("#outlook") == "All done at step 13."
    assert "All done at step 13." in opened.page.inner_text("#notice")


def test_what_was_worked_out_before_an_incident_is_not_shown_after_it(opened: Opened) -> None:
    page = opened.page
    step_to(opened, 4)
    wait_for(opened, "#outlook", "If nothing more happens: all done at step 13.")
    page.click("#tab-robots")
    page.click(".row >> text=r1")
    page.click("text=What would that cost?")
    wait_for(opened, "#answer", "As of step 4, with robot r1 lost: all done at step")
    page.click("text=Lose r1 …")
    page.evaluate(WATCH_OUTLOOK)
    page.click("text=Yes, lose r1")
    wait_for(opened, "#incidents", "5: robot r1 lost")
    assert page.inner_text("#answer") == ""
    wait_for(opened, "#outlook", "If nothing more happens")
    texts = page.evaluate("window.outlooks")
    assert any(text.startswith("Working out how it ends") for text in texts)
    assert "Incident in step 5: robot r1 lost." in page.inner_text("#notice")
    assert opened.details().startswith("r1\nDeselect\nLost in step 5")


WATCH_OUTLOOK = """() => {
  window.outlooks = [];
  const box = document.querySelector("#outlook");
  new MutationObserver(() => window.outlooks.push(box.textContent))
    .observe(box, { childList: true, characterData: true, subtree: true });
}"""


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
    weighed = "As of step 4, with task extra at [3, 2] that needs scan: all done at step"
    wait_for(opened, "#answer", weighed)
    page.click("text=Add task")
    wait_for(opened, "#incidents", "4: task extra at [3, 2] that needs scan")
    page.click("#tab-robots")
    page.click(".row >> text=r1")
    page.click("text=Lose r1 …")
    page.click("text=Keep it")
    page.click("text=Lose r1 …")
    assert len(served.session.mission.incidents) == 1  # the task
    page.click("text=Yes, lose r1")
    wait_for(opened, "#incidents", "5: robot r1 lost")
    wait_for(opened, "#details", "r1 is out of the mission from the next step on")
    assert page.locator("text=Lose r1").count() == 0
    step_to(opened, 6, begun=4)
    page.click("text=Bring r1 back")
    wait_for(opened, "#details", "r1 is there again from the next step on")
    wait_for(opened, "#incidents", "7: robot r1 back")
    page.keyboard.press(" ")
    wait_for(opened, "#status", "Completed")
    page.click("#mission >> text=Save")
    wait_for(opened, "#notice", "record.json")
    record = read_record(tmp_path / "out" / "record.json")
    assert judge(record).findings == ()
    assert record.mission.tasks[-1].name == "extra"
    assert record.mission.robots[0].absences == (Absence(5, 7),)
    assert page.inner_text("#figures").split("\n")[1] == "4 of 4"


def test_what_is_weighed_can_be_stopped_and_the_mission_paused_meanwhile(
    opened: Opened, served: Served, monkeypatch: pytest.MonkeyPatch
) -> None:
    def forever(now: RunningMission, incident: Incident, is_over: IsOver) -> WhatIf:
        while not is_over():
            time.sleep(0.01)
        return what_if(now, incident, is_over)

    monkeypatch.setattr("teamformer.live.session.what_if", forever)
    page = opened.page
    step_to(opened, 1)
    page.click("#tab-robots")
    page.click(".row >> text=r1")
    page.click("text=What would that cost?")
    wait_for(opened, "#answer", "Playing it ahead")
    page.keyboard.press(" ")
    opened.wait_until("window.teamformer.isPlaying")
    page.keyboard.press(" ")
    opened.wait_until("!window.teamformer.isPlaying")
    page.click("#mission >> text=Save")
    wait_for(opened, "#notice", "record.json")
    assert page.inner_text("#answer").startswith("Playing it ahead")
    page.click("#offer >> text=Stop")
    opened.wait_until("document.querySelector('#answer').textContent === ''")
    assert page.inner_text("#offer") == ""


class WrittenFirst:
    """Gives each task to the robot that is written first: in what order they are is luck."""

    def update(self, known: Known, plan: Plan | None) -> Plan:
        return Plan(known.open_tasks, (known.robots[:1],) * len(known.open_tasks))


def test_what_is_luck_is_said_to_be(browser: Any, tmp_path: Path) -> None:
    """The far robot takes 9 steps; once it is lost, the near one takes 3, from the next step on."""
    far_and_near = make([robot("a", 0), robot("a", 7)], [task("a", 9)])
    run = RunningMission(far_and_near, lambda: Method("own", coordinator=WrittenFirst()), seed=0)
    with serving_session(Session(run, tmp_path, 20.0)) as server:
        opened = Opened(browser.new_page())
        page = opened.page
        page.goto(f"http://{server.address}/")
        opened.wait_until("window.teamformer !== undefined")
        page.click("#tab-robots")
        page.click(".row >> text=r0")
        page.click("text=What would that cost?")
        wait_for(opened, "#luck", "This is luck of the search: the mission could end as soon")
        assert "steps earlier." in page.inner_text("#answer")
        assert "Other searches for plans differ by up to " in page.inner_text("#luck")
        assert page.inner_text("#offer") == ""
        page.click(".row >> text=r1")
        page.click("text=What would that cost?")
        wait_for(opened, "#luck", "Other searches")
        page.close()


def test_after_an_incident_the_page_says_what_is_so(browser: Any, tmp_path: Path) -> None:
    """Nobody is without assignment for a reason that is made up, and who is lost looks lost."""
    with serving(small_mission(), tmp_path, method="plan") as server:
        opened = Opened(browser.new_page())
        page = opened.page
        page.goto(f"http://{server.address}/")
        opened.wait_until("window.teamformer !== undefined")
        wait_for(opened, "#status", "Not started")
        wait_for(opened, "#figures", "Makespannot yet")
        assert page.locator("#speed option:checked").inner_text() == "20 steps/s"
        wait_for(opened, "#details", "3 ready to begin")
        opened.wait_until("!document.querySelector('#figures').innerText.includes('unknown')")
        step_to(opened, 3)
        wait_for(opened, "#status", "Paused")
        add_a_task(opened)
        wait_for(opened, "#details", "Is told its next task with the next step")
        assert "Why: extra appears." in opened.details()
        assert page.get_attribute("#notice-box", "class") == "notice plain"
        page.click("#tab-robots")
        page.click(".row >> text=r1")
        page.click("text=Lose r1 …")
        page.click("text=Yes, lose r1")
        wait_for(opened, "#details", "Lost")
        wait_for(opened, "#figures", "Lostr1")
        wait_for(opened, "#notice", "robot r1 lost")
        assert page.get_attribute("#notice-box", "class").strip() == "notice"
        assert "assignment" not in opened.details()
        step_to(opened, 4, begun=3)
        wait_for(opened, "#details", "Lost in step 4")
        opened.wait_until("document.querySelector('#figures').innerText.endsWith('r1')")
        assert "r1, r1" not in page.inner_text("#figures")
        opened.page.keyboard.press("Escape")
        wait_for(opened, "#details", "2 teams at step 4")
        wait_for(opened, "#details", "about to be told their next task")
        assert "without assignment" not in opened.details()
        opened.page.keyboard.press("ArrowLeft")
        wait_for(opened, "#details", "3 teams at step 3")
        assert "1 lost with the next step" in opened.details(), opened.details()
        opened.page.keyboard.press("ArrowRight")
        page.select_option("#speed", "64")
        page.keyboard.press(" ")
        wait_for(opened, "#status", "Completed")
        assert server.session.speed == 64
        assert opened.errors == []
        page.close()


def add_a_task(opened: Opened) -> None:
    """Add the task `extra`, and select the robot r2."""
    page = opened.page
    opened.click_map(page.evaluate("window.teamformer.pixelOf(3, 2)"))
    page.fill("[name='cap 1']", "1")
    page.fill("[name=title]", "extra")
    page.click("text=Add task")
    wait_for(opened, "#incidents", "3: task extra at [3, 2] that needs scan")
    page.click("#tab-robots")
    page.click(".row >> text=r2")


@pytest.mark.parametrize("method", ["plan", "crews"])
def test_the_page_says_the_method_and_only_a_plan_can_be_made_anew(
    method: str, browser: Any, tmp_path: Path
) -> None:
    with serving(small_mission(), tmp_path, method=method) as server:
        page = browser.new_page()
        page.goto(f"http://{server.address}/")
        page.wait_for_selector("#mission h2")
        assert page.inner_text("#about").startswith(f"Method {method}, seed 0, 3 robots, 3 tasks")
        assert page.locator("text=Plan anew, 10 s").is_visible() == (method == "plan")
        page.close()


@pytest.mark.parametrize(("width", "height"), [(1400, 900), (820, 1180), (390, 844)])
def test_actions_are_in_sight_beside_the_map(opened: Opened, width: int, height: int) -> None:
    opened.page.set_viewport_size({"width": width, "height": height})
    opened.wait_for_a_frame()
    floor = opened.page.locator(".transport").bounding_box()["y"]
    for name in ("New task …", "Save"):
        box = opened.page.get_by_role("button", name=name, exact=True).bounding_box()
        assert 0 <= box["x"] < width - box["width"]
        assert box["y"] + box["height"] < floor
    assert opened.page.locator("#tab-events").bounding_box()["y"] < floor
    opened.page.click("text=New task …")
    opened.wait_for_a_frame()
    floor = opened.page.locator(".transport").bounding_box()["y"]
    for field in opened.page.locator("#new-task :is(input, button)").all():
        box = field.bounding_box()
        assert 0 <= box["x"] <= width - box["width"]
        assert opened.page.locator(".side").bounding_box()["y"] <= box["y"]
        assert box["y"] + box["height"] < floor
    assert opened.page.locator("#map").bounding_box()["y"] >= 0  # it has not scrolled away


@pytest.mark.parametrize(("width", "height"), [(1400, 900), (820, 1180), (390, 844)])
def test_neither_a_notice_nor_the_start_moves_or_covers_the_map(
    opened: Opened, width: int, height: int
) -> None:
    page = opened.page
    page.set_viewport_size({"width": width, "height": height})
    wait_for(opened, "#outlook", "all done at step 13")
    opened.wait_for_a_frame()
    before = page.locator("#map").bounding_box()
    assert page.locator("#start").bounding_box()["y"] >= before["y"] + before["height"]
    step_to(opened, 1)
    opened.wait_until("document.querySelector('#start').hidden")
    page.evaluate("window.location.hash = 'robot=r1'")
    page.click("text=Lose r1 …")
    page.click("text=Yes, lose r1")
    wait_for(opened, "#notice", "Incident in step 2: robot r1 lost")
    assert page.is_visible("#notice")
    after = page.locator("#map").bounding_box()
    assert (after["width"], after["height"]) == (before["width"], before["height"])
    page.click("#notice-close")
    assert page.is_hidden("#notice")


def test_one_looks_back_while_the_mission_goes_on(opened: Opened) -> None:
    step_to(opened, 5)
    opened.page.keyboard.press("Home")
    assert opened.shown_step() == 0
    opened.page.keyboard.press(" ")
    opened.wait_until("window.teamformer.last === 13")
    assert opened.shown_step() == 0
    opened.page.keyboard.press("End")
    assert opened.shown_step() == 13


def test_a_record_beside_a_mission_under_way_stays_beside(opened: Opened, dock: Tree) -> None:
    opened.drop(json.dumps(dock))
    wait_for(opened, "#notice", "This page shows a live mission; put the record beside it")
    opened.drop(json.dumps(dock), is_beside=True)
    opened.wait_until("window.teamformer.besideSteps().length === 1")
    step_to(opened, 2)
    opened.page.click("#compared >> text=toy")
    wait_for(opened, "#notice", "A live mission stays in front")
    assert "Method toy" not in opened.page.inner_text("#about")
    step_to(opened, 4, begun=2)
    opened.wait_until("window.teamformer.besideSteps()[0] === 4")
    opened.page.click("#tab-robots")
    opened.page.click(".row >> text=r1")
    opened.page.click("text=Lose r1 …")
    opened.page.click("text=Yes, lose r1")
    opened.wait_until("document.querySelector('#incidents li')")
    assert opened.page.evaluate("window.teamformer.besideSteps()") == [4]


def test_a_task_in_a_wall_is_refused_in_the_page(opened: Opened, served: Served) -> None:
    opened.page.click("text=New task …")
    opened.page.fill("[name=x]", "5")
    opened.page.fill("[name=y]", "1")
    opened.page.fill("[name='cap 0']", "1")
    opened.page.click("text=Add task")
    wait_for(opened, "#notice", "Not done: task")
    assert "inside an obstacle; the nearest free cell is" in opened.page.inner_text("#notice")
    assert served.session.mission.incidents == []
    opened.wait_until("document.activeElement?.matches('[name=x][aria-invalid]')")
    opened.page.fill("[name='cap 0']", "0")
    opened.page.click("text=Add task")
    wait_for(opened, "#notice", "needs nothing")
    marked = "[...document.querySelectorAll('[aria-invalid]')].map(({ name }) => name)"
    assert opened.page.evaluate(marked) == ["x", "y", "cap 0", "cap 1"]  # both are wrong
    assert "task 't4'" in opened.page.inner_text("#notice")
    opened.page.fill("[name='cap 0']", "1")
    opened.page.fill("[name=x]", "2")
    opened.page.click("text=Add task")
    wait_for(opened, "#incidents", "0: task t4 at [2, 1] that needs lift")
    assert opened.page.is_hidden("#new-task")


class GivesUp(JoinFitting):
    """Joins as its parent does, and fails from its sixth decision on."""

    def __init__(self) -> None:
        self.decisions = 0

    def decide(self, view: View) -> Decision:
        self.decisions += 1
        if self.decisions > 5:
            raise TeamformerError("the policy knows no further")
        return super().decide(view)


def test_an_end_that_cannot_be_foreseen_is_not_awaited_for_ever(
    browser: Any, tmp_path: Path
) -> None:
    run = RunningMission(small_mission(), lambda: Method("gives up", policy=GivesUp()), seed=0)
    with serving_session(Session(run, tmp_path, 20.0)) as server:
        opened = Opened(browser.new_page())
        opened.page.goto(f"http://{server.address}/")
        wait_for(opened, "#outlook", "not known: the method failed when it was played ahead")
        opened.page.close()


def test_a_server_that_ends_is_told(browser: Any, tmp_path: Path) -> None:
    page = browser.new_page()
    with serving(small_mission(), tmp_path) as server:
        page.goto(f"http://{server.address}/")
        opened = Opened(page)
        opened.wait_until("window.teamformer !== undefined")
    wait_for(opened, "#mission h2", "connection lost")
    page.click("#mission >> text=Save")
    wait_for(opened, "#notice", "The server is not there; nothing was done")
    wait_for(opened, "#cut-off", "Cut off: the connection to the server was lost ")
    for width, height in ((1400, 900), (820, 1180), (390, 844)):
        page.set_viewport_size({"width": width, "height": height})
        box = page.locator("#cut-off").bounding_box()
        assert (box["x"], box["y"], box["width"]) == (0, 0, width)
        assert page.evaluate("document.body.scrollWidth") == width
        assert page.locator(".transport").bounding_box()["y"] < height
    page.close()


def kept_session(folder: Path, name: str) -> Session:
    run = RunningMission(small_mission(), lambda: load_method("join-fitting"), 0)
    autosave = Autosave(folder / "autosave.jsonl", Identity(name, Draft({})))
    return Session(run, folder, 20.0, autosave=autosave)


@pytest.mark.parametrize("name", ["the same", "another"])
def test_a_page_that_comes_to_another_mission_says_so(
    browser: Any, tmp_path: Path, name: str
) -> None:
    page = browser.new_page()
    with serving_session(kept_session(tmp_path, "the same")) as server:
        page.goto(f"http://{server.address}/")
        opened = Opened(page)
        opened.wait_until("window.teamformer !== undefined")
        wait_for(opened, "#outlook", "all done")
    opened.wait_until("!document.querySelector('#cut-off').hidden")
    with serving_session(kept_session(tmp_path, name), port=server.port):
        opened.wait_until("document.querySelector('#cut-off').hidden")
        wait_for(opened, "#outlook", "all done")
        told = "The server was restarted with another mission."
        assert (told in page.inner_text("#notice")) == (name == "another")
        if name == "another":
            assert "`teamformer live --resume` goes on with" in page.inner_text("#notice")
        page.close()


def test_a_page_whose_mission_is_gone_says_so(browser: Any, tmp_path: Path) -> None:
    page = browser.new_page()
    with serving(small_mission(), tmp_path) as server:
        page.goto(f"http://{server.address}/")
        opened = Opened(page)
        opened.wait_until("window.teamformer !== undefined")
    shop = Workshop(lambda mission: pytest.fail("started"), tmp_path, 20.0)
    with ExitStack() as stack:
        with page.expect_event("load", timeout=60_000):
            stack.enter_context(serving_session(shop, port=server.port))
        opened.wait_until("document.title === 'example, live'")
        wait_for(opened, "#notice", "The mission that was here has ended or was cut off.")
        page.close()


def test_what_is_saved_is_not_asked_about(opened: Opened) -> None:
    """Until something more is done: then it is."""
    page = opened.page
    step_to(opened, 2)
    page.click("#mission >> text=Save")
    wait_for(opened, "#notice", "record.json")
    opened.page.click("text=Restart …")
    opened.wait_until("window.teamformer.last === 0")
    step_to(opened, 1)
    page.click("#mission >> text=Save")
    wait_for(opened, "#notice", "record.json")
    step_to(opened, 2, begun=1)
    page.click("text=Restart …")
    assert "since the last save is lost" in page.inner_text("#mission .question")


def test_a_silent_server_is_no_server(browser: Any, tmp_path: Path) -> None:
    """Its process is there, and the line too, but nothing is said on it any more."""
    with serving(small_mission(), tmp_path) as server:
        page = browser.new_page()
        page.clock.install()
        page.goto(f"http://{server.address}/")
        opened = Opened(page)
        page.evaluate("() => void (window.WebSocket = class {})")  # for later lines
        page.clock.run_for(20_000)
        wait_for(opened, "#cut-off", "Cut off")
        page.close()


def test_an_incident_is_undone_in_the_page(opened: Opened, served: Served) -> None:
    page = opened.page
    step_to(opened, 2)
    lose_r1(opened)
    page.click("#incidents >> text=Undo")  # no step since: at once
    opened.wait_until("!document.querySelector('#incidents li')")
    wait_for(opened, "#notice", "Undone: robot r1 lost. The mission is back at step 2.")
    lose_r1(opened)
    step_to(opened, 4, begun=2)
    page.click("#incidents >> text=Undo")
    assert "This also undoes the 2 steps made since then." in page.inner_text("#mission")
    page.click("#mission >> text=No")
    assert served.session.mission.steps == 4
    page.click("#incidents >> text=Undo")
    page.click("text=Go back to step 2")
    opened.wait_until("window.teamformer.last === 2")
    wait_for(opened, "#outlook", "all done at step 13")
    assert served.session.mission.incidents == []
    page.click("text=Restart …")
    page.get_by_role("button", name="Restart", exact=True).click()
    opened.wait_until("window.teamformer.last === 0")
    wait_for(opened, "#notice", "The mission is back at its start; nothing has happened to it.")
    wait_for(opened, "#start-text", "Start the mission")


def test_a_task_is_called_off_in_the_page(opened: Opened, served: Served) -> None:
    page = opened.page
    step_to(opened, 2)
    name = served.session.mission.source.tasks[-1].name
    page.click("#tab-tasks")
    page.click(f".row >> text={name}")
    assert page.locator("text=Set weight").count() == 0  # the mission has no cost
    page.click("text=What would that gain?")
    wait_for(opened, "#answer", f"with task {name} called off: all done at step")
    page.click(f"text=Call {name} off …")
    page.click("text=Keep it")
    page.click(f"text=Call {name} off …")
    page.click(f"text=Yes, call {name} off")
    wait_for(opened, "#incidents", f"3: task {name} called off")
    wait_for(opened, "#details", "Called off with the next step")
    step_to(opened, 3, begun=2)
    wait_for(opened, "#details", "Called off in step 3")
    page.keyboard.press(" ")
    wait_for(opened, "#status", "Completed")
    wait_for(opened, "#figures", "2 of 3, 1 called off")
    assert page.locator("text=/^Call /").count() == 0
    assert judge(served.session.mission.record()).findings == ()


def test_a_weight_is_raised_in_the_page(browser: Any, tmp_path: Path) -> None:
    """The robot turns to the right, where the task has become the heavy one."""
    mission, out = late_pair((3.0, 1.0), cost={"tardiness": 1}), tmp_path / "out"
    with serving(mission, out, method="plan") as server, opening(browser, server) as opened:
        page = opened.page
        step_to(opened, 2)
        page.click("#tab-tasks")
        page.click(".row >> text=right")
        assert page.input_value("#details input") == "1"
        page.fill("#details input", "0")
        page.click("text=Set weight")
        wait_for(opened, "#notice", "Not done: weight must be a number from 0.001 to 1e+06")
        page.fill("#details input", "99")
        other = browser.new_page()
        other.goto(f"http://{server.address}/")
        wait_for(opened, "#mission h2", "2 pages")
        assert page.input_value("#details input") == "99"  # news does not take away what is typed
        other.close()
        page.click("text=Set weight")
        wait_for(opened, "#incidents", "2: task right has the weight 99")
        assert page.input_value("#details input") == "99"
        page.keyboard.press("Escape")
        page.keyboard.press(" ")
        wait_for(opened, "#status", "Completed")
        assert server.session.mission.ends() == {1: 9, 0: 19}


def lose_r1(opened: Opened) -> None:
    opened.page.click("#tab-robots")
    opened.page.click(".row >> text=r1")
    opened.page.click("text=Lose r1 …")
    opened.page.click("text=Yes, lose r1")
    wait_for(opened, "#incidents", "robot r1 lost")


def test_the_table_says_when_tasks_will_be_done(opened: Opened, served: Served) -> None:
    """The expected ends are those that then come; by a plan of its own, so is who is next."""
    page = opened.page
    wait_for(opened, "#outlook", "all done at step 13")
    page.click("#view-tasks")
    rows = "[...document.querySelectorAll('#stage-tasks .rows [role=row]')]"
    ends = f"{rows}.map((row) => row.children[3].textContent)"
    opened.wait_until(f"{ends}.length === 3")
    expected = page.evaluate(ends)
    assert "13" in expected
    page.keyboard.press(" ")
    wait_for(opened, "#status", "Completed")
    opened.details()
    assert page.evaluate(ends) == expected
    done = {
        it: n
        for n, step in enumerate(served.session.mission.record().steps, 1)
        for it, _ in step.done
    }
    assert expected == [str(done[task]) for task in range(3)]


def test_downloads_come_from_the_server(opened: Opened, served: Served) -> None:
    page = opened.page
    step_to(opened, 3)
    for name in FILES:
        page.click("#menu summary")
        with page.expect_download() as saved:
            page.click(f"#downloads button >> nth={FILES.index(name)}")
        assert saved.value.suggested_filename == f"small-{name}"
        assert len(saved.value.path().read_bytes()) > 200
    assert page.is_hidden("#notice")


FILES = ["mission.yaml", "record.json", "record.html", "tables.zip", "record.mcap"]
