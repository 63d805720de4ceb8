"""What a record tells of itself is on the page as it stands there, read whole or step by step."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from browsers import Opener
from random_worlds import random_world, with_precedence_and_windows, with_surprises
from small_worlds import make, robot, task
from teamformer.files.mission_files import read_mission
from teamformer.methods.by_name import load_method
from teamformer.mission.model import Mission
from teamformer.record.export.moments import moments
from teamformer.record.files.writing import record_to_tree
from teamformer.record.record import Record
from teamformer.record.teams import Teams
from teamformer.record.telling.latest import LatestTold
from teamformer.record.telling.whole import told_of
from teamformer.record.told.trees import news_to_tree
from teamformer.trials.trial import run_trial
from teamformer.viewer.modules import joined
from teamformer.world.rules.constants import NOBODY

EXAMPLES = Path(__file__).parents[2] / "examples"


def drawn(seed: int) -> Mission:
    """Return a random mission: planes, links and surprises among them."""
    rng = np.random.default_rng(seed + 1000)
    mission = random_world(rng, is_plane=seed % 3 == 0)
    mission = with_precedence_and_windows(mission, rng) if seed % 2 else mission
    return with_surprises(mission, rng) if seed % 5 == 0 else mission


RECORDS = {
    **{name: (EXAMPLES / f"{name}.yaml", "plan") for name in ("warehouse", "piano", "breakdown")},
    **{f"drawn {seed}": (seed, method) for seed, method in enumerate(("plan", "crews") * 3)},
    **{f"drawn {seed}": (seed, "teamformer") for seed in (10, 15)},
}


@pytest.fixture(scope="module", params=RECORDS)
def record(request: Any) -> Record:
    source, method = RECORDS[request.param]
    mission = drawn(source) if isinstance(source, int) else read_mission(source)
    return run_trial(mission, load_method(method)).record


@pytest.fixture(scope="module")
def scripts(browser: Any) -> Iterator[Any]:
    page = browser.new_page()
    page.add_script_tag(content=joined("record/words"))
    yield page
    page.close()


READ = """(tree) => {
  const history = frames(tree);
  const robots = [...history.mission.robots.keys()];
  const steps = [...tree.steps.keys()];
  return {
    runs: robots.map((robot) => runsOf(history, robot).map(({from, to, phase, task}) => [from, to, phase, task])),
    why: robots.map((robot) => steps.map((step) => reasonFor(history, robot, step))),
    services: history.told.rows.map(({task, doing, from, to, began}) => [task, doing, from, to, began]),
    path: history.told.path.map(({from, to, doing, robot, task}) => [from, to, doing, robot, task]),
    heads: steps.map((step) => history.at(step + 1)).map(({team, task}) => robots.map((robot) => task[team[robot]] ?? -1)),
    sites: [0, ...steps.map((step) => step + 1)].map((step) =>
      sitesAt(history, step).map(({at, isUp}) => isUp ? "up" : at)),
  };
}"""  # noqa: E501


def test_the_page_has_what_is_told(scripts: Any, record: Record) -> None:
    told, robots = told_of(record), range(len(record.mission.robots))
    read = scripts.evaluate(READ, record_to_tree(record))
    for number in robots:
        steps = [
            (run.phase, run.task)
            for end, run in told.runs_of(number)
            for _ in range(run.begun, end)
        ]
        runs = [(phase, about, len([*same])) for (phase, about), same in groupby(steps)]
        shown = read["runs"][number]
        assert [(phase, about, to - since) for since, to, phase, about in shown] == runs
    for number in robots:
        reasons = [
            "; ".join(told.texts[text] for text in run.why)
            for end, run in told.reasoned_runs_of(number)
            for _ in range(run.begun, end)
        ]
        before = ["", *reasons]
        assert read["why"][number] == [of or was for of, was in zip(reasons, before, strict=False)]
    assert read["services"] == [[*s[:4], [*s.begun_by]] for s in told.services]
    assert read["heads"] == list(_heads(record))
    assert read["path"] == [[s.begin, s.end, s.doing, s.robot, s.task] for s in told.path]


def _heads(record: Record) -> Iterator[list[int]]:
    """Yield what each robot heads for after each step."""
    teams = Teams(record.mission.robots, record.start)
    for step in record.steps:
        teams.follow(step)
        yield [teams.task.get(slot, NOBODY) for slot in teams.slot]


def test_loads_are_where_the_tables_have_them(scripts: Any, record: Record) -> None:
    read = scripts.evaluate(READ, record_to_tree(record))
    for moment, sites in zip(moments(record), read["sites"], strict=True):
        for number, (at, where) in enumerate(zip(moment.task_at, sites, strict=True)):
            if record.mission.tasks[number].to and where != "up":
                assert list(at) == where, moment.step


STEP_BY_STEP = """([tree, whole, news]) => {
  const steps = tree.steps;
  const one = frames(whole);
  const other = frames({...tree, steps: [], told: undefined, end: {...tree.end, status: "running"}});
  steps.forEach((step, number) => other.grow(step, news[number], number + 1 < steps.length ? undefined : tree.end));
  const kept = ({told, events, moves, doneAt, doers}) => {
    for (const event of events) delete event.text;
    const {rows, phases, texts} = told;
    return JSON.stringify({rows, phases, texts, events, moves, doneAt, doers});
  };
  return kept(one) === kept(other);
}"""  # noqa: E501


def test_step_by_step_it_comes_to_the_same(scripts: Any, record: Record) -> None:
    tree, latest = record_to_tree(record), LatestTold()
    news = [
        news_to_tree(latest.of(replace(record, steps=record.steps[: number + 1])))
        for number in range(len(record.steps))
    ]
    assert scripts.evaluate(STEP_BY_STEP, [tree, tree, news])


def test_the_gantt_view_frames_the_critical_path(open_page: Opener) -> None:
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
    assert "critical path" in opened.page.inner_text("#phases")
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
