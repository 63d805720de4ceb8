"""How kernels are compiled: once, kept on disk, without the lock of the interpreter."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any

import numba as nb

from teamformer.kernel_cache import KernelFiles

ROOT = Path(__file__).parent
IMPORT = re.compile(r"^ *from teamformer\.([\w.]+) import (\([^)]*\)|.*)", re.MULTILINE)


@cache
def stamp_of(source: Path) -> str:
    """Return a text that changes when a file of the package does, or any that it imports."""
    seen, waiting = set[Path](), [source]
    while waiting:
        path = waiting.pop()
        if path not in seen:
            seen.add(path)
            waiting += _imported(path)
    stamp = sha256()
    for path in sorted(seen):
        stamp.update(path.name.encode() + _content(path))
    return stamp.hexdigest()


@cache
def _imported(path: Path) -> tuple[Path, ...]:
    """Return the files of the package that a file imports from."""
    found = []
    for module, names in IMPORT.findall(_content(path).decode()):
        place = ROOT.joinpath(*module.split("."))
        parts = [place / name for name in re.findall(r"\w+", names)]
        found += [p.with_suffix(".py") for p in (place, *parts)]
    return tuple(file for file in found if file.is_file())


@cache
def _content(path: Path) -> bytes:
    return path.read_bytes()


def _compile(function: Callable[..., Any], **options: Any) -> Any:
    """Compile on first use, and keep the result until the function's file or one below changes.

    numba looks only at a function's own file, so that code inlined from another file would stay
    as it was; so what is kept is named by all that the file imports.
    """
    try:
        compiled = nb.njit(cache=True, nogil=True, **options)(function)
    except RuntimeError:  # nowhere to write: compile in every process
        return nb.njit(nogil=True, **options)(function)
    if hasattr(compiled, "_cache"):  # absent where numba is switched off
        folder, name = Path(compiled._cache.cache_path), compiled._cache._impl.filename_base
        stamp = stamp_of(Path(function.__code__.co_filename))
        compiled._cache._cache_file = KernelFiles(folder, name, stamp)
    return compiled


def entry(function: Callable[..., Any]) -> Any:
    """Compile a function that Python calls."""
    return _compile(function)


def kernel(function: Callable[..., Any]) -> Any:
    """Compile a function that only other compiled functions call and that allocates nothing.

    Without a wrapper for Python and without reference counts it compiles and runs much faster.
    """
    return _compile(function, no_cpython_wrapper=True, no_cfunc_wrapper=True, _nrt=False)


def needs_compiling(function: Any) -> bool:
    """Say whether calling a compiled function for the first time will take its time."""
    if not hasattr(function, "_cache"):
        return False
    files: KernelFiles = function._cache._cache_file
    return files.is_empty()
