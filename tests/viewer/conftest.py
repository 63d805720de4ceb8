"""Record pages in a browser, and records to show in them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from toy_records import Tree, small_mission, toy_record

from browsers import Opened, Opener
from teamformer.viewer.html import record_page


@pytest.fixture
def open_page(browser: Any, tmp_path: Path) -> Iterator[Opener]:
    """Return what opens a record's page from a file: `open_page(tree, "#step=3", **settings)`."""
    contexts = []

    def open_it(
        tree: Any, moment: str = "", written: Callable[[Any], str] = record_page, **settings: Any
    ) -> Opened:
        path = tmp_path / f"record-{len(contexts)}.html"
        path.write_text(written(tree), encoding="utf-8")
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
    return toy_record(small_mission())
