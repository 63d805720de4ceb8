"""Sorting in kernels: short to compile, where numpy's `argsort` takes seconds."""

from __future__ import annotations

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import kernel


@kernel
def sort_indices(keys: Array, order: Array, spare: Array) -> None:
    """Write the indices of `keys` from the least key to the largest; of equal keys the lower first.

    Merges runs of 1, 2, 4, ... into one another. `order` and `spare`, which is room to work in, are
    as long as `keys`.
    """
    count = len(keys)
    for index in range(count):
        order[index] = index
    width = 1
    while width < count:
        for begin in range(0, count, 2 * width):
            middle, end = min(begin + width, count), min(begin + 2 * width, count)
            left, right = begin, middle
            for place in range(begin, end):
                if left < middle and (right >= end or keys[order[left]] <= keys[order[right]]):
                    spare[place] = order[left]
                    left += 1
                else:
                    spare[place] = order[right]
                    right += 1
        for index in range(count):
            order[index] = spare[index]
        width *= 2
