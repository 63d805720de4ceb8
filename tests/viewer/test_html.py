"""The page as text: safe, self-contained, whatever the names in the replay."""

from __future__ import annotations

import base64
import hashlib
import json
import math
import re
from pathlib import Path

from toy_replays import Tree

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
