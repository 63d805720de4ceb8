"""Who stays in a split: robots in order, while they fit into the counts wanted."""

from __future__ import annotations

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import kernel


@kernel
def fits(counts: Array, room: Array) -> bool:
    """Say whether a robot with these counts (caps,) stays where there is room for so many."""
    for cap in range(len(room)):
        if counts[cap] > room[cap]:
            return False
    return True


@kernel
def anybody_fits(member_counts: Array, first: int, end: int, room: Array) -> bool:
    """Say whether any of the members (members, caps) from `first` to `end` stays."""
    for member in range(first, end):
        if fits(member_counts[member], room):
            return True
    return False
