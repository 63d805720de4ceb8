"""The page as text: safe, self-contained, whatever the names in the record."""

from __future__ import annotations

import base64
import hashlib
import json
import math
import re
from pathlib import Path
from typing import Any

import pytest
from toy_records import Tree

from teamformer.viewer.advice_page import advice_page
from teamformer.viewer.gantt import gantt_page
from teamformer.viewer.html import record_page, write_page


def embedded(page: str) -> str:
    return page.split('<script type="application/json" id="record">')[1].split("</script>")[0]


def test_the_record_comes_back_unchanged(dock: Tree) -> None:
    assert json.loads(embedded(record_page(dock))) == dock


def test_names_cannot_leave_the_json(dock: Tree) -> None:
    name = "</script><!-- <script> & \u2028 \u2029 😀"
    tree = {**dock, "method": name}
    text = embedded(record_page(tree))
    assert json.loads(text)["method"] == name
    assert not set(text) & set("<>&\u2028\u2029")


def test_the_title_is_escaped(dock: Tree) -> None:
    mission = {**dock["mission"], "name": "</title><b>x"}
    page = record_page({**dock, "mission": mission})
    assert "<title>&lt;/title&gt;&lt;b&gt;x, toy</title>" in page


def test_dollar_signs_stay_as_they_are(dock: Tree) -> None:
    page = record_page({**dock, "method": "$style ${script} $$"})
    assert json.loads(embedded(page))["method"] == "$style ${script} $$"


def test_everybody_in_sight_is_written_as_null(dock: Tree) -> None:
    mission = {**dock["mission"], "sensing_radius": math.inf}
    page = record_page({**dock, "mission": mission})
    assert json.loads(embedded(page))["mission"]["sensing_radius"] is None


def test_the_policy_allows_this_style_and_script_only(dock: Tree) -> None:
    page = record_page(dock)
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
    page = record_page(dock)
    assert not re.findall(r"https?://|url\(|@import|(?:src|href)=\"(?!data:,)", page)


def test_write_page_writes_what_record_page_returns(dock: Tree, tmp_path: Path) -> None:
    write_page(dock, tmp_path / "page.html")
    assert (tmp_path / "page.html").read_text(encoding="utf-8") == record_page(dock)


def test_a_plan_names_tasks_of_no_duration_and_keeps_the_begin_of_long_names() -> None:
    stops = [
        {"task": "load", "arrive": 1, "start": 4, "end": 9},
        {"task": "look", "arrive": 12, "start": 12, "end": 12},
        {"task": "hidden", "arrive": 12.1, "start": 12.1, "end": 12.1},
        {"task": "end", "arrive": 12.2, "start": 12.2, "end": 20},
    ]
    route = {"robot": "a-van-with-a-long-name", "stops": stops, "back": 20}
    plan = {"mission": "s", "makespan": 20, "bound": 0, "proven": False, "late": {}}
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
    plan = {"mission": "s", "makespan": 20, "bound": 0, "proven": False, "late": {}}
    page = browser.new_page(viewport={"width": 390, "height": 844})
    page.set_content(gantt_page({**plan, "routes": [route]}))
    page.locator(".times").evaluate("(times) => (times.scrollLeft = 500)")
    assert page.locator(".times").evaluate("(times) => times.scrollLeft") == 500
    box = page.locator("svg text[data-robot=van]").bounding_box()
    assert box["x"] >= 0
    assert box["x"] + box["width"] < page.locator(".times").bounding_box()["x"]
    page.close()


LATE_PLAN = {
    **{"mission": "yard", "makespan": 20, "bound": 0, "proven": False, "critical_path": []},
    **{"late": {"=seam": 2}, "windows": {"=seam": [1, 7]}},
    "routes": [
        {
            **{"robot": "van", "back": 20},
            "stops": [
                {"task": "load", "arrive": 1, "start": 1, "end": 3},
                {"task": "=seam", "arrive": 4, "start": 5, "end": 9},
            ],
        },
        {
            **{"robot": "arm", "back": 9},
            "stops": [{"task": "=seam", "arrive": 5, "start": 5, "end": 9}],
        },
    ],
}


@pytest.mark.parametrize("width", [1400, 820, 390])
def test_the_page_of_a_plan_tells_all_of_what_is_chosen(
    browser: Any, tmp_path: Path, width: int
) -> None:
    (tmp_path / "plan.html").write_text(gantt_page(LATE_PLAN), encoding="utf-8")
    page = browser.new_page(viewport={"width": width, "height": 844})
    errors: list[str] = []
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.on("console", lambda message: errors.append(message.text))
    page.goto((tmp_path / "plan.html").as_uri() + "#task=%3Dseam")
    told = "van there at 4, arm there at 5, from 5 to 9, to be done between 1 and 7, late by 2"
    assert page.inner_text("#said") == f"=seam: {told}"
    assert page.locator("g.task.now").count() == 2
    rows = [row.locator("td").all_inner_texts() for row in page.locator("tbody tr").all()]
    assert rows == [
        ["load", "van", "1", "3", "", ""],
        ["=seam", "van, arm", "5", "9", "1 to 7", "2"],
    ]
    page.click("tbody >> text=load")
    assert page.evaluate("location.hash") == "#task=load"
    page.locator(".chart text >> text=van").click()
    assert page.inner_text("#said") == "van: load from 1 to 3, =seam from 5 to 9, back at 20"
    assert page.evaluate("location.hash") == "#robot=van"
    with page.expect_download() as saved:
        page.click("text=Save as CSV")
    assert saved.value.suggested_filename == "yard-plan.csv"
    assert saved.value.path().read_text().splitlines() == [
        "robot,task,there,begin,end,not_before,due,late_by",
        "van,load,1,1,3,,,",
        "van,'=seam,4,5,9,1,7,2",
        "arm,'=seam,5,5,9,1,7,2",
    ]
    assert page.evaluate("document.documentElement.scrollWidth") == width
    assert errors == []
    page.close()


@pytest.mark.parametrize("width", [1400, 820, 390])
def test_the_page_of_advice_fits_every_screen(browser: Any, width: int) -> None:
    """6 is won, and a loss of 30 ends at the edge: zero is at 9 of 15 parts of each row."""
    rows = [
        {"change": change, "makespan": 56 - gain, "gain": gain, "noise": 1}
        for change, gain in [("one more robot like camel " * 4, 6), ("without robot camel", -30)]
    ]
    advice = {
        **{"mission": "warehouse", "method": "plan", "measure": "makespan", "makespan": 56},
        **{"range": [56, 57], "searches": 21, "advice": rows, "impossible": [], "unmeasured": []},
    }
    page = browser.new_page(viewport={"width": width, "height": 844})
    page.set_content(advice_page(advice))
    assert page.evaluate("document.documentElement.scrollWidth") == width
    row = page.locator(".bar >> nth=1").bounding_box()
    won, lost = (page.locator(looks).bounding_box() for looks in (".wins", ".loses"))
    assert won["x"] == pytest.approx(row["x"] + 0.6 * row["width"], abs=1)
    assert won["x"] + won["width"] == pytest.approx(row["x"] + row["width"], abs=1)
    assert (lost["x"], lost["width"]) == pytest.approx((row["x"], 0.6 * row["width"]), abs=1)
    assert row["width"] > 0.4 * width
    for name in page.locator(".what").all():
        box = name.bounding_box()
        assert box["x"] >= 0
        assert box["x"] + box["width"] <= width
    page.close()


def test_the_page_of_a_plan_frames_what_the_end_hangs_on() -> None:
    """From 0 to 4 robot a's row, from 4 to 20 robot b's, with a line between the rows at 4."""
    routes = [{"robot": robot, "stops": [], "back": 20} for robot in "ab"]
    plan = {"mission": "s", "makespan": 20, "bound": 0, "proven": False, "late": {}}
    path = [
        {"from": begin, "to": end, "doing": "walking", "robot": robot, "task": "t"}
        for begin, end, robot in [(0, 3, "a"), (3, 4, "a"), (4, 20, "b")]
    ]
    text = gantt_page({**plan, "routes": routes, "critical_path": path})
    frames = re.findall(r'rect class="path" x="(.*?)" y="(.*?)" width="(.*?)"', text)
    assert frames == [("110.0", "35.0", "220.0"), ("330.0", "61.0", "880.0")]
    assert re.findall(r'<path class="path" d="(.*?)"', text) == ["M330.0 47.0V73.0"]
    assert "orange" in text
