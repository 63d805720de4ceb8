"""`teamformer train`: stopped and gone on with, and folders that it refuses."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from teamformer.commands.train import TrainOptions, train
from teamformer.errors import TeamformerError
from teamformer.train.checkpoint import ABOUT, WEIGHTS, read_about

SHORT = ("--worlds", "4", "--held-out", "1", "--seed", "5")


def start(*words: str) -> subprocess.Popen[str]:
    """Start a training in a process of its own."""
    return subprocess.Popen(
        [sys.executable, "-m", "teamformer.cli", "train", *words],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
    )


def iterations(folder: Path) -> int:
    done = read_about(folder / "last")["progress"]["iteration"]
    assert isinstance(done, int)
    return done


@pytest.mark.parametrize(
    "how", [pytest.param(signal.SIGINT, marks=pytest.mark.slow), signal.SIGTERM]
)
def test_a_training_that_was_stopped_ends_as_if_it_had_not_been(
    how: signal.Signals, tmp_path: Path
) -> None:
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    start("--out", str(whole), "--iterations", "4", *SHORT).communicate(timeout=200)
    stopped = start("--out", str(parts), "--iterations", "4", *SHORT)
    assert stopped.stdout is not None
    stopped.stdout.readline()  # the header
    stopped.stdout.readline()  # an iteration
    stopped.send_signal(how)
    _, told = stopped.communicate(timeout=60)
    assert stopped.returncode == 1
    assert f"teamformer train --resume {parts}" in told
    assert "Traceback" not in told
    assert 1 <= iterations(parts) < 4
    _, told = start("--resume", str(parts), "--held-out", "1").communicate(timeout=200)
    assert f"the policy is in {parts}" in told
    assert iterations(parts) == iterations(whole) == 4
    kept = (parts / "last" / WEIGHTS).read_bytes(), (whole / "last" / WEIGHTS).read_bytes()
    assert kept[0] == kept[1]


def refused(capsys: pytest.CaptureFixture[str], *words: str) -> str:
    """Return what is told of a mistake."""
    from teamformer import cli

    argv, sys.argv = sys.argv, ["teamformer", "train", *words]
    try:
        with pytest.raises(SystemExit) as stop:
            cli.main()
    finally:
        sys.argv = argv
    assert stop.value.code == 2
    return capsys.readouterr().err


def test_what_cannot_be_resumed_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    missing, empty = str(tmp_path / "missing"), str(tmp_path)
    assert f"{missing}: there is no such folder" in refused(capsys, "--resume", missing)
    assert f"it has no {ABOUT}" in refused(capsys, "--resume", empty)
    assert "leave --seed out" in refused(capsys, "--resume", empty, "--seed", "1")
    (tmp_path / "last").mkdir()
    (tmp_path / "last" / ABOUT).write_text('{"format": 2, "settings": {"network": "any"}}')
    assert "its settings cannot be read" in refused(capsys, "--resume", empty)
    (tmp_path / "last" / ABOUT).write_text('{"format": 99}')
    assert "checkpoint format 99" in refused(capsys, "--resume", empty)


def test_a_folder_with_other_files_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "thesis.tex").write_text("mine")
    with pytest.raises(TeamformerError, match=r"thesis\.tex for example") as error:
        train(TrainOptions(folder=tmp_path), as_json=False)
    assert "--out" in error.value.hint
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.tex"]
