"""Who has what: counts of capabilities, (caps,) each, as kernels compare them."""

from __future__ import annotations

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import kernel


@kernel
def are_equal(have: Array, others: Array) -> bool:
    """Say whether counts are the same."""
    for cap in range(len(have)):
        if have[cap] != others[cap]:
            return False
    return True


@kernel
def covers(have: Array, need: Array) -> bool:
    """Say whether counts are enough."""
    for cap in range(len(need)):
        if have[cap] < need[cap]:
            return False
    return True


@kernel
def helps(have: Array, need: Array) -> bool:
    """Say whether counts hold anything that is needed."""
    for cap in range(len(need)):
        if have[cap] > 0 and need[cap] > 0:
            return True
    return False


@kernel
def fills_gap(have: Array, need: Array, brought: Array) -> bool:
    """Say whether others bring something of which those who have some need more."""
    for cap in range(len(need)):
        if brought[cap] > 0 and need[cap] > have[cap]:
            return True
    return False
