"""The page in a real browser: what it shows, how it is steered, and that it stays by itself."""

from __future__ import annotations

import copy
from typing import Any

import pytest
from toy_records import Tree, random_mission, small_mission, toy_record

from browsers import Opener


def test_it_loads_without_errors_and_asks_for_nothing(open_page: Opener, dock: Tree) -> None:
    opened = open_page(dock)
    opened.page.keyboard.press("End")
    opened.shown_step()
    assert opened.errors == []
    assert [url.split(":")[0] for url in opened.requests] == ["file"]  # the page itself


def test_its_own_policy_forbids_every_connection(open_page: Opener, dock: Tree) -> None:
    page = open_page(dock).page
    refused = "fetch('data:,x').then(() => 'went through', () => 'refused')"
    assert page.evaluate(refused) == "refused"


def test_keys_move_through_the_steps(open_page: Opener, dock: Tree) -> None:
    opened = open_page(dock)
    visited = []
    for key in ["ArrowRight", "ArrowRight", "ArrowLeft", "]", "]", "[", "End", "Home"]:
        opened.page.keyboard.press(key)
        visited.append(opened.shown_step())
    assert visited == [1, 2, 1, 7, 8, 7, 61, 0]


def test_space_plays_to_the_end_and_stops_there(open_page: Opener, dock: Tree) -> None:
    opened = open_page(dock, "#step=55")
    for _ in range(9):
        opened.page.keyboard.press("+")
    assert opened.page.input_value("#speed") == "64"
    opened.page.keyboard.press(" ")
    opened.wait_until("window.teamformer.step === 61 && !window.teamformer.isPlaying")
    assert opened.shown_step() == 61


def test_space_on_a_button_presses_it_only(open_page: Opener, dock: Tree) -> None:
    opened = open_page(dock)
    opened.page.focus("#step-on")
    opened.page.keyboard.press(" ")
    assert opened.shown_step() == 1
    assert opened.page.evaluate("window.teamformer.isPlaying") is False


def test_scrubbing_to_the_end_shows_the_makespan(open_page: Opener, dock: Tree) -> None:
    opened = open_page(dock)
    opened.page.fill("#scrub", "61")
    assert opened.shown_step() == 61
    assert "completed, makespan 61" in opened.page.inner_text("#rows")
    figures = opened.page.inner_text("#figures").split("\n")
    assert figures == [
        "Tasks done",
        "4 of 4",
        "Makespan",
        "61 1.27 x the bound",
        "Lower bound",
        "48",
        "Lost",
        "r4",
    ]
    assert opened.page.inner_text("#status") == "Completed"


def test_a_click_on_a_team_says_what_it_waits_for(open_page: Opener, dock: Tree) -> None:
    opened = open_page(dock, "#step=33")
    opened.click_map(opened.page.evaluate("window.teamformer.robotSpot(2)"))
    text = opened.details()
    assert "Team r2 of 2 robots" in text
    assert "Waits at seam for lift" in text
    assert "r1 brings it and is 1 cell away" in text
    assert "r3 joins r2" in text  # its history


def test_the_header_says_the_method(open_page: Opener, dock: Tree) -> None:
    opened = open_page(dock)
    assert opened.page.inner_text("#about").startswith("Method toy, seed 0, ")


def test_a_click_on_a_task_says_who_comes(open_page: Opener, dock: Tree) -> None:
    opened = open_page(dock, "#step=10")
    opened.click_map(opened.page.evaluate("window.teamformer.taskBox(2)"))
    text = opened.details()
    assert text.startswith("seam")
    assert "At [16, 5], takes 5 steps, number 2 in the order" in text
    assert "lift\nnobody assigned brings it; r1, r4 could" in text
    assert "r3 is 9 cells away, brings weld" in text  # 14 right, 4 up, 1 left: 19, of which 10 made


def test_details_show_notes(open_page: Opener, dock: Tree) -> None:
    mission = dock["mission"]
    robots, tasks = copy.deepcopy(mission["robots"]), copy.deepcopy(mission["tasks"])
    robots[1]["note"], tasks[2]["note"] = "leaks <b>oil</b>", "door 3"
    noted = dock | {"mission": mission | {"robots": robots, "tasks": tasks}}
    opened = open_page(noted, "#step=10&robot=r2")
    assert "Note: leaks <b>oil</b>" in opened.details()
    opened.click_map(opened.page.evaluate("window.teamformer.taskBox(2)"))
    assert "Note: door 3" in opened.details()


def test_a_click_on_nothing_closes_the_details(open_page: Opener, dock: Tree) -> None:
    opened = open_page(dock, "#step=10&task=seam")
    assert opened.details().startswith("seam")
    opened.click_map({"x": 5, "y": 5})
    assert opened.details().startswith("4 teams at step 10")


def test_the_selection_follows_its_robot_through_joins_and_splits(
    open_page: Opener, dock: Tree
) -> None:
    opened = open_page(dock, "#step=6&robot=r2")
    titles = []
    for key in ["ArrowRight", "ArrowRight"]:
        opened.page.keyboard.press(key)
        titles.append(opened.details().split("\n")[0])
    assert titles == ["Team r1 of 2 robots", "r2"]


def test_a_team_at_work_says_how_far_it_is(open_page: Opener, dock: Tree) -> None:
    assert "Does seam, 3 of 5 steps made" in open_page(dock, "#step=38&robot=r3").details()


def test_a_capability_says_who_brings_it_and_what_needs_it(open_page: Opener, dock: Tree) -> None:
    opened = open_page(dock, "#step=10")
    opened.page.click("#legend >> text=lift")
    assert opened.details().split("\n")[:3] == ["L", "lift", "Deselect"]
    assert "2 robots, needed by 2 open tasks" in opened.details()  # pallet and seam
    opened.page.fill("#scrub", "36")  # r4, the other one, is lost
    assert "1 robot, needed by 1 open task" in opened.details()


def test_a_lost_robot_stays_as_such(open_page: Opener, dock: Tree) -> None:
    assert "Lost in step 36" in open_page(dock, "#step=40&robot=r4").details()


def test_a_late_task_is_not_there_before_it_appears(open_page: Opener, dock: Tree) -> None:
    opened = open_page(dock, "#step=19&task=late%20load")
    assert "Appears after step 20" in opened.details()
    spot = opened.page.evaluate("window.teamformer.taskBox(3)")
    opened.click_map(spot)
    assert opened.details().startswith("4 teams at step 19")
    opened.page.keyboard.press("ArrowRight")
    opened.shown_step()
    opened.click_map(spot)
    assert opened.details().startswith("late load")


PIXEL = """([x, y]) => {
  const canvas = document.getElementById("map");
  const sharpness = canvas.width / canvas.clientWidth;
  const at = [Math.round(x * sharpness), Math.round(y * sharpness)];
  return [...canvas.getContext("2d").getImageData(...at, 1, 1).data];
}"""
COLOUR = """(colour) => {
  const ctx = new OffscreenCanvas(1, 1).getContext("2d");
  ctx.fillStyle = colour;
  ctx.fillRect(0, 0, 1, 1);
  return [...ctx.getImageData(0, 0, 1, 1).data];
}"""


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_the_ring_takes_the_task_colour_when_all_is_there(
    open_page: Opener, dock: Tree, scheme: str
) -> None:
    opened = open_page(dock, "#step=33", color_scheme=scheme)
    page = opened.page
    task = page.evaluate("window.teamformer.taskColour(2)")
    assert team_at(page, slot=1)["ring"] != task  # lacks lift
    page.keyboard.press("ArrowRight")
    page.keyboard.press("ArrowRight")
    assert opened.shown_step() == 35
    opened.details()
    team = team_at(page, slot=0)
    assert (team["robots"], team["task"], team["ring"]) == ([0, 1, 2], 2, task)
    spot = page.evaluate("window.teamformer.robotSpot(1)")
    drawn = page.evaluate(PIXEL, [spot["x"] - 0.85 * spot["r"], spot["y"]])
    wanted = page.evaluate(COLOUR, task)
    assert max(abs(a - b) for a, b in zip(drawn, wanted, strict=True)) <= 12


def team_at(page: Any, slot: int) -> dict[str, Any]:
    return next(team for team in page.evaluate("window.teamformer.teams()") if team["slot"] == slot)


def test_the_team_that_has_just_done_a_task_shows_its_colour(open_page: Opener, dock: Tree) -> None:
    opened = open_page(dock, "#step=7")
    team = team_at(opened.page, slot=0)
    assert team["ring"] == opened.page.evaluate("window.teamformer.taskColour(0)")
    assert team["doing"] == "has just done crate-7"


def test_hostile_names_are_only_text(open_page: Opener) -> None:
    evil = '</script><img src=x onerror="window.hacked=1"><script>window.hacked=1</script>'
    mission = copy.deepcopy(small_mission())
    mission["name"] = evil
    mission["capabilities"][0] = evil + "c"
    for robot in mission["robots"]:
        robot["can"] = [evil + "c" if cap == "lift" else cap for cap in robot["can"]]
        robot["name"] += evil
    for task in mission["tasks"]:
        task["needs"] = [evil + "c" if cap == "lift" else cap for cap in task["needs"]]
        task["name"] += evil
    opened = open_page(toy_record(mission, method=evil), "#step=33")
    for tab in ["tasks", "teams", "capabilities", "events"]:
        opened.page.click(f"#tab-{tab}")
        opened.details()
    opened.click_map(opened.page.evaluate("window.teamformer.robotSpot(2)"))
    assert f"Waits at seam{evil} for {evil}c" in opened.details()
    spot = opened.page.evaluate("window.teamformer.robotSpot(0)")
    opened.page.locator("#map").hover(position={"x": spot["x"], "y": spot["y"]})
    assert evil in opened.page.inner_text("#tip")
    assert opened.page.inner_text("#name") == evil
    assert opened.page.evaluate("window.hacked") is None
    assert opened.page.locator("img").count() == 0
    assert opened.errors == []


def test_lists_lead_to_places_and_can_be_filtered(open_page: Opener, dock: Tree) -> None:
    opened = open_page(dock)
    opened.page.click("text=r4 is lost")
    assert opened.shown_step() == 36
    assert "Lost in step 36" in opened.details()
    opened.page.click("#tab-tasks")
    opened.page.fill("#filter", "PAL")
    assert opened.page.locator(".row").all_inner_texts() == ["pallet\ndone in step 22"]
    opened.page.click(".row")
    assert opened.details().startswith("pallet")


def test_a_click_counts_though_the_list_is_made_anew_meanwhile(
    open_page: Opener, dock: Tree
) -> None:
    opened = open_page(dock)
    page = opened.page
    page.click("#tab-tasks")
    page.locator(".row", has_text="pallet").hover()
    page.mouse.down()
    page.keyboard.press("ArrowRight")
    assert not opened.details().startswith("pallet")
    page.mouse.up()
    assert opened.details().startswith("pallet")
    assert opened.shown_step() == 1


def test_a_trial_that_cannot_end_says_why(open_page: Opener, dock: Tree) -> None:
    end = {**dock["end"], "status": "infeasible", "makespan": None, "blocked_tasks": ["late load"]}
    tree = {**dock, "steps": dock["steps"][:50], "end": end, "lower_bound": None}
    opened = open_page(tree, "#step=50&task=late%20load")
    assert opened.page.inner_text("#status") == "Infeasible"
    assert "Can never be done: late load." in opened.page.inner_text("#notice")
    assert "Can never be done" in opened.details()
    assert opened.page.inner_text("#figures").split("\n")[2:] == [
        "Makespan", "none", "Lower bound", "unknown", "Lost", "r4",
    ]  # fmt: skip


def test_a_trial_interrupted_before_its_first_step_can_be_shown(
    open_page: Opener, dock: Tree
) -> None:
    end = {**dock["end"], "status": "interrupted", "makespan": None}
    opened = open_page({**dock, "steps": [], "end": end})
    for key in [" ", "ArrowRight", "End"]:
        opened.page.keyboard.press(key)
    assert opened.shown_step() == 0
    assert opened.page.inner_text("#status") == "Interrupted"
    assert opened.errors == []


@pytest.mark.parametrize("width", [768, 1024, 1600])
def test_nothing_sticks_out_sideways(open_page: Opener, dock: Tree, width: int) -> None:
    opened = open_page(dock, "#robot=r1")
    opened.page.set_viewport_size({"width": width, "height": 900})
    opened.details()
    sideways = "document.documentElement.scrollWidth - document.documentElement.clientWidth"
    assert opened.page.evaluate(sideways) == 0
    box = opened.page.locator("#map").bounding_box()
    assert box["width"] >= 440
    assert box["height"] >= 320


def test_a_hundred_robots_play_without_errors(open_page: Opener) -> None:
    tree = toy_record(random_mission(100, 20, 100, 20, 30))
    opened = open_page(tree, "#step=40")
    assert opened.page.inner_text("#legend") == "100 capabilities"
    for switch in ["lines", "trails", "order", "names"]:
        opened.page.click(f"#{switch}")
    opened.page.keyboard.press(" ")
    opened.wait_until("window.teamformer.step > 45")
    opened.page.click("#legend button")
    opened.page.fill("#filter", "c77")
    assert opened.page.locator(".row").count() == 1
    assert opened.errors == []


def test_still_pictures_for_those_who_want_no_motion(open_page: Opener, dock: Tree) -> None:
    """Robots stand in as many places as there are steps, in however many frames."""
    opened = open_page(dock, reduced_motion="reduce")
    opened.page.keyboard.press("-")
    opened.page.keyboard.press(" ")
    seen = opened.page.evaluate("""() => new Promise((done) => {
      const seen = new Set();
      const look = () => {
        const spots = [0, 1, 2, 3].map((robot) => window.teamformer.robotSpot(robot));
        seen.add(JSON.stringify(spots));
        if (window.teamformer.step < 3) requestAnimationFrame(look);
        else done([...seen].length);
      };
      look();
    })""")
    assert 3 <= seen <= 4
