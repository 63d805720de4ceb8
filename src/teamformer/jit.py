"""How kernels are compiled: once, kept on disk, without the lock of the interpreter."""

from __future__ import annotations

from collections.abc import Callable
from hashlib import sha256
from pathlib import Path
from typing import Any

import numba as nb


def _stamp_of_sources() -> str:
    """Return a text that changes when any file of the package does."""
    root = Path(__file__).parent
    stamp = sha256()
    for path in sorted(root.rglob("*.py")):
        about = path.stat()
        stamp.update(f"{path.relative_to(root)} {about.st_size} {about.st_mtime_ns}\n".encode())
    return stamp.hexdigest()


_STAMP = _stamp_of_sources()


def _compile(function: Callable[..., Any], **options: Any) -> Any:
    """Compile on first use, and keep the result until any source of the package changes.

    numba looks only at a function's own file, so that code inlined from another file would stay
    as it was; its check of versions is made to look at all of them.
    """
    try:
        compiled = nb.njit(cache=True, nogil=True, **options)(function)
    except RuntimeError:  # nowhere to write: compile in every process
        return nb.njit(nogil=True, **options)(function)
    if hasattr(compiled, "_cache"):  # absent where numba is switched off
        compiled._cache._cache_file._version += _STAMP
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
    index = function._cache._cache_file
    return not index._load_index()
