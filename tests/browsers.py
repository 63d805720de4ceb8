"""A browser for the tests of pages, and pages in it."""

from __future__ import annotations

import re
import shutil
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import pytest


@dataclass
class Opened:
    """A page in the browser, with all that went wrong in it and all that it asked for."""

    page: Any
    errors: list[str] = field(default_factory=list)
    requests: list[str] = field(default_factory=list)

    def wait_until(self, condition: str, seconds: float = 60.0) -> None:
        """Wait for a condition in JavaScript; playwright's own way breaks the page's policy."""
        end = time.monotonic() + seconds
        while not self.page.evaluate(condition):
            assert time.monotonic() < end, f"never came true: {condition}"
            self.page.wait_for_timeout(20)

    def shown_step(self) -> int:
        """Wait until the page shows the moment it is at, and return it."""
        self.wait_until(
            "document.querySelector('#counter b')?.textContent == window.teamformer?.moment"
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

    def drop(self, text: str, is_beside: bool = False) -> None:
        """Drop a file with this text on the left half of the page, or on the right."""
        part = 0.9 if is_beside else 0.1
        self.page.evaluate(DROP, [text, part])

    def click_map(self, spot: dict[str, float]) -> None:
        """Click a pixel of the map."""
        self.page.locator("#map").click(position={"x": spot["x"], "y": spot["y"]})


DROP = """([text, part]) => {
  const data = new DataTransfer();
  data.items.add(new File([text], "dropped.json"));
  const clientX = part * innerWidth;
  const event = { dataTransfer: data, clientX, bubbles: true, cancelable: true };
  document.body.dispatchEvent(new DragEvent("dragover", event));
  document.body.dispatchEvent(new DragEvent("drop", event));
}"""

Opener = Callable[..., Opened]
"""Opens a page; the first argument says which."""


@contextmanager
def chromium() -> Iterator[Any]:
    """Debian's Chromium, or a skip that says what is absent."""
    api = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    path = shutil.which("chromium") or shutil.which("chromium-browser")
    if path is None:
        pytest.skip("no chromium on this machine: the page cannot be opened")
    with api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=["--no-sandbox"])
        yield browser
        browser.close()
