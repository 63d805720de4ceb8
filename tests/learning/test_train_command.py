"""`teamformer train`: stopped and gone on with, and folders that it refuses."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from teamformer.base.errors import TeamformerError
from teamformer.cli.verbs.policies.train import TrainOptions, _begun, train
from teamformer.learning.checkpoint import ABOUT, WEIGHTS, TrainingProgress, load, read_about, save
from teamformer.learning.trainer import _described, make_learner
from teamformer.learning.trainer import train as train_on
from teamformer.learning.training_settings import TrainSettings
from typed import teamformer


def short(folder: Path, text: str = "") -> str:
    """Write settings of a short training into a folder and return their file's name."""
    path = folder / "short.yaml"
    path.write_text(f"worlds: 4\nheld_out: 1\nseed: 5\n{text}")
    return str(path)


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


@pytest.mark.slow
@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM])
def test_a_training_that_was_stopped_ends_as_if_it_had_not_been(
    how: signal.Signals, tmp_path: Path
) -> None:
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    settings = short(tmp_path, "iterations: 4")
    start(settings, "--out", str(whole)).communicate(timeout=200)
    stopped = start(settings, "--out", str(parts))
    assert stopped.stdout is not None
    stopped.stdout.readline()  # the header
    stopped.stdout.readline()  # an iteration
    stopped.send_signal(how)
    _, told = stopped.communicate(timeout=60)
    assert stopped.returncode == 1
    assert f"teamformer train {parts}" in told
    assert "Traceback" not in told
    assert 1 <= iterations(parts) < 4
    _, told = start(str(parts)).communicate(timeout=200)
    assert f"the policy is in {parts}" in told
    assert iterations(parts) == iterations(whole) == 4
    kept = (parts / "last" / WEIGHTS).read_bytes(), (whole / "last" / WEIGHTS).read_bytes()
    assert kept[0] == kept[1]
    if how == signal.SIGINT:
        _, told = start(str(parts)).communicate(timeout=200)
        assert "there is no time left for an iteration" in told


def test_going_on_for_no_time_changes_nothing(tmp_path: Path) -> None:
    settings = TrainSettings(worlds=2, held_out=3, iterations=2, evaluate_every=9)
    learner = make_learner(settings)
    save(
        tmp_path / "last", learner, _described(settings), TrainingProgress(iteration=1, seconds=5.0)
    )
    before = {path.name: path.read_bytes() for path in (tmp_path / "last").iterdir()}
    resumed, folder = _begun(TrainOptions(str(tmp_path), minutes=0.0))
    assert (resumed, folder) == (replace(settings, minutes=0.0), tmp_path)
    trained = train_on(resumed, tmp_path, held_out=())  # an exam of no worlds would fail
    assert {path.name: path.read_bytes() for path in (tmp_path / "last").iterdir()} == before
    assert trained is not learner


def test_a_training_of_no_time_keeps_nothing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert train(TrainOptions(short(tmp_path), tmp_path / "new", minutes=0.0)) == 1
    assert "no iteration was made; nothing is kept" in capsys.readouterr().err
    assert not (tmp_path / "new" / "last").exists()


def test_another_exam_is_another_training(tmp_path: Path) -> None:
    settings = TrainSettings(held_out=3)
    learner = make_learner(settings)
    save(tmp_path, learner, _described(settings), TrainingProgress())
    with pytest.raises(TeamformerError, match="holds another training") as error:
        load(tmp_path, learner, _described(replace(settings, held_out=4)))
    assert error.value.hint == "other settings: held_out; use the same or another folder"
    older = {k: v for k, v in _described(settings).items() if k != "held_out"}
    save(tmp_path, learner, older, TrainingProgress(iteration=4))
    assert load(tmp_path, learner, _described(settings)).iteration == 4


def refused(capsys: pytest.CaptureFixture[str], *words: str) -> str:
    """Return what is told of a mistake."""
    assert teamformer("train", *words) == 2
    return capsys.readouterr().err


def test_what_cannot_be_resumed_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    missing, empty = str(tmp_path / "missing"), str(tmp_path)
    assert "there are no settings" in refused(capsys, missing)
    assert f"it has no {ABOUT}" in refused(capsys, empty)
    assert "leave --seed out" in refused(capsys, empty, "--seed", "1")
    assert "leave --out out" in refused(capsys, "--out", empty, empty)
    assert "or one of deepset-c4" in refused(capsys)
    (tmp_path / "last").mkdir()
    (tmp_path / "last" / ABOUT).write_text('{"format": 2, "settings": {"network": 3}}')
    assert "its settings cannot be read" in refused(capsys, empty)
    (tmp_path / "last" / ABOUT).write_text('{"format": 99}')
    assert "checkpoint format 99" in refused(capsys, empty)


def test_a_folder_with_other_files_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "thesis.tex").write_text("mine")
    with pytest.raises(TeamformerError, match=r"thesis\.tex for example") as error:
        train(TrainOptions("teamformer", tmp_path))
    assert "--out" in error.value.hint
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.tex"]
