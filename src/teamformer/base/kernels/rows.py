"""One row of every array in a named tuple of arrays, for kernels that take a batch apart."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numba as nb


def row_taker(batch: type[NamedTuple]) -> Callable[[Any, int], Any]:
    """Return a compiled function `(arrays, row)` that makes a named tuple of each array's row.

    It is written out from the names of the tuple's fields, because numba can neither loop over
    fields of different types nor take them by name. Writing to what it returns writes to the batch.
    """
    fields = ", ".join(f"arrays.{name}[row]" for name in batch._fields)
    space: dict[str, Any] = {"Batch": batch}
    exec(f"def take_row(arrays, row): return Batch({fields})", space)
    taker: Callable[[Any, int], Any] = nb.njit(inline="always")(space["take_row"])
    return taker
