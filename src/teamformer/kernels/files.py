"""Where compiled kernels are kept: one file each, whose name says what it was compiled from.

numba keeps an index beside its files and checks only the index; a process killed between the two
writes leaves old machine code under a new index for ever. Here there is no index. The name of a
file is made from the sources, the versions, the types of the arguments and the processor, so old
code has another name; a file is renamed into place whole, and a torn one is not read.

A wheel may bring files with it that were compiled for a fixed processor (`make wheel`). They are
read where there is none for this one, if this one can all that that one can.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import sys
from collections.abc import Callable, Iterator
from functools import cache, cached_property
from hashlib import sha256
from pathlib import Path
from typing import Any

import llvmlite
import numba
from llvmlite.binding import get_host_cpu_features
from numba.core.serialize import dumps

CHECKED = "checked." if numba.core.config.BOUNDSCHECK else ""  # type: ignore[attr-defined]
PYTHON = f"py{sys.version_info.major}{sys.version_info.minor}"
VERSIONS = f"{numba.__version__}, {llvmlite.__version__}"
DIGITS = 16
"""Of each of the two hashes in a name."""

PACKAGED = Path(__file__).parents[1] / "compiled"
BASELINE, ABILITIES = "x86-64-v3", ("avx2", "bmi", "bmi2", "f16c", "fma", "lzcnt", "movbe")
"""The processor that a wheel's files are made for, and what it can; most since 2015 can."""


class KernelFiles:
    """The files of one function; numba asks it for code by the types that it is called with."""

    def __init__(self, folder: Path, name: str, stamp: Callable[[], str]) -> None:
        """`stamp` returns a text that changes with what the function is compiled from.

        It is asked when code is first wanted. Code that checks every index is kept apart.
        """
        self._folder, self._name = folder, f"{name}.{CHECKED}{PYTHON}"
        self._ask = stamp

    @cached_property
    def _stamp(self) -> str:
        return _digest(f"{VERSIONS}, {self._ask()}")

    def is_empty(self) -> bool:
        """Say whether nothing is kept that was compiled from the sources as they are."""
        folders = [self._folder, PACKAGED] if _is_at_least_baseline() else [self._folder]
        files = (file for f in folders for file in f.glob(f"{self._name}.{self._stamp}.*.nbc"))
        return next(files, None) is None

    def load(self, key: Any) -> Any:
        """Return the code kept for a key, or None."""
        code = _read(self._path(key), key)
        if code is None and _is_at_least_baseline():
            types, (triple, *_), hashes = key
            same = (types, (triple, BASELINE, ""), hashes)
            code = _read(PACKAGED / self._path(same).name, same)
        return code

    def save(self, key: Any, code: Any) -> None:
        """Keep code for a key, and remove what older sources and killed processes left.

        On a full disk nothing is kept; several processes may write at once.
        """
        packed: bytes = dumps((key, code))  # type: ignore[no-untyped-call]
        path = self._path(key)
        unfinished = path.with_name(f"{path.name}.{os.getpid()}.tmp")
        with contextlib.suppress(OSError), _removed_at_the_end(unfinished):
            unfinished.write_bytes(sha256(packed).digest() + packed)
            os.replace(unfinished, path)
        for old in [*self._folder.glob(f"{self._name}.*")]:
            is_current = old.name.startswith(f"{self._name}.{self._stamp}.")
            if not is_current or old.name.startswith(f"{path.name}."):
                old.unlink(missing_ok=True)

    def flush(self) -> None:
        """Remove all that is kept of the function."""
        for old in [*self._folder.glob(f"{self._name}.*")]:
            old.unlink(missing_ok=True)

    def _path(self, key: Any) -> Path:
        return self._folder / f"{self._name}.{self._stamp}.{_digest(_spell(key))}.nbc"


def _read(path: Path, key: Any) -> Any:
    """Return the code in a file if it is whole and for a key, else None."""
    try:
        content = path.read_bytes()
    except OSError:
        return None
    checksum, packed = content[:32], content[32:]
    if sha256(packed).digest() != checksum:  # the machine stopped before it was all on disk
        return None
    try:
        kept_for, code = pickle.loads(packed)
    except (ImportError, AttributeError):  # a type in the key has moved to another module since
        return None
    return code if kept_for == key else None


@cache
def _is_at_least_baseline() -> bool:
    """Say whether this processor runs what was compiled for the baseline."""
    if not PACKAGED.is_dir():
        return False
    try:
        can = get_host_cpu_features()
    except RuntimeError:  # LLVM does not know this processor
        return False
    return all(can.get(ability, False) for ability in ABILITIES)


@contextlib.contextmanager
def _removed_at_the_end(path: Path) -> Iterator[None]:
    try:
        yield
    finally:
        path.unlink(missing_ok=True)


def _digest(text: str) -> str:
    return sha256(text.encode()).hexdigest()[:DIGITS]


def _spell(key: Any) -> str:
    """Write a key of numba's, (types of the arguments, processor, hashes of the code), as text."""
    types, processor, code = key
    return repr(([str(kind) for kind in types], processor, code))
