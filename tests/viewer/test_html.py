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
