"""Compiling is said wherever it happens, kept where that can be, and done by one process."""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from types import FunctionType
from typing import Any

import numba as nb
import pytest

import teamformer
from teamformer.base.kernels import announcing, compiler, files, turns
from teamformer.base.kernels.announcing import QUIET, WAITING, Announcer
from teamformer.base.kernels.clock import compiling_seconds
from teamformer.base.kernels.jit import entry, needs_compiling
from teamformer.base.kernels.turns import turn
from test_jit import answer_kernel

KEPT = "compiling kernels, on the first run only (a minute, more if busy) ...\n"


@pytest.fixture(autouse=True)
def _kept_elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing is kept at first, and nothing has been said."""
    monkeypatch.setattr(nb.config, "CACHE_DIR", str(tmp_path / "kept"))
    monkeypatch.setattr(compiler, "ANNOUNCER", Announcer())
    monkeypatch.setattr(announcing, "_now", lambda: 1000.0)


def test_compiling_is_said_and_taking_what_is_kept_is_not(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert answer_kernel(tmp_path / "oracle.py", 1)() == 1
    assert capsys.readouterr().err == KEPT
    assert answer_kernel(tmp_path / "oracle.py", 1)() == 1
    assert capsys.readouterr().err == ""


def test_it_is_said_once_for_each_part_and_again_after_a_pause(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    now, announcer = [1000.0], Announcer()
    monkeypatch.setattr(announcing, "_now", lambda: now[0])

    def compile_for(module: str, seconds: float) -> str:
        announcer.begin(f"teamformer.{module}", is_kept=True)
        now[0] += seconds
        announcer.end()
        return capsys.readouterr().err

    assert "the planner" in compile_for("planning.search.annealing", 60)
    assert "the simulator" in compile_for("world.step", 30)
    assert compile_for("planning.crews.deal", 30) == ""
    now[0] += announcing.PAUSE
    assert compile_for("planning.crews.deal", 30) == ""
    now[0] += announcing.PAUSE + 1
    assert "the planner" in compile_for("planning.continuous.schedule", 15)


@pytest.mark.parametrize("is_quiet", [False, True])
def test_a_call_that_takes_long_says_so_and_a_quick_one_does_not(
    is_quiet: bool, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    is_said = threading.Event()

    class Noted(Announcer):
        def say(self, text: str) -> None:
            super().say(text)
            is_said.set()

    monkeypatch.setattr(announcing, "ANNOUNCER", Noted())
    if is_quiet:
        monkeypatch.setenv(QUIET, "1")

    @announcing.says_if_long
    def plan(number: int, is_long: bool = True) -> int:
        assert not is_long or is_said.wait(60)
        return number

    assert plan(1, is_long=False) == 1
    assert capsys.readouterr().err == ""
    monkeypatch.setattr(announcing, "LONG", 0.01)
    assert plan(2) == 2
    said = "teamformer.plan is at work; it takes more than 0.01 seconds ...\n"
    assert capsys.readouterr().err == ("" if is_quiet else said)


def test_every_function_that_python_offers_says_so() -> None:
    offered = [getattr(teamformer, name) for name in teamformer.__all__]
    functions = [one for one in offered if isinstance(one, FunctionType)]
    assert {one.__name__ for one in functions} >= {"run", "plan", "compare", "advise"}
    assert all(hasattr(one, "__wrapped__") for one in functions)


def test_a_variable_of_the_environment_has_nothing_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv(QUIET, "1")
    assert answer_kernel(tmp_path / "oracle.py", 1)() == 1
    assert capsys.readouterr().err == ""


def test_where_nothing_can_be_kept_it_is_said_what_to_set(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(files, "_can_write", lambda folder: False)
    for _ in range(2):
        assert answer_kernel(tmp_path / "oracle.py", 1)() == 1
    said = capsys.readouterr().err
    assert "at every run, as there is no folder to keep it in" in said
    assert "set NUMBA_CACHE_DIR to a folder that you may write to" in said
    assert list(tmp_path.rglob("*.nbc")) == []


def test_what_lies_where_nothing_can_be_written_is_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As in a container: compiled when it was built, and nobody may write when it runs."""
    monkeypatch.setattr(nb.config, "CACHE_DIR", "")
    assert answer_kernel(tmp_path / "oracle.py", 1)() == 1
    [kept] = (tmp_path / "__pycache__").glob("*.nbc")
    compiled = compiling_seconds()
    for can_write in (lambda folder: False, lambda folder: folder.parent != tmp_path):
        monkeypatch.setattr(files, "_can_write", can_write)
        again = answer_kernel(tmp_path / "oracle.py", 1)
        assert not needs_compiling(again)
        assert again() == 1
    assert compiling_seconds() == compiled
    assert [*tmp_path.rglob("*.nbc")] == [kept]


def test_a_folder_that_nobody_can_make_cannot_be_written(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    assert not files._can_write(tmp_path / "file" / "folder")
    assert files._can_write(tmp_path / "new" / "folder")


def test_a_folder_that_the_user_names_is_the_only_one(tmp_path: Path) -> None:
    """Else a wheel would be built without what has been compiled in the sources' folders."""
    code = answer_kernel(tmp_path / "oracle.py", 1).files
    assert code.home.parent == tmp_path / "kept"
    assert list(code._folders()) == [code.home]


CALL = "import sys; sys.path.insert(0, '.'); from oracle import reply; print(reply())"


@pytest.mark.thorough
def test_python_that_optimises_leaves_what_is_kept_without_it(tmp_path: Path) -> None:
    """An `assert` is not compiled there; each finds its own file again."""
    (tmp_path / "oracle.py").write_text(
        "from teamformer.base.kernels.jit import entry\n\n\n@entry\ndef reply():\n"
        '    """Return a number."""\n    assert True\n    return 42\n'
    )
    told = []
    for level in ("", "2", "1", "", "2", "1"):
        done = subprocess.run(
            [sys.executable, "-c", CALL],
            cwd=tmp_path,
            capture_output=True,
            text=True,
            check=True,
            env={
                **os.environ,
                "PYTHONOPTIMIZE": level,
                "NUMBA_CACHE_DIR": str(tmp_path / "kept"),
                "PYTHONPATH": os.pathsep.join(sys.path),
            },
        )
        assert done.stdout == "42\n"
        told.append(done.stderr)
    assert told == [KEPT, KEPT, KEPT, "", "", ""]


def test_what_another_process_compiles_is_waited_for_and_taken(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """When the turn comes, the other has put its file in place."""
    assert answer_kernel(tmp_path / "oracle.py", 1)() == 1
    [kept] = (tmp_path / "kept").rglob("*.nbc")
    content = kept.read_bytes()
    kept.unlink()

    @contextlib.contextmanager
    def turn_after_another(path: Path) -> Iterator[None]:
        assert path == kept
        path.write_bytes(content)
        yield

    monkeypatch.setattr(files, "turn", turn_after_another)
    compiled = compiling_seconds()
    assert answer_kernel(tmp_path / "oracle.py", 1)() == 1
    assert compiling_seconds() == compiled


TAKE_TURN = """
import sys
import threading
from pathlib import Path
from types import FunctionType
from teamformer.base.kernels import turns
turns.PATIENCE = 0
with turns.turn(Path(sys.argv[1])):
    print(Path(sys.argv[1]).read_text())
"""


def test_a_process_waits_until_another_has_ended_its_turn(tmp_path: Path) -> None:
    path = tmp_path / "code"
    with turn(path):
        other = subprocess.Popen(
            [sys.executable, "-c", TAKE_TURN, str(path)],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
        )
        assert other.stderr is not None
        assert other.stderr.readline() == f"{WAITING}\n"
        path.write_text("compiled")
    said, _ = other.communicate()
    assert said == "compiled\n"
    assert [*tmp_path.iterdir()] == [path]


def test_the_lock_of_a_process_that_was_killed_holds_nobody(tmp_path: Path) -> None:
    (tmp_path / "code.lock").touch()
    with turn(tmp_path / "code"):
        assert (tmp_path / "code.lock").exists()
    assert [*tmp_path.iterdir()] == []


def test_where_there_can_be_no_lock_nobody_waits(tmp_path: Path) -> None:
    with turn(tmp_path / "nowhere" / "code"):
        assert [*tmp_path.iterdir()] == []


def test_a_function_waits_not_for_itself(tmp_path: Path) -> None:
    with turn(tmp_path / "code"), turn(tmp_path / "code"):
        assert turns._mine == {tmp_path / "code"}
    assert turns._mine == set()


def test_what_cannot_be_compiled_holds_no_lock(tmp_path: Path) -> None:
    wrong: Callable[..., Any] = entry(lambda number: number + "one")
    with pytest.raises(nb.TypingError):
        wrong(1)
    assert turns._mine == set()
    assert [*tmp_path.rglob("*.lock")] == []
