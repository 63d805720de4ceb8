"""Compiled code is kept until a source that it is made of changes."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType

import numba as nb
import pytest

from teamformer import jit
from teamformer.planning.relaxation import ruin_recreate
from teamformer.planning.teams import annealing


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


@pytest.mark.parametrize(("module", "begins"), [(ruin_recreate, "_anneal"), (annealing, "anneal")])
def test_a_planner_is_compiled_once_its_search_is(
    module: ModuleType, begins: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(nb.config, "CACHE_DIR", str(tmp_path))
    search_anew = jit.entry(getattr(module, begins).py_func)  # kept in another, empty place
    monkeypatch.setattr(module, begins, search_anew)
    assert not module.is_compiled()
    monkeypatch.setattr(search_anew._cache._cache_file, "_load_index", lambda: {"kept": "code"})
    assert module.is_compiled()
