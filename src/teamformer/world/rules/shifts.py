"""When robots work that have shifts: whether something is within one of them."""

from __future__ import annotations

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import kernel


@kernel
def is_within_shift(shifts: Array, every: int, begin: int, end: int) -> bool:
    """Say whether one shift of a robot has all the time between two numbers of steps made.

    `shifts` (most, 2) is when each begins and ends, then NEVER; after `every` they come again, if
    that is not 0. The plain rule is `Rota.fits` in `mission/parts/shifts.py`.
    """
    later = 0
    if every > 0:
        later = max(0, (begin - shifts[0, 0]) // every) * every
    for row in range(len(shifts)):
        if shifts[row, 0] + later > begin:
            return False
        if end <= shifts[row, 1] + later:
            return True
    return False
