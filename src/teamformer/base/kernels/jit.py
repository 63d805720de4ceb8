"""How kernels are compiled: once, kept on disk, without the lock of the interpreter."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numba as nb

from teamformer.base.kernels.compiler import Entry, Inner
from teamformer.base.kernels.files import KernelFiles, places_for
from teamformer.base.kernels.stamps import stamp_of


def _compile(function: Callable[..., Any], kind: type[Any], **options: Any) -> Any:
    """Compile on first use, and keep the result until what it is compiled from changes.

    numba looks only at a function's own file, so that code inlined from another file would stay
    as it was; so what is kept is named by a stamp of all that went into it.
    """
    compiled = nb.njit(nogil=True, pipeline_class=kind.pipeline, **options)(function)
    if hasattr(compiled, "_cache"):  # absent where numba is switched off
        compiled.__class__ = kind
        name = f"{kind.prefix}{function.__module__.split('.')[-1]}.{function.__qualname__}"
        files = KernelFiles(places_for(function), name, partial(stamp_of, function))
        compiled._cache = kind.cache(function, files)
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
    files = getattr(function, "files", None)  # absent where numba is switched off
    return isinstance(files, KernelFiles) and files.is_empty()
