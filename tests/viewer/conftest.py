"""A browser for the tests of the replay page, and replays to show in it."""

from __future__ import annotations

import re
import shutil
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest
from toy_replays import Tree, small_scenario, toy_replay

from teamformer.viewer.html import replay_page

Opener = Callable[..., "Opened"]


@dataclass
class Opened:
    """A page in the browser, with all that went wrong in it and all that it asked for."""

    page: Any
    errors: list[str] = field(default_factory=list)
    requests: list[str] = field(default_factory=list)

    def wait_until(self, condition: str, seconds: float = 10.0) -> None:
        """Wait for a condition in JavaScript; playwright's own way breaks the page's policy."""
        end = time.monotonic() + seconds
        while not self.page.evaluate(condition):
            assert time.monotonic() < end, f"never came true: {condition}"
            self.page.wait_for_timeout(20)

    def shown_step(self) -> int:
        """Wait until the page shows the moment it is at, and return it."""
        self.wait_until(
            "document.querySelector('#counter b')?.textContent == window.teamformer?.step"
        )
        return int(self.page.evaluate("window.teamformer.step"))

    def details(self) -> str:
        """Return the text about the selected team or task, once it is up to date."""
        self.shown_step()
        self.wait_for_a_frame()
        return re.sub(r"\n+", "\n", self.page.inner_text("#details"))

    def wait_for_a_frame(self) -> None:
        """Wait until what was to be drawn is drawn."""
        self.page.evaluate("() => new Promise((done) => requestAnimationFrame(() => done()))")

    def click_map(self, spot: dict[str, float]) -> None:
        """Click a pixel of the map."""
        self.page.locator("#map").click(position={"x": spot["x"], "y": spot["y"]})


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    """Debian's Chromium, or a skip that says what is absent."""
    api = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    chromium = shutil.which("chromium") or shutil.which("chromium-browser")
    if chromium is None:
        pytest.skip("no chromium on this machine: the page cannot be opened")
    with api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        yield browser
        browser.close()


@pytest.fixture
def open_page(browser: Any, tmp_path: Path) -> Iterator[Opener]:
    """Return what opens a replay's page from a file: `open_page(tree, "#step=3", **settings)`."""
    contexts = []

    def open_it(tree: Tree, moment: str = "", **settings: Any) -> Opened:
        path = tmp_path / f"replay-{len(contexts)}.html"
        path.write_text(replay_page(tree), encoding="utf-8")
        context = browser.new_context(viewport={"width": 1280, "height": 800}, **settings)
        contexts.append(context)
        opened = Opened(context.new_page())
        opened.page.on("pageerror", lambda error: opened.errors.append(str(error)))
        opened.page.on(
            "console",
            lambda message: message.type != "log" and opened.errors.append(message.text),
        )
        opened.page.on("request", lambda request: opened.requests.append(request.url))
        opened.page.goto(path.as_uri() + moment)
        opened.shown_step()
        opened.wait_for_a_frame()  # the map comes with the first
        return opened

    yield open_it
    for context in contexts:
        context.close()


@pytest.fixture(scope="session")
def dock() -> Tree:
    """Four robots and four tasks, 61 steps.

    Joins in 7, 22, 33, 35; splits in 8, 23, 41; r4 lost in 36; seam begun in 35, done in 40.
    """
    return toy_replay(small_scenario())
