"""What it is worth that a task ends at a time: its price, how late it is, and if it is missed."""

from __future__ import annotations

from typing import Any

import numpy as np

from teamformer.base.kernels.jit import kernel
from teamformer.planning.problem.misses import LEFT_OUT

WORTH = np.dtype(
    [
        ("due", np.int64),
        ("price", np.int64),  # in steps: of each tick until its end
        ("late_price", np.int64),  # in steps: of each tick that it is late
        ("until", np.int64),  # it is missed if it ends later
        ("miss", np.int64),  # what plans are judged by for that, and what leads a search
        ("leads", np.int64),
        ("is_optional", np.int64),
    ]
)


@kernel
def priced(worth: Any, end: int) -> int:
    """Return what it costs that a task ends then, by its row of WORTH, unless it is missed."""
    if end > worth.until:
        return 0
    return worth.price * end + worth.late_price * max(0, end - worth.due)


@kernel
def missed(worth: Any, end: int) -> int:
    """Return what plans are judged by for it that a task ends then, if that is too late."""
    return worth.miss if end > worth.until else 0


@kernel
def missed_leads(worth: Any, end: int) -> int:
    """Return the same of what leads a search: the more, the later it is, unless it is left out."""
    if end <= worth.until:
        return 0
    return worth.leads if end >= LEFT_OUT else worth.leads + end - worth.until


@kernel
def late_by(worth: Any, end: int) -> int:
    """Return by how much a task is late that ends then, unless it is missed."""
    return 0 if end > worth.until else max(0, end - worth.due)
