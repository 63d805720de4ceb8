"""Pairing off: teams in one place become one, two by two, one forming a step."""

from __future__ import annotations

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import kernel


@kernel
def pair_off(arrival: Array, count: int) -> int:
    """Return the step in which the first `count` teams that arrive, in sorted steps, are one.

    In each step those that are there become half as many. No team at all is one at step 0.
    """
    if count == 0:
        return 0
    here, step = 1, arrival[0]
    for index in range(1, count):
        while here > 1 and step < arrival[index]:
            here = (here + 1) // 2
            step += 1
        here += 1
        step = max(step, arrival[index])
    while here > 1:
        here = (here + 1) // 2
        step += 1
    return step
