"""Where robots pause on their ways whose shifts end before they are there."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

from teamformer.mission.parts.shifts import Rota
from teamformer.world.continuous.events import Passed
from teamformer.world.continuous.ways import part_of_way


def with_pauses(
    rota: Rota, start: Passed, ahead: Sequence[Passed], is_plane: bool
) -> tuple[Passed, ...]:
    """Return what is ahead on a way, and from when on a robot goes on wherever it pauses.

    Between two places it pauses at no place, but in a plane.
    """
    if not rota:
        return tuple(ahead)
    legs = pairwise((start, *ahead))
    return tuple(passed for one, other in legs for passed in _leg(rota, one, other, is_plane))


def _leg(rota: Rota, one: Passed, other: Passed, is_plane: bool) -> Iterator[Passed]:
    """Yield what a robot passes after a place, up to the next one."""
    if one.at < other.at < float("inf"):
        pieces = list(rota.walks(one.at, whole := rota.worked(one.at, other.at)))
        if pieces[0][0] > one.at:
            yield Passed(pieces[0][0], one.place)
        walked = 0.0
        for (begin, end), (again, _) in pairwise(pieces if is_plane else ()):
            walked += end - begin
            place = part_of_way(one.place, other.place, walked / whole)
            yield Passed(end, place)
            yield Passed(again, place)
    yield other
