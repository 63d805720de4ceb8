"""The connected parts of a map, found by joining runs of free cells from row to row."""

from __future__ import annotations

import math
import re
from bisect import bisect_right
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Regions:
    """The runs of free cells in each row, with the number of the part that each belongs to."""

    begins: tuple[tuple[int, ...], ...]
    ends: tuple[tuple[int, ...], ...]  # the first cell that is not in the run
    numbers: tuple[tuple[int, ...], ...]

    def number(self, x: int, y: int) -> int:
        """Return the part that a free cell belongs to."""
        return self.numbers[y][bisect_right(self.begins[y], x) - 1]

    def cells(self, number: int) -> Iterator[tuple[int, int]]:
        """Return the cells of a part, row by row."""
        for y, row in enumerate(zip(self.begins, self.ends, self.numbers, strict=True)):
            for begin, end, part in zip(*row, strict=True):
                if part == number:
                    yield from ((x, y) for x in range(begin, end))

    def largest(self) -> int:
        """Return the part with the most cells, the first of equals; -1 if nothing is free."""
        sizes: dict[int, int] = {}
        for row in zip(self.begins, self.ends, self.numbers, strict=True):
            for begin, end, number in zip(*row, strict=True):
                sizes[number] = sizes.get(number, 0) + end - begin
        return max(sizes, key=lambda number: (sizes[number], -number), default=-1)


def find_regions(rows: Sequence[str], free: str) -> Regions:
    """Return the parts of a map; `rows[y][x]` is `free` where a robot can be."""
    runs = [[match.span() for match in re.finditer(f"[{re.escape(free)}]+", row)] for row in rows]
    first = [0]  # the number of each row's first run, counting all runs of the map
    for row in runs:
        first.append(first[-1] + len(row))
    parent = list(range(first[-1]))
    for y in range(1, len(runs)):
        for i, j in _touching(runs[y - 1], runs[y]):
            _unite(parent, first[y - 1] + i, first[y] + j)
    return Regions(
        begins=tuple(tuple(begin for begin, _ in row) for row in runs),
        ends=tuple(tuple(end for _, end in row) for row in runs),
        numbers=tuple(
            tuple(_root(parent, first[y] + i) for i in range(len(row)))
            for y, row in enumerate(runs)
        ),
    )


def _touching(
    above: Sequence[tuple[int, int]], below: Sequence[tuple[int, int]]
) -> Iterator[tuple[int, int]]:
    """Return which runs of two neighbouring rows share a column."""
    i = j = 0
    while i < len(above) and j < len(below):
        if above[i][0] < below[j][1] and below[j][0] < above[i][1]:
            yield i, j
        if above[i][1] < below[j][1]:
            i += 1
        else:
            j += 1


def _unite(parent: list[int], one: int, other: int) -> None:
    """Put two runs into one part, named by its first run."""
    one, other = _root(parent, one), _root(parent, other)
    parent[max(one, other)] = min(one, other)


def _root(parent: list[int], run: int) -> int:
    while parent[run] != run:
        parent[run] = parent[parent[run]]
        run = parent[run]
    return run


def walks(
    rows: Sequence[str], free: str, begin: tuple[int, int], ends: Sequence[tuple[int, int]]
) -> list[float]:
    """Return how many steps it is from a free cell to some others; infinite if no way leads."""
    width = len(rows[0]) + 1
    dry, front = _free_bits(rows, free), 1 << (begin[1] * width + begin[0])
    bits = [1 << (y * width + x) for x, y in ends]
    wanted, steps = 0, 0
    for bit in bits:
        wanted |= bit
    found: dict[int, float] = {}
    while front and wanted:
        if front & wanted:
            found |= {bit: float(steps) for bit in bits if front & bit}
            wanted &= ~front
        dry ^= front
        front = (front << 1 | front >> 1 | front << width | front >> width) & dry
        steps += 1
    return [found.get(bit, math.inf) for bit in bits]


def _free_bits(rows: Sequence[str], free: str) -> int:
    """Return a bit for each cell, 1 where it is free; after each row comes a blocked one."""
    is_free = bytes(ord("1" if code == ord(free) else "0") for code in range(256))
    text = "@".join(rows).encode("ascii", errors="replace").translate(is_free)
    return int(text[::-1], 2)


MOST_FLOODING = 4 * 10**9  # cells times steps: half a second


def flood(rows: Sequence[str], free: str, begins: Iterable[tuple[int, int]]) -> int:
    """Return how many steps it takes to walk from some free cells to the farthest one.

    A cell counts from the nearest begin. On a map that is too large to try, it is an upper bound.
    """
    width = len(rows[0]) + 1  # a blocked column keeps the end of a row from the next one's begin
    dry, cells, front = _free_bits(rows, free), width * len(rows), 0
    for x, y in begins:
        front |= 1 << (y * width + x)
    steps = 0
    while True:
        dry ^= front
        front = (front << 1 | front >> 1 | front << width | front >> width) & dry
        if not front:
            return steps
        if steps * cells > MOST_FLOODING:
            return steps + dry.bit_count()
        steps += 1
