"""Files are read, or refused with a message; what is written is read back."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import strategies as st

from edits import edited_texts, edited_trees
from methods import DEFAULT, play
from missions import SEEDS, continuous_missions, missions
from plain_times import Ways, times_of
from teamformer.base.errors import TeamformerError
from teamformer.files.mission_files import mission_from_tree, read_mission, write_mission
from teamformer.mission.checks.rules import rules_not_played
from teamformer.mission.model import Mission
from teamformer.planning.continuous.continuous_mission import pose_mission
from teamformer.planning.continuous.rules import plan_continuous
from teamformer.record.referee import judge
from texts import text_of
from watching import fuzzed

ALL = st.one_of(missions(), continuous_missions())
LONGEST = 450
"""Letters of a line that a person is told."""

MOST = 400
"""Robots times tasks, and cells, of missions that are still small after an edit."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("files")


def is_told(read: Callable[[], Mission], source: str) -> Mission | None:
    """Return what is read, or None where a person is told what is wrong."""
    try:
        return read()
    except TeamformerError as error:
        lines = str(error).splitlines()
        assert lines
        assert all(line.startswith(source) and len(line) < LONGEST for line in lines), lines
        assert all(line.isprintable() for line in lines), lines
        return None


@fuzzed(50, "run FILE --seed {seed}", mission=edited_trees(), seed=SEEDS)
def test_an_edited_file_is_refused_or_can_be_done(mission: Any, seed: int) -> None:
    source = is_told(lambda: mission_from_tree(mission), "mission: ")
    if source is None or not is_small(source):
        return
    source = replace(source, step_limit=min(source.step_limit, 40))
    if source.time == "steps" and not list(rules_not_played(source)):
        assert not judge(play(source, DEFAULT, seed).record).findings
    elif source.time == "continuous":
        can_be_done(source)


def is_small(mission: Mission) -> bool:
    """Say whether an edited mission can be done in a moment."""
    world, arrivals = mission.world, mission.arrivals
    tasks = len(mission.tasks) + (arrivals.until if arrivals else 0)
    looks = max(task.within for task in mission.tasks) / getattr(world, "unit", 1)
    cells = 0 if hasattr(world, "step") else world.width * world.height
    return len(mission.robots) * tasks <= MOST and cells <= MOST and looks <= 10


def can_be_done(mission: Mission) -> None:
    """Plan a mission in continuous time, unless a person is told why that cannot be."""
    try:
        made = plan_continuous(pose_mission(mission), "plan", 0.0)
    except TeamformerError:
        return
    assert made is not None
    times = times_of(mission, [[s.task for s in r.stops] for r in made.routes], Ways(mission))
    assert times is not None
    assert math.isfinite(times.makespan)


@fuzzed(30, "run FILE", damaged=edited_texts(ALL.map(text_of)))
def test_a_damaged_file_is_refused_or_read(damaged: bytes, folder: Path) -> None:
    path = folder / "damaged.yaml"
    path.write_bytes(damaged)
    is_told(lambda: read_mission(path), str(path))


@fuzzed(20, "run FILE", mission=ALL)
def test_what_is_written_is_read_back(mission: Any, folder: Path) -> None:
    source = mission_from_tree(mission)
    (folder / "unnamed.yaml").write_text(text_of(mission), encoding="utf-8")
    assert read_mission(folder / "unnamed.yaml") == source
    for name in ("written.yaml", "written.json"):
        write_mission(source, folder / name)
        assert read_mission(folder / name) == source


@fuzzed(20, "run FILE", mission=ALL)
def test_the_order_of_keys_means_nothing(mission: Any) -> None:
    assert mission_from_tree(turned(mission)) == mission_from_tree(mission)


def turned(tree: Any) -> Any:
    """Return a tree with the keys of every mapping in the other order."""
    if isinstance(tree, dict):
        return {key: turned(tree[key]) for key in reversed(tree)}
    return [turned(part) for part in tree] if isinstance(tree, list) else tree


@fuzzed(20, "run FILE", mission=missions())
def test_a_map_in_another_file_is_the_map_in_this_one(mission: Any, folder: Path) -> None:
    source = mission_from_tree(mission)
    if not source.world.rows:
        return
    rows = source.world.rows
    header = f"type octile\nheight {len(rows)}\nwidth {len(rows[0])}\nmap\n"
    (folder / "cells.map").write_text(header + "\n".join(rows) + "\n")
    (folder / "unnamed.yaml").write_text(text_of(mission | {"world": {"map": "cells.map"}}))
    same = replace(source.world, y_axis="down", frame=None)
    assert read_mission(folder / "unnamed.yaml") == replace(source, world=same)
    pixels = "\n".join(" ".join("255" if c == "." else "0" for c in row) for row in rows[::-1])
    (folder / "cells.pgm").write_text(f"P2\n{len(rows[0])} {len(rows)}\n255\n{pixels}\n")
    told = "image: cells.pgm\nresolution: 0.5\norigin: [0, 0, 0]\nnegate: 0\n"
    (folder / "cells.yaml").write_text(told + "occupied_thresh: 0.65\nfree_thresh: 0.196\n")
    (folder / "unnamed.yaml").write_text(text_of(mission | {"world": {"map": "cells.yaml"}}))
    assert read_mission(folder / "unnamed.yaml").world.rows == rows
