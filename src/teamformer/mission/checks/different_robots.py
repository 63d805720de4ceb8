"""Whether different robots can do several tasks: each robot does one of them at most."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from teamformer.mission.parts.capabilities import ONE, Counts

MOST_TRIES = 20_000
"""So many ways of dealing robots out are looked at; with more it counts as possible."""

Units = tuple[int, ...]
"""Counts of each capability in thousandths."""

Lacks = tuple[Units, ...]
"""What each task lacks yet."""


def can_be_apart(needs: Sequence[Counts], robots: Sequence[Counts]) -> bool:
    """Say whether robots can be dealt out to tasks so that each task gets what it needs."""
    caps = sorted({cap for need in needs for cap in need})
    lacks = tuple(_units(need, caps) for need in needs)
    brings = sorted((_units(robot, caps) for robot in robots), key=_versatility)
    tried: set[tuple[int, Lacks]] = set()
    open_ways = [(0, lacks)]
    while open_ways:
        way = open_ways.pop()
        dealt, lacks = way
        if not any(map(any, lacks)):
            return True
        if way in tried or not _is_enough(lacks, brings[dealt:]):
            continue
        tried.add(way)
        if len(tried) > MOST_TRIES:
            return True
        open_ways += [(dealt + 1, left) for left in _with_one_more(lacks, brings[dealt])]
    return False


def _units(counts: Counts, caps: Sequence[str]) -> Units:
    return tuple(round(counts.get(cap, 0) * ONE) for cap in caps)


def _versatility(brings: Units) -> tuple[int, Units]:
    """Return by what robots are dealt out: who can do one thing first, alike ones together."""
    return sum(count > 0 for count in brings), brings


def _is_enough(lacks: Lacks, brings: Sequence[Units]) -> bool:
    """Say whether robots bring what all tasks lack together."""
    have = map(sum, zip(*brings, strict=True)) if brings else [0] * len(lacks[0])
    return all(there >= sum(lack) for there, *lack in zip(have, *lacks, strict=True))


def _with_one_more(lacks: Lacks, brings: Units) -> Iterator[Lacks]:
    """Yield what is lacking when a robot does one of the tasks that it can help with, or none."""
    helped = [
        tuple(max(0, count - there) for count, there in zip(lack, brings, strict=True))
        for lack in lacks
    ]
    are_helped = [left != lack for left, lack in zip(helped, lacks, strict=True)]
    if not any(are_helped):
        yield lacks
    for number, is_helped in enumerate(are_helped):
        if is_helped:
            yield (*lacks[:number], helped[number], *lacks[number + 1 :])
