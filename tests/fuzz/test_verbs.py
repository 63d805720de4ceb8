"""What people type does what it is asked, or says why not: never a traceback."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any
from unittest.mock import patch

import pytest
import typer
from hypothesis import strategies as st

import teamformer.cli
from methods import METHODS
from missions import SEEDS, continuous_missions, missions
from teamformer.cli.app import app
from texts import text_of
from watching import fuzzed

DONE, NOT_DONE = 0, 1
"""Exit statuses: 2 would say that the person made a mistake."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("verbs")


VERBS = typer.main.get_command(app)
"""All verbs with their flags, which takes a while to put together."""


def typed(*words: object) -> int:
    """Return the exit status of a command line, run in this process."""
    told = patch.object(sys, "argv", ["teamformer", *map(str, words)])
    with told, patch.object(teamformer.cli, "app", VERBS):
        return teamformer.cli._run_verb()


@fuzzed(
    12,
    "run FILE --method {method} --seed {seed} --out O, then check, export and view",
    mission=missions(),
    method=METHODS,
    seed=SEEDS,
)
def test_a_good_file_is_run_checked_and_shown(
    mission: Any, method: str, seed: int, folder: Path
) -> None:
    file, record = folder / "mission.yaml", folder / "out" / "record.json"
    file.write_text(text_of(mission), encoding="utf-8")
    words = ("run", file, "--method", method, "--seed", seed)
    robot = mission["robots"][0].get("name", "r1")
    explained = () if "count" in mission["robots"][0] else (f"--explain={robot}",)
    assert typed(*words, *explained, "--out", record.parent) in (DONE, NOT_DONE)
    assert typed("check", record) == DONE
    (folder / "a.yaml").unlink(missing_ok=True)  # a mission is not written over
    assert typed("export", record, folder / "csv", folder / "a.yaml") == DONE
    assert typed("check", record, "--mission", folder / "a.yaml") == DONE
    assert typed("view", record, folder / "page.html") == DONE


@fuzzed(3, "compare FILE --seeds 2 --time-limit 0.05", mission=missions())
def test_a_good_file_is_compared(mission: Any, folder: Path) -> None:
    file = folder / "mission.yaml"
    file.write_text(text_of(mission), encoding="utf-8")
    words = ("--methods", "join-all,teamformer,central", "--seeds", 2, "--time-limit", 0.05)
    assert typed("compare", file, *words) in (DONE, NOT_DONE)


@fuzzed(
    8,
    "plan FILE --method {method} --time-limit 0.05",
    mission=continuous_missions(),
    method=st.sampled_from(["plan", "central"]),
)
def test_a_good_file_is_planned(mission: Any, method: str, folder: Path) -> None:
    file = folder / "mission.yaml"
    file.write_text(text_of(mission), encoding="utf-8")
    is_linked = any("starts" in task for task in mission["tasks"])
    words = ("--method", method, "--time-limit", 0.05, "--out", folder)
    assert typed("plan", file, *words) in (DONE, 2 if is_linked else DONE)


@fuzzed(3, "plan FILE --time-limit 0.05", mission=missions(has_cancelled=False))
def test_a_good_file_in_steps_is_planned(mission: Any, folder: Path) -> None:
    file = folder / "mission.yaml"
    file.write_text(text_of(mission), encoding="utf-8")
    assert typed("plan", file, "--time-limit", 0.05, "--json") in (DONE, NOT_DONE)


@fuzzed(4, "advise FILE PAGE", mission=st.one_of(missions(), continuous_missions()))
def test_advice_on_a_good_file_is_given(mission: Any, folder: Path) -> None:
    """Or refused, if the mission is not completed as it is."""
    file, page = folder / "mission.yaml", folder / "advice.html"
    page.unlink(missing_ok=True)
    file.write_text(text_of(mission), encoding="utf-8")
    status = typed("advise", file, page, "--time-limit", 0.1)
    assert status in (DONE, 2)
    assert page.exists() == (status == DONE)
