"""How kernels are compiled: once, kept on disk, without the lock of the interpreter."""

from __future__ import annotations

import re
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any

import numba as nb

from teamformer.kernels.compiler import Entry, Inner
from teamformer.kernels.files import KernelFiles

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


def _compile(function: Callable[..., Any], kind: type[Any], **options: Any) -> Any:
    """Compile on first use, and keep the result until the function's file or one below changes.

    numba looks only at a function's own file, so that code inlined from another file would stay
    as it was; so what is kept is named by all that the file imports.
    """
    compiled = nb.njit(nogil=True, pipeline_class=kind.pipeline, **options)(function)
    if hasattr(compiled, "_cache"):  # absent where numba is switched off
        compiled.__class__ = kind
        with suppress(RuntimeError):  # nowhere to write: compile in every process
            cache = kind.cache(function)
            name = kind.prefix + cache._impl.filename_base
            stamp = stamp_of(Path(function.__code__.co_filename))
            cache._cache_file = KernelFiles(Path(cache.cache_path), name, stamp)
            compiled._cache = cache
    return compiled


def entry(function: Callable[..., Any]) -> Any:
    """Compile a function that Python calls; other compiled functions may call it too."""
    compiled = _compile(function, Entry, no_cfunc_wrapper=True)
    if isinstance(compiled, Entry):
        compiled.inner = allocating_kernel(function)
    return compiled


def kernel(function: Callable[..., Any]) -> Any:
    """Compile a function that only other compiled functions call and that allocates nothing.

    Without a wrapper for Python and without reference counts it compiles and runs much faster.
    """
    return _compile(function, Inner, no_cpython_wrapper=True, no_cfunc_wrapper=True, _nrt=False)


def allocating_kernel(function: Callable[..., Any]) -> Any:
    """Compile a function that only other compiled functions call and that makes arrays."""
    return _compile(function, Inner, no_cpython_wrapper=True, no_cfunc_wrapper=True)


def needs_compiling(function: Any) -> bool:
    """Say whether calling a compiled function for the first time will take its time."""
    files = getattr(getattr(function, "_cache", None), "_cache_file", None)
    return isinstance(files, KernelFiles) and files.is_empty()
