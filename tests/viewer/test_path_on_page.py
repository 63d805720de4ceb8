"""The critical path on the page: the same as in Python, framed in the Gantt view."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from browsers import Opener
from random_worlds import random_world, with_precedence_and_windows, with_surprises
from small_worlds import make, robot, task
from teamformer.methods.by_name import load_method
from teamformer.record.files.writing import record_to_tree
from teamformer.record.telling.whole import path_of_record
from teamformer.trials.trial import run_trial
from teamformer.viewer.modules import joined


@pytest.fixture(scope="module")
def scripts(browser: Any) -> Iterator[Any]:
    page = browser.new_page()
    page.add_script_tag(content=joined("record/critical_path"))
    yield page
    page.close()


PATH = """(tree) => criticalPath(frames(tree)).map(
  ({from, to, doing, robot, task}) => [from, to, doing, robot, task])"""


@pytest.mark.parametrize("method", ["plan", "crews", "heuristic", "join-all", "teamformer"])
def test_the_page_finds_the_same_path(scripts: Any, method: str) -> None:
    lengths = []
    for seed in range(15):
        rng = np.random.default_rng(seed + 1000)
        mission = random_world(rng, is_plane=seed % 3 == 0)
        mission = with_precedence_and_windows(mission, rng) if seed % 2 else mission
        mission = with_surprises(mission, rng) if seed % 5 == 0 else mission
        record = run_trial(mission, load_method(method), seed).record
        path = path_of_record(record)
        shown = scripts.evaluate(PATH, record_to_tree(record))
        assert shown == [[s.begin, s.end, s.doing, s.robot, s.task] for s in path], seed
        lengths.append(len(path))
    assert sum(lengths) > 15


def test_the_gantt_view_frames_it(open_page: Opener) -> None:
    """Robot b walks 9 to where a waits; then they form and serve: its bars are framed, not a's."""
    mission = make([robot("a", 0), robot("b", 11)], [task("ab", 2, duration=3)])
    record = run_trial(replace(mission, name="two"), load_method("plan")).record
    opened = open_page(record_to_tree(record), "#view=gantt")
    opened.details()
    path = opened.page.evaluate("window.teamformer.criticalPath()")
    assert [(it["from"], it["to"], it["robot"]) for it in path] == [
        (0, 9, 1),
        (9, 10, 1),
        (10, 13, 1),
    ]
    assert "what the end hangs on" in opened.page.inner_text("#phases")
    assert opened.errors == []
    row = opened.page.evaluate("window.teamformer.bars(1)")
    middle = (row["bars"][0]["left"] + row["bars"][0]["right"]) / 2
    frame, beside = (
        opened.page.evaluate(PIXEL, [middle, 24 + number * row["rowHeight"] + 1])
        for number in (1, 0)
    )
    ink = opened.page.evaluate(INK)
    assert frame == ink
    assert beside != ink


PIXEL = """([x, y]) => {
  const canvas = document.querySelector("#gantt"), sharpness = window.devicePixelRatio;
  return [...canvas.getContext("2d").getImageData(x * sharpness, y * sharpness, 1, 1).data];
}"""
INK = """() => {
  const ctx = document.createElement("canvas").getContext("2d");
  ctx.fillStyle = getComputedStyle(document.body).getPropertyValue("--ink").trim();
  ctx.fillRect(0, 0, 1, 1);
  return [...ctx.getImageData(0, 0, 1, 1).data];
}"""
