"""Every page judged by axe-core, in light and dark: nothing serious is found."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from toy_records import Tree, random_mission, toy_record

from browsers import Opened, Opener
from live_server import serving, serving_editor, small_mission
from teamformer.viewer.html import comparison_page

axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason="axe is not installed")

SERIOUS = ("serious", "critical")


def findings(page: Any) -> list[str]:
    """Return what axe takes for serious: the rule, and the elements."""
    results = axe.Axe().run(page).response
    return [
        f"{found['id']}: {[node['html'][:120] for node in found['nodes'][:3]]}"
        for found in results["violations"]
        if found["impact"] in SERIOUS
    ]


@pytest.fixture(params=["light", "dark"])
def scheme(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture
def new_page(browser: Any, scheme: str) -> Iterator[Any]:
    context = browser.new_context(viewport={"width": 1280, "height": 800}, color_scheme=scheme)
    yield context.new_page
    context.close()


@pytest.mark.parametrize("view", ["map", "gantt", "tasks", "robots", "plots"])
def test_pages_of_records(view: str, scheme: str, open_page: Opener, dock: Tree) -> None:
    page = open_page(dock, f"#step=33&robot=r4&view={view}", color_scheme=scheme).page
    assert findings(page) == []


@pytest.mark.parametrize("view", ["map", "gantt", "tasks", "plots"])
def test_pages_of_several_records(view: str, scheme: str, open_page: Opener, dock: Tree) -> None:
    def written(trees: list[Tree]) -> str:
        return comparison_page(trees, [{"method": "central", "seed": 0, "why": "too large"}])

    trees = [dock, {**dock, "method": "same"}]
    settings: Any = {"written": written, "color_scheme": scheme}
    opened = open_page(trees, f"#step=33&robot=r4&view={view}", **settings)
    opened.details()
    assert opened.page.is_visible("#compared table")
    assert findings(opened.page) == []


def test_lists_menu_and_help_of_a_record(scheme: str, open_page: Opener, dock: Tree) -> None:
    page = open_page(dock, "#step=20&task=seam", color_scheme=scheme).page
    for tab in ("tasks", "teams", "robots", "capabilities"):
        page.click(f"#tab-{tab}")
        assert findings(page) == []
    page.click("#menu summary")
    assert findings(page) == []
    page.click("#help")
    assert findings(page) == []


def test_pages_of_many(scheme: str, open_page: Opener) -> None:
    tree = toy_record(random_mission(60, 20, 12, 20, 3), steps=30)
    opened = open_page(tree, "#step=9&view=tasks", color_scheme=scheme)
    opened.page.click("role=columnheader >> text=State")
    assert findings(opened.page) == []


def test_live_pages(new_page: Any, tmp_path: Path) -> None:
    with serving(small_mission(), tmp_path, method="plan") as server:
        page = new_page()
        opened = Opened(page)
        page.goto(f"http://{server.address}/")
        opened.wait_until("window.teamformer !== undefined")
        opened.wait_until("document.querySelector('#outlook')?.textContent")
        assert findings(page) == []
        page.keyboard.press("ArrowRight")
        opened.wait_until("window.teamformer.last === 1")
        page.click("text=New task …")
        assert findings(page) == []
        page.click("#new-task >> text=Cancel")
        page.click("#tab-robots")
        page.click(".row >> text=r1")
        page.click("text=Lose r1 …")
        page.click("text=Yes, lose r1")
        opened.wait_until("document.querySelector('#incidents li')")
        page.click("text=Restart …")
        assert findings(page) == []
        page.click("#view-tasks")
        opened.wait_until("document.querySelector('#stage-tasks [role=cell]')")
        assert findings(page) == []


def test_the_editor(new_page: Any, tmp_path: Path) -> None:
    with serving_editor(tmp_path) as server:
        page = new_page()
        opened = Opened(page)
        page.goto(f"http://{server.address}/")
        opened.wait_until("window.teamformer !== undefined")
        page.click("[data-tool=robot]")
        opened.click_map(page.evaluate("window.teamformer.pixelOf(3, 3)"))
        assert findings(page) == []
        page.get_by_role("button", name="New", exact=True).click()
        opened.wait_until("document.querySelector('#problems .hint')")
        assert findings(page) == []
