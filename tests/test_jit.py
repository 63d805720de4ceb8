"""Compiled code is kept until a source that it is made of changes."""

from __future__ import annotations

import contextlib
import importlib.util
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba as nb
import pytest

from teamformer import jit
from teamformer.kernels import files
from teamformer.planning.relaxation import threshold


def twice(number: int) -> int:
    return 2 * number


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a package of three files: top imports middle, which imports low; aside is alone."""
    (tmp_path / "sim").mkdir()
    (tmp_path / "sim" / "low.py").write_text("X = 1\n")
    (tmp_path / "sim" / "middle.py").write_text("from teamformer.sim import (\n    low,\n)\n")
    (tmp_path / "top.py").write_text("def f():\n    from teamformer.sim.middle import low\n")
    (tmp_path / "aside.py").write_text("Y = 1\n")
    monkeypatch.setattr(jit, "ROOT", tmp_path)
    return tmp_path


def stamp(path: Path) -> str:
    for kept in (jit.stamp_of, jit._imported, jit._content):
        kept.cache_clear()
    return jit.stamp_of(path)


def test_a_stamp_changes_with_what_is_imported_however_deep(package: Path) -> None:
    before = stamp(package / "top.py")
    assert stamp(package / "top.py") == before
    (package / "sim" / "low.py").write_text("X = 2\n")
    assert stamp(package / "top.py") != before


def test_a_stamp_does_not_change_with_other_files(package: Path) -> None:
    before = stamp(package / "top.py"), stamp(package / "sim" / "low.py")
    (package / "aside.py").write_text("Y = 2\n")
    assert (stamp(package / "top.py"), stamp(package / "sim" / "low.py")) == before
    (package / "sim" / "middle.py").write_text("from teamformer.sim import low  # new\n")
    assert stamp(package / "sim" / "low.py") == before[1]
    assert stamp(package / "top.py") != before[0]


def test_what_was_compiled_and_kept_needs_no_compiling(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(nb.config, "CACHE_DIR", str(tmp_path))
    assert jit.needs_compiling(jit.entry(twice))
    assert jit.entry(twice)(3) == 6
    assert not jit.needs_compiling(jit.entry(twice))


def test_where_numba_is_off_nothing_needs_compiling() -> None:
    assert not jit.needs_compiling(twice)


def test_a_planner_is_compiled_once_its_search_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(nb.config, "CACHE_DIR", str(tmp_path))
    search_anew = jit.entry(threshold._search.py_func)  # kept in another, empty place
    monkeypatch.setattr(threshold, "_search", search_anew)
    assert not threshold.is_compiled()
    monkeypatch.setattr(search_anew._cache._cache_file, "is_empty", lambda: False)
    assert threshold.is_compiled()


class KilledError(BaseException):
    """Stands for a process that ends without another instruction of ours."""


def answer_kernel(path: Path, answer: int) -> Any:
    """Write a module whose only kernel returns a number, and load it as a new process would."""
    path.write_text(
        f"from teamformer.jit import entry\n\n@entry\ndef reply():\n    return {answer}\n"
    )
    for kept in (jit.stamp_of, jit._imported, jit._content):
        kept.cache_clear()
    bytecode = Path(importlib.util.cache_from_source(path))
    bytecode.unlink(missing_ok=True)  # Python knows old from new by size and second only
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.reply


def killed_at(call: int) -> Callable[[str, str], None]:
    """Return an `os.replace` in which the process is killed when it is called so often."""
    done, calls = os.replace, iter(range(1, 100))

    def replace(source: str, target: str) -> None:
        if next(calls) == call:
            raise KilledError
        done(source, target)

    return replace


@pytest.mark.parametrize("call", [1, 2])
def test_a_process_killed_while_it_keeps_code_leaves_no_old_code_for_later_ones(
    call: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nothing but a number changes, which numba's own keys do not show."""
    monkeypatch.setattr(nb.config, "CACHE_DIR", str(tmp_path / "kept"))
    assert answer_kernel(tmp_path / "oracle.py", 1)() == 1
    with monkeypatch.context() as patched:
        patched.setattr(os, "replace", killed_at(call))
        with contextlib.suppress(KilledError):
            assert answer_kernel(tmp_path / "oracle.py", 2)() == 2
    assert answer_kernel(tmp_path / "oracle.py", 2)() == 2
    (kept,) = (path for path in (tmp_path / "kept").rglob("*") if path.is_file())
    assert kept.suffix == ".nbc"


def test_a_torn_file_is_compiled_anew(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(nb.config, "CACHE_DIR", str(tmp_path / "kept"))
    assert answer_kernel(tmp_path / "oracle.py", 1)() == 1
    (kept,) = (tmp_path / "kept").rglob("*.nbc")
    for torn in (b"", kept.read_bytes()[:-1]):
        kept.write_bytes(torn)
        assert answer_kernel(tmp_path / "oracle.py", 1)() == 1


def test_what_cannot_be_kept_runs_all_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(self: Path, data: bytes) -> int:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(nb.config, "CACHE_DIR", str(tmp_path / "kept"))
    monkeypatch.setattr(Path, "write_bytes", full)
    assert answer_kernel(tmp_path / "oracle.py", 3)() == 3


CALL = """
import sys
from pathlib import Path
sys.path.insert(0, sys.argv[1])
from teamformer import jit
from teamformer.kernels import files
files.PACKAGED = Path(sys.argv[2])
from oracle import reply
print(jit.needs_compiling(reply), reply())
"""
AS_THE_WHEEL = {"NUMBA_CPU_NAME": files.BASELINE, "NUMBA_CPU_FEATURES": ""}


def call_anew(folder: Path, kept: str, **environment: str) -> str:
    """Call the kernel of `oracle.py` in another process; return what it says."""
    done = subprocess.run(
        [sys.executable, "-c", CALL, str(folder), str(folder / "compiled")],
        capture_output=True,
        text=True,
        check=True,
        env={
            **os.environ,
            **environment,
            "NUMBA_CACHE_DIR": str(folder / kept),
            "PYTHONPATH": os.pathsep.join(sys.path),
        },
    )
    return done.stdout.strip()


def test_what_a_wheel_brings_is_not_compiled(tmp_path: Path) -> None:
    """Compiled for the baseline, then found by a process with an empty cache of its own."""
    (tmp_path / "oracle.py").write_text(
        "from teamformer.jit import entry\n\n@entry\ndef reply():\n    return 42\n"
    )
    assert call_anew(tmp_path, "built", **AS_THE_WHEEL) == "True 42"
    [built] = (tmp_path / "built").rglob("*.nbc")
    (tmp_path / "compiled").mkdir()
    built.rename(tmp_path / "compiled" / built.name)
    assert call_anew(tmp_path, "mine") == "False 42"
    assert list((tmp_path / "mine").rglob("*.nbc")) == []
