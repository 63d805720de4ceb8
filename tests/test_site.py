"""The site of the documents: every page is in it, it builds, and what it is made from is true."""

from __future__ import annotations

import inspect
import json
import re
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest
import yaml

import teamformer as tf
from notebooks import NOTEBOOKS
from teamformer.world.view import View

ROOT = Path(__file__).parent.parent
DOCS = ROOT / "docs"


def test_every_page_is_in_the_navigation() -> None:
    settings = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
    listed = re.findall(r"^ +- .*: ([\w/-]+\.md)$", settings, re.MULTILINE)
    pages = [path.relative_to(DOCS).as_posix() for path in DOCS.rglob("*.md")]
    pages += [f"notebooks/{path.stem}.md" for path in NOTEBOOKS]  # made by docs/making/hooks.py
    assert sorted(listed) == sorted(pages)


def test_pages_that_the_code_names_are_there() -> None:
    named = set()
    for folder in ("src", "tests", "examples"):
        for path in (ROOT / folder).rglob("*"):
            if path.suffix in (".py", ".md", ".yaml", ".ipynb"):
                named |= set(re.findall(r"docs/[\w/-]+\.md", path.read_text(encoding="utf-8")))
    assert len(named) > 5
    assert [page for page in named if not (ROOT / page).is_file()] == []


def test_views_are_as_their_comments_say() -> None:
    """The reference shows these comments: axes and kinds of numbers of each field."""
    told = re.findall(r"^    (\w+): Array  # \(([^)]*)\) (\w+)", inspect.getsource(View), re.M)
    assert [name for name, _, _ in told] == list(View._fields)
    mission = tf.load(ROOT / "examples" / "storm.yaml")
    view = tf.TeamFormation([mission]).view()
    sizes = {"teams": len(mission.robots), "teams + 1": len(mission.robots) + 1, "2": 2}
    sizes |= {"caps": len(mission.capabilities), "members": len(mission.robots)}
    for name, axes, kind in told:
        array = getattr(view, name)
        assert array.dtype.name == kind, name
        assert array.ndim == len([axis for axis in axes.split(",") if axis]), name
        for axis, length in zip(axes.split(","), array.shape, strict=False):
            assert sizes.get(axis.strip(), length) == length, (name, axis)


def test_the_reference_has_every_name() -> None:
    page = (DOCS / "reference" / "python.md").read_text(encoding="utf-8")
    shown = set(re.findall(r"^::: teamformer\.([\w.]+)\.(\w+)$", page, re.MULTILINE))
    homes = {tuple(home.replace(":", ".").rsplit(".", 1)) for home in tf._HOMES.values()}
    assert homes - shown == {("world.view", "View")}  # which has a page of its own
    assert "::: teamformer.world.view.View" in (DOCS / "reference" / "view.md").read_text()


@pytest.mark.skipif(find_spec("mkdocs") is None, reason="no mkdocs: install the extra `docs`")
@pytest.mark.thorough
def test_the_site_builds_without_a_warning(tmp_path: Path) -> None:
    """And its search knows names of the API, verbs and headings of pages."""
    words = [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(tmp_path)]
    built = subprocess.run(words, cwd=ROOT, capture_output=True, text=True)
    assert built.returncode == 0, built.stderr
    index = json.loads((tmp_path / "search" / "search_index.json").read_text(encoding="utf-8"))
    titles = {entry["title"] for entry in index["docs"]}
    assert {"teamformer fleet rehearse", "task_may_need", "Looking first"} <= titles
    named = {title.split("<")[0].strip() for title in titles}
    assert {home.rpartition(":")[2] for home in tf._HOMES.values()} - named <= {"View"}
    assert yaml.safe_load((tmp_path / "examples" / "warehouse.yaml").read_text())["teamformer"] == 1
    comparing = (tmp_path / "notebooks" / "2-comparing.html").read_text(encoding="utf-8")
    printed = re.search(r"heuristic +takes \+[\d.]+ ± [\d.]+ steps more than plan", comparing)
    assert printed is not None
    assert 'href="../examples/notebooks/2-comparing.ipynb"' in comparing
