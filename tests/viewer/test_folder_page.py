"""The page of a folder: a row for each record, sorted by a click, several side by side."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import Browser

import teamformer as tf
from teamformer.base.errors import TeamformerError
from teamformer.cli.verbs.records.view_folder import view_folder

STORM = tf.load(Path(__file__).parents[2] / "examples" / "storm.yaml")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Return a folder with three records, one of them in a folder inside, and a damaged one."""
    for name, method, seed in (("a", "crews", 0), ("b", "heuristic", 0), ("inside", "crews", 1)):
        tf.run(STORM, method=method, seed=seed).save(tmp_path / name)
    for page in tmp_path.rglob("*.html"):
        page.unlink()
    (tmp_path / "damaged.json").write_text('{"teamformer_record": 3, "meth')
    (tmp_path / "other.json").write_text("{}")
    view_folder(tmp_path)
    return tmp_path


def test_records_are_sorted_and_shown_side_by_side(browser: Browser, folder: Path) -> None:
    page = browser.new_page()
    page.goto((folder / "records.html").as_uri())
    steps = [
        tf.run(STORM, method=method, seed=seed).row["steps"]
        for method, seed in (("crews", 0), ("heuristic", 0), ("crews", 1))
    ]

    def shown_steps() -> list[str]:
        return [row.locator("td").nth(6).inner_text() for row in page.locator("tbody tr").all()[:3]]

    page.get_by_role("button", name="Steps").click()
    assert shown_steps() == [f"{number:g}" for number in sorted(steps)]
    page.get_by_role("button", name="Steps").click()
    assert shown_steps() == [f"{number:g}" for number in sorted(steps, reverse=True)]
    last = page.locator("tbody tr").last.inner_text()
    assert last.split("\t")[1:] == ["damaged.json", "1: it breaks off"]
    page.get_by_label("a/record.json").check()
    page.get_by_label("inside/record.json").check()
    frames = page.locator("iframe")
    assert frames.count() == 2
    for frame in (page.frame_locator("iframe >> nth=0"), page.frame_locator("iframe >> nth=1")):
        assert frame.locator("h1").inner_text() == STORM.name
    page.get_by_label("a/record.json").uncheck()
    assert frames.count() == 1
    page.close()


def test_newer_pages_are_left_alone(folder: Path) -> None:
    page = folder / "a" / "record.html"
    page.write_text("mine")
    view_folder(folder)
    assert page.read_text() == "mine"


def test_a_folder_without_records_is_refused(tmp_path: Path) -> None:
    with pytest.raises(TeamformerError, match="there is no record in this folder"):
        view_folder(tmp_path)
