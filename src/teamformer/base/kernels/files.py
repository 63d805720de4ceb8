"""Where compiled kernels are kept: one file each, whose name says what it was compiled from.

numba keeps an index beside its files and checks only the index; a process killed between the two
writes leaves old machine code under a new index for ever. Here there is no index. The name of a
file is made from the sources, the versions, the types of the arguments and the processor, so old
code has another name; a file is renamed into place whole, and a torn one is not read.

Code is read in every place where it may be kept, and written to the first that can be written. A
wheel may bring files with it that were compiled for a fixed processor (`make wheel`). They are
read where there is none for this one, if this one can all that that one can.
"""

from __future__ import annotations

import contextlib
import inspect
import os
import pickle
import sys
from collections.abc import Callable, Iterator, Sequence
from functools import cache, cached_property
from hashlib import sha256
from pathlib import Path
from typing import Any

import llvmlite
import numba
from llvmlite.binding import get_host_cpu_features
from numba.core import config, types
from numba.core.caching import InTreeCacheLocator, UserProvidedCacheLocator, UserWideCacheLocator
from numba.core.serialize import dumps

from teamformer.base.kernels.turns import turn

CHECKED = "checked." if config.BOUNDSCHECK else ""  # type: ignore[attr-defined]
OPTIMISED = f"-opt{sys.flags.optimize}" if sys.flags.optimize else ""
PYTHON = f"py{sys.version_info.major}{sys.version_info.minor}{OPTIMISED}"
VERSIONS = f"{numba.__version__}, {llvmlite.__version__}"
DIGITS = 16
"""Of each of the two hashes in a name."""

PACKAGED = Path(__file__).parents[2] / "compiled"
BASELINE, ABILITIES = "x86-64-v3", ("avx2", "bmi", "bmi2", "f16c", "fma", "lzcnt", "movbe")
"""The processor that a wheel's files are made for, and what it can; most since 2015 can."""


def places_for(function: Callable[..., Any]) -> list[Path]:
    """Return where numba would keep a function's code, the first that can be written to.

    That is where the user says, beside its file, and in the user's cache.
    """
    file = inspect.getfile(function)
    if not os.path.exists(file):  # typed into Python
        return []
    given = [UserProvidedCacheLocator] if config.CACHE_DIR else []  # type: ignore[attr-defined]
    locators: list[Any] = [*given, InTreeCacheLocator, UserWideCacheLocator]
    return [Path(locator(function, file).get_cache_path()) for locator in locators]


class KernelFiles:
    """The files of one function; numba asks it for code by the types that it is called with."""

    def __init__(self, places: Sequence[Path], name: str, stamp: Callable[[], str]) -> None:
        """`places` are folders in which code may be kept, the one to write to before others.

        `stamp` returns a text that changes with what the function is compiled from. It is asked
        when code is first wanted. Code that checks every index is kept apart, and so is that of
        each level at which Python optimises.
        """
        self._places, self._name = places, f"{name}.{CHECKED}{PYTHON}"
        self._ask = stamp
        self._turn = contextlib.ExitStack()

    @cached_property
    def _stamp(self) -> str:
        return _digest(f"{VERSIONS}, {self._ask()}")

    @cached_property
    def home(self) -> Path | None:
        """Return the folder that code is written to; None if there is none."""
        return next((place for place in self._places if _can_write(place)), None)

    def is_empty(self) -> bool:
        """Say whether nothing is kept that was compiled from the sources as they are."""
        folders = [*self._folders(), *([PACKAGED] if _is_at_least_baseline() else [])]
        files = (file for f in folders for file in f.glob(f"{self._name}.{self._stamp}.*.nbc"))
        return next(files, None) is None

    def load(self, key: Any) -> Any:
        """Return the code kept for a key; None means that it is this process's turn to compile it.

        If another process compiles it, it is waited for. `end_turn` has others go on.
        """
        code = self._find(key)
        if code is None and self.home is not None:
            self._turn.enter_context(turn(self.home / self._file(key)))
            code = self._find(key)
        return code

    def end_turn(self) -> None:
        """Let other processes have what was compiled, or compile it themselves."""
        self._turn.close()

    def save(self, key: Any, code: Any) -> None:
        """Keep code for a key, and remove what older sources and killed processes left.

        On a full disk nothing is kept; several processes may write at once.
        """
        if self.home is None:
            return
        packed: bytes = dumps((key, code))  # type: ignore[no-untyped-call]
        path = self.home / self._file(key)
        unfinished = path.with_name(f"{path.name}.{os.getpid()}.tmp")
        with contextlib.suppress(OSError), _removed_at_the_end(unfinished):
            unfinished.write_bytes(sha256(packed).digest() + packed)
            os.replace(unfinished, path)
        for old in [*self.home.glob(f"{self._name}.*")]:
            is_current = old.name.startswith(f"{self._name}.{self._stamp}.")
            if not is_current or old.name.startswith(f"{path.name}."):
                old.unlink(missing_ok=True)

    def flush(self) -> None:
        """Remove all that is kept of the function."""
        for old in [*self.home.glob(f"{self._name}.*")] if self.home else []:
            old.unlink(missing_ok=True)

    def _find(self, key: Any) -> Any:
        """Return the code kept for a key anywhere, or None."""
        found = (_read(folder / self._file(key), key) for folder in self._folders())
        code = next((code for code in found if code is not None), None)
        if code is None and _is_at_least_baseline():
            kinds, (triple, *_), hashes = key
            same = (kinds, (triple, BASELINE, ""), hashes)
            code = _read(PACKAGED / self._file(same), same)
        return code

    def _folders(self) -> Sequence[Path]:
        """Return where code may be found: up to the place that it is written to."""
        if self.home is None:
            return self._places
        return self._places[: self._places.index(self.home) + 1]

    def _file(self, key: Any) -> str:
        return f"{self._name}.{self._stamp}.{_digest(_spell(key))}.nbc"


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
def _can_write(folder: Path) -> bool:
    """Say whether files can be put into a folder, which is made if it is not there."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return False
    return os.access(folder, os.W_OK | os.X_OK)


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
    kinds, processor, code = key
    return repr(([_spell_kind(kind) for kind in kinds], processor, code))


def _spell_kind(kind: Any) -> str:
    """Write a type as text; of a named tuple the fields too, as code reads them by their places."""
    if not isinstance(kind, types.BaseTuple):
        return str(kind)
    parts = [_spell_kind(part) for part in kind.types]  # type: ignore[attr-defined]
    return f"{kind.name.partition('(')[0]} {getattr(kind, 'fields', '')} {parts}"
