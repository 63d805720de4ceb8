"""How kernels are compiled: once, kept on disk, without the lock of the interpreter."""

from __future__ import annotations

from functools import partial

import numba as nb

entry = partial(nb.njit, cache=True, nogil=True)()
"""Compiles a function that Python calls."""

kernel = partial(
    nb.njit, cache=True, nogil=True, no_cpython_wrapper=True, no_cfunc_wrapper=True, _nrt=False
)()
"""Compiles a function that only other compiled functions call and that allocates nothing.

Without a wrapper for Python and without reference counts it compiles and runs much faster.
"""
