"""What breaks a promise is kept as a file, once a run."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import watching
from teamformer.files.mission_files import read_mission

MISSION = {
    "teamformer": 1,
    "world": {"rows": "..\n.@"},
    "capabilities": ["a"],
    "robots": [{"at": [0, 0], "can": ["a"]}],
    "tasks": [{"at": [1, 0], "needs": ["a"]}],
}


def breaks(mission: Any, seed: int) -> None:
    watching.noted["forged"] = [seed]
    if seed > 3:
        raise ValueError(f"seed {seed} is 'too' large")


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a folder for findings, of a run that has not found anything and does not end."""
    monkeypatch.setenv(watching.FOLDER, str(tmp_path))
    for name in (watching.KNOWN, watching.UNTIL):
        monkeypatch.delenv(name, raising=False)
    return tmp_path


def broken(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_an_example_that_fails_is_kept_as_small_as_it_gets(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    watched = watching._watched(breaks, "run FILE --seed {seed}")
    drawn = given(mission=st.just(MISSION), seed=st.integers(0, 999))(watched)
    with pytest.raises(ValueError, match="seed 4"):
        settings(max_examples=50, database=None)(drawn)()
    [name] = broken(folder)
    head, *told = (folder / name).read_text().splitlines()[:3]
    assert head == "# teamformer run FILE --seed 4: ValueError: seed 4 is 'too' large"
    assert told == ["# seed = 4", "# forged = [4]"]
    assert read_mission(folder / name).world.rows == ("..", ".@")

    monkeypatch.setenv(watching.KNOWN, name)  # the next round
    watched(mission=MISSION, seed=77)
    assert broken(folder) == [name]


def test_the_example_that_is_tried_is_a_file_while_it_is(folder: Path) -> None:
    seen = []

    def looks(mission: Any) -> None:
        seen.append((folder / watching.RUNNING).read_text().splitlines()[0])

    watching._watched(looks, "run FILE")(mission=MISSION)
    assert seen == ["# teamformer run FILE: it ends the process"]
    assert broken(folder) == []


def test_another_failure_of_the_same_promise_is_another_file(folder: Path) -> None:
    def fails(mission: Any, what: str) -> None:
        raise AssertionError(what)

    for what in (
        "task 't1' is lost",
        "task 'x' is lost",
        "step 3 is missing",
        "step 14 is missing",
    ):
        with pytest.raises(AssertionError):
            watching._watched(fails, "run FILE")(mission=MISSION, what=what)
    assert len(broken(folder)) == 2
