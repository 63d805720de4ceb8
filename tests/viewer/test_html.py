"""The page as text: safe, self-contained, whatever the names in the replay."""

from __future__ import annotations

import base64
import hashlib
import json
import math
import re
from pathlib import Path
from typing import Any

from toy_replays import Tree

from teamformer.viewer.gantt import gantt_page
from teamformer.viewer.html import replay_page, write_page


def embedded(page: str) -> str:
    return page.split('<script type="application/json" id="replay">')[1].split("</script>")[0]


def test_the_replay_comes_back_unchanged(dock: Tree) -> None:
    assert json.loads(embedded(replay_page(dock))) == dock


def test_names_cannot_leave_the_json(dock: Tree) -> None:
    name = "</script><!-- <script> & \u2028 \u2029 😀"
    tree = {**dock, "method": name}
    text = embedded(replay_page(tree))
    assert json.loads(text)["method"] == name
    assert not set(text) & set("<>&\u2028\u2029")


def test_the_title_is_escaped(dock: Tree) -> None:
    scenario = {**dock["scenario"], "name": "</title><b>x"}
    page = replay_page({**dock, "scenario": scenario})
    assert "<title>&lt;/title&gt;&lt;b&gt;x, toy</title>" in page


def test_dollar_signs_stay_as_they_are(dock: Tree) -> None:
    page = replay_page({**dock, "method": "$style ${script} $$"})
    assert json.loads(embedded(page))["method"] == "$style ${script} $$"


def test_everybody_in_sight_is_written_as_null(dock: Tree) -> None:
    scenario = {**dock["scenario"], "sensing_radius": math.inf}
    page = replay_page({**dock, "scenario": scenario})
    assert json.loads(embedded(page))["scenario"]["sensing_radius"] is None


def test_the_policy_allows_this_style_and_script_only(dock: Tree) -> None:
    page = replay_page(dock)
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', page)
    assert policy is not None
    for tag in (r"<style>(.*?)</style>", r'<script type="module">(.*?)</script>'):
        text = re.search(tag, page, re.DOTALL)
        assert text is not None
        digest = base64.b64encode(hashlib.sha256(text[1].encode()).digest()).decode()
        assert f"'sha256-{digest}'" in policy[1]
    assert "default-src 'none'" in policy[1]
    assert "unsafe" not in policy[1]


def test_the_page_names_no_other_place(dock: Tree) -> None:
    page = replay_page(dock)
    assert not re.findall(r"https?://|url\(|@import|(?:src|href)=\"(?!data:,)", page)


def test_write_page_writes_what_replay_page_returns(dock: Tree, tmp_path: Path) -> None:
    write_page(dock, tmp_path / "page.html")
    assert (tmp_path / "page.html").read_text(encoding="utf-8") == replay_page(dock)


def test_a_plan_names_tasks_of_no_duration_and_keeps_the_begin_of_long_names() -> None:
    stops = [
        {"task": "load", "arrive": 1, "start": 4, "end": 9},
        {"task": "look", "arrive": 12, "start": 12, "end": 12},
        {"task": "hidden", "arrive": 12.1, "start": 12.1, "end": 12.1},
        {"task": "end", "arrive": 12.2, "start": 12.2, "end": 20},
    ]
    route = {"robot": "a-van-with-a-long-name", "stops": stops, "back": 20}
    plan = {"scenario": "s", "makespan": 20, "bound": 0, "proven": False, "late": {}}
    text = gantt_page({**plan, "routes": [route, {"robot": "b", "stops": [], "back": 0}]})
    assert "<title>a-van-with-a-long-name</title>a-van-with-a-l…</text>" in text
    beside = re.findall(r'class="beside" .*?>(.*?)</text>', text)
    assert beside == []  # the next tasks are too near
    later = [stops[0], stops[1], {"task": "end", "arrive": 18, "start": 18, "end": 20}]
    text = gantt_page({**plan, "routes": [route | {"stops": later}]})
    assert re.findall(r'class="beside" .*?>(.*?)</text>', text) == ["look"]


def test_names_of_a_plan_stay_while_its_time_scrolls(browser: Any) -> None:
    stops = [{"task": "load", "arrive": 1, "start": 4, "end": 9}]
    route = {"robot": "van", "stops": stops, "back": 20}
    plan = {"scenario": "s", "makespan": 20, "bound": 0, "proven": False, "late": {}}
    page = browser.new_page(viewport={"width": 390, "height": 844})
    page.set_content(gantt_page({**plan, "routes": [route]}))
    page.locator(".times").evaluate("(times) => (times.scrollLeft = 500)")
    assert page.locator(".times").evaluate("(times) => times.scrollLeft") == 500
    box = page.get_by_text("van", exact=True).bounding_box()
    assert box["x"] >= 0
    assert box["x"] + box["width"] < page.locator(".times").bounding_box()["x"]
    page.close()


def test_the_page_of_a_plan_frames_what_the_end_hangs_on() -> None:
    """From 0 to 4 robot a's row, from 4 to 20 robot b's, with a line between the rows at 4."""
    routes = [{"robot": robot, "stops": [], "back": 20} for robot in "ab"]
    plan = {"scenario": "s", "makespan": 20, "bound": 0, "proven": False, "late": {}}
    path = [
        {"from": begin, "to": end, "doing": "walking", "robot": robot, "task": "t"}
        for begin, end, robot in [(0, 3, "a"), (3, 4, "a"), (4, 20, "b")]
    ]
    text = gantt_page({**plan, "routes": routes, "critical_path": path})
    frames = re.findall(r'rect class="path" x="(.*?)" y="(.*?)" width="(.*?)"', text)
    assert frames == [("110.0", "35.0", "220.0"), ("330.0", "61.0", "880.0")]
    assert re.findall(r'<path class="path" d="(.*?)"', text) == ["M330.0 47.0V73.0"]
    assert "orange" in text
