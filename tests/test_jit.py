"""Compiled code is kept until what it was compiled from changes."""

from __future__ import annotations

import contextlib
import importlib.util
import os
import pickle
import subprocess
import sys
import time
from collections.abc import Callable
from hashlib import sha256
from pathlib import Path
from types import ModuleType
from typing import Any

import numba as nb
import pytest
from numba.core.serialize import dumps

from teamformer.base.kernels import files, jit
from teamformer.base.kernels.clock import compiling_seconds, working_seconds
from teamformer.base.kernels.stamps import stamp_of
from teamformer.planning.relaxation import threshold


def twice(number: int) -> int:
    return 2 * number


SOURCE = """
from typing import NamedTuple
from teamformer.base.kernels.jit import entry, kernel
import numpy as np

STEP = 2
TABLE = np.array([1, 2, 3])

class Pair(NamedTuple):
    one: int
    other: int

@kernel
def low(number):
    return number + STEP

@kernel
def middle(number):
    return Pair(low(number), TABLE[0]).one

@entry
def top(number):
    \"\"\"Return more than a number.\"\"\"
    return middle(number) if number < 9 else top(number - 1)

def message():
    return "no number"

@entry
def aside(number):
    return -number
"""


def stamps(source: str, folder: Path) -> dict[str, str]:
    """The stamps of the functions of a module, loaded as a new process would."""
    path = folder / "sums.py"
    path.write_text(source)
    module = load_anew(path)
    return {name: stamp_of(getattr(module, name)) for name in ("low", "middle", "top", "aside")}


@pytest.mark.parametrize(
    ("before", "after", "changed"),
    [
        ("number + STEP", "STEP + number", ["low", "middle", "top"]),
        ("STEP = 2", "STEP = 3", ["low", "middle", "top"]),
        ("[1, 2, 3]", "[1, 2, 4]", ["middle", "top"]),
        ("    other: int", "    other: int\n    third: int = 0", ["middle", "top"]),
        ("number < 9", "number < 8", ["top"]),
        ("-number", "number", ["aside"]),
        ("more than a number", "a larger number", []),
        ("no number", "this is no number", []),
        ("@kernel\ndef low", "\n\n@kernel\ndef low", []),
    ],
)
def test_a_stamp_changes_with_what_is_compiled_and_with_nothing_else(
    before: str, after: str, changed: list[str], tmp_path: Path
) -> None:
    assert SOURCE.count(before) == 1
    old, new = stamps(SOURCE, tmp_path), stamps(SOURCE.replace(before, after), tmp_path)
    assert [name for name in old if old[name] != new[name]] == changed


def test_functions_that_are_alike_have_stamps_of_their_own(tmp_path: Path) -> None:
    assert len(set(stamps(SOURCE, tmp_path).values())) == 4


STAMPS_OF_ALL = """
import importlib, pkgutil
import teamformer
from teamformer.base.kernels.compiler import Entry
from teamformer.base.kernels.clock import compiling_seconds, working_seconds
from teamformer.base.kernels.stamps import stamp_of
for part in ("world", "planning", "methods"):
    package = importlib.import_module(f"teamformer.{part}")
    for found in pkgutil.walk_packages(package.__path__, f"teamformer.{part}."):
        module = importlib.import_module(found.name)
        for name, value in sorted(vars(module).items()):
            if isinstance(value, Entry):
                print(found.name, name, stamp_of(value))
"""


@pytest.mark.thorough
def test_stamps_are_the_same_in_every_process() -> None:
    told = [
        subprocess.run(
            [sys.executable, "-c", STAMPS_OF_ALL],
            capture_output=True,
            text=True,
            check=True,
            env={**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": os.pathsep.join(sys.path)},
        ).stdout
        for seed in ("1", "2")
    ]
    assert told[0] == told[1]
    assert "teamformer.world.step step_worlds " in told[0]


def test_what_was_compiled_and_kept_needs_no_compiling(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(nb.config, "CACHE_DIR", str(tmp_path))
    assert jit.needs_compiling(jit.entry(twice))
    assert jit.entry(twice)(3) == 6
    assert not jit.needs_compiling(jit.entry(twice))


def test_a_function_that_was_sent_to_another_process_runs_there() -> None:
    assert pickle.loads(dumps(jit.entry(lambda number: 2 * number)))(3) == 6


def test_where_numba_is_off_nothing_needs_compiling() -> None:
    assert not jit.needs_compiling(twice)


def test_a_planner_is_compiled_once_its_search_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(nb.config, "CACHE_DIR", str(tmp_path))
    search_anew = jit.entry(threshold._search.py_func)  # kept in another, empty place
    monkeypatch.setattr(threshold, "_search", search_anew)
    assert not threshold.is_compiled()
    monkeypatch.setattr(search_anew.files, "is_empty", lambda: False)
    assert threshold.is_compiled()


class KilledError(BaseException):
    """Stands for a process that ends without another instruction of ours."""


def answer_kernel(path: Path, answer: int) -> Any:
    """Write a module whose only kernel returns a number, and load it as a new process would."""
    path.write_text(
        "from teamformer.base.kernels.jit import entry\n\n@entry\n"
        f"def reply():\n    return {answer}\n"
    )
    return load_anew(path).reply


def load_anew(path: Path) -> ModuleType:
    """Load a module as a new process would."""
    bytecode = Path(importlib.util.cache_from_source(path))
    bytecode.unlink(missing_ok=True)  # Python knows old from new by size and second only
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


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


@pytest.mark.parametrize("gone", [b"cno_such_module\nType\n.", b"cteamformer\nNoSuchType\n."])
def test_what_was_kept_for_a_type_that_has_moved_is_compiled_anew(
    gone: bytes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(nb.config, "CACHE_DIR", str(tmp_path / "kept"))
    assert answer_kernel(tmp_path / "oracle.py", 1)() == 1
    (kept,) = (tmp_path / "kept").rglob("*.nbc")
    kept.write_bytes(sha256(gone).digest() + gone)
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
import time
from pathlib import Path
sys.path.insert(0, sys.argv[1])
from teamformer.base.kernels import jit
from teamformer.base.kernels import files
from teamformer.base.kernels.clock import compiling_seconds, working_seconds
from teamformer.base.kernels.stamps import stamp_of
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


@pytest.mark.thorough
def test_what_a_wheel_brings_is_not_compiled(tmp_path: Path) -> None:
    """Compiled for the baseline, then found by a process with an empty cache of its own."""
    (tmp_path / "oracle.py").write_text(
        "from teamformer.base.kernels.jit import entry\n\n@entry\ndef reply():\n    return 42\n"
    )
    assert call_anew(tmp_path, "built", **AS_THE_WHEEL) == "True 42"
    [built] = (tmp_path / "built").rglob("*.nbc")
    (tmp_path / "compiled").mkdir()
    built.rename(tmp_path / "compiled" / built.name)
    assert call_anew(tmp_path, "mine") == "False 42"
    assert list((tmp_path / "mine").rglob("*.nbc")) == []


@pytest.mark.thorough
@pytest.mark.parametrize("fields", [("one", "other"), ("other", "one")])
def test_fields_that_change_places_are_compiled_anew(
    fields: tuple[str, str], tmp_path: Path
) -> None:
    """Machine code reads a field by its place, and the kernel's own file does not name it."""
    (tmp_path / "oracle.py").write_text(
        "from pairs import Pair\n"
        "from teamformer.base.kernels.jit import entry\n\n"
        "@entry\ndef other_of(pair):\n    return pair.other\n\n"
        "def reply():\n    return other_of(Pair(one=1, other=2))\n"
    )
    for order in (("one", "other"), fields):
        (tmp_path / "pairs.py").write_text(
            "from typing import NamedTuple\n\nclass Pair(NamedTuple):\n"
            + "".join(f"    {field}: int\n" for field in order)
        )
        assert call_anew(tmp_path, "kept", PYTHONDONTWRITEBYTECODE="1") == "False 2"
    kept = list((tmp_path / "kept").rglob("*.nbc"))
    assert len(kept) == len({("one", "other"), fields})


def test_compiling_is_told_apart_from_work(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The clock of work stands still meanwhile; what is kept is not compiled again."""
    monkeypatch.setattr(nb.config, "CACHE_DIR", str(tmp_path / "kept"))
    reply = answer_kernel(tmp_path / "oracle.py", 4)
    begun, compiled, worked = time.perf_counter(), compiling_seconds(), working_seconds()
    assert reply() == 4
    took = compiling_seconds() - compiled
    assert 0 < took <= time.perf_counter() - begun
    assert working_seconds() - worked <= time.perf_counter() - begun - took
    compiled = compiling_seconds()
    assert answer_kernel(tmp_path / "oracle.py", 4)() == 4
    assert compiling_seconds() == compiled
