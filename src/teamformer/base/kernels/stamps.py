"""What a kernel is compiled from, as a text: its code, that of all it calls, and their constants.

A message, a docstring, a type or another function in the same file may change, and what was
compiled is still good. Only what numba reads counts: bytecode, and the globals that it names.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache
from hashlib import sha256
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import Any, NamedTuple

import numpy as np

COMPILER = (Path(__file__).with_name("compiler.py"), Path(__file__).with_name("jit.py"))
"""The files that say how anything is compiled."""


class _Piece(NamedTuple):
    """One function: a digest of what is its own, and the functions that it calls."""

    digest: str
    calls: tuple[FunctionType, ...]


def stamp_of(function: Callable[..., Any]) -> str:
    """Return a text that changes when what a function is compiled from does.

    Ask when all modules that it needs are loaded: its globals are read now.
    """
    seen, waiting = dict[FunctionType, str](), [_plain(function)]
    while waiting:
        one = waiting.pop()
        if one not in seen:
            piece = _piece_of(one)
            seen[one] = piece.digest
            waiting += piece.calls
    return _digest(repr((_how(), seen[_plain(function)], sorted(seen.values()))))


@cache
def _how() -> str:
    return _digest(b"".join(file.read_bytes() for file in COMPILER))


def _plain(function: Any) -> FunctionType:
    """Return a function as it was written, compiled or not."""
    written: FunctionType = getattr(function, "py_func", function)
    return written


@cache
def _piece_of(function: FunctionType) -> _Piece:
    codes = list(_with_inner(function.__code__))
    names = sorted({name for code in codes for name in code.co_names})
    used = {name: function.__globals__[name] for name in names if name in function.__globals__}
    used |= {
        name: cell.cell_contents
        for name, cell in zip(codes[0].co_freevars, function.__closure__ or (), strict=True)
    }
    calls = tuple(_plain(value) for value in used.values() if _is_function(value))
    told = [
        function.__qualname__,
        function.__defaults__,
        [(code.co_code, code.co_names, code.co_varnames) for code in codes],
        [_constants(code, function.__doc__) for code in codes],
        {name: _spell(value) for name, value in used.items() if not _is_function(value)},
    ]
    return _Piece(_digest(repr(told)), calls)


def _with_inner(code: CodeType) -> Iterator[CodeType]:
    """Yield a code and those inside it: of comprehensions and inner functions."""
    yield code
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _with_inner(constant)


def _constants(code: CodeType, docstring: str | None) -> list[str]:
    """Return what stands in a code as such, but for its docstring and inner codes."""
    kept = [one for one in code.co_consts if not isinstance(one, CodeType)]
    return [_spell(one) for one in kept if one is None or one != docstring]


def _is_function(value: Any) -> bool:
    return isinstance(_plain(value), FunctionType)


def _spell(value: Any) -> str:
    """Return a constant as text that is the same in every process."""
    if isinstance(value, np.ndarray):
        return f"{value.dtype} {value.shape} {sha256(value.tobytes()).hexdigest()}"
    if isinstance(value, frozenset):
        return f"{sorted(value, key=repr)}"
    if isinstance(value, ModuleType):
        return value.__name__
    if isinstance(value, type) or callable(value):
        return f"{getattr(value, '__qualname__', value)} {getattr(value, '_fields', '')}"
    return f"{type(value).__qualname__} {value!r}"


def _digest(told: str | bytes) -> str:
    return sha256(told.encode() if isinstance(told, str) else told).hexdigest()
