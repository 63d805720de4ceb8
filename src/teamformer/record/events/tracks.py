"""Where robots were at any time, by the ways that they set out on."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Sequence

from teamformer.mission.parts.grid import Place
from teamformer.record.record import Record
from teamformer.world.continuous.events import Passed

HAVE_WAYS = ("walk", "lift")


class Track:
    """The places that a robot passed, in the order of time; between two it went straight on."""

    def __init__(self, start: Place) -> None:
        self._times: list[float] = [0.0]
        self._places: list[Place] = [start]

    def place_at(self, when: float) -> Place:
        """Return where it was at a time."""
        after = bisect_right(self._times, when)
        if after == len(self._times):
            return self._places[-1]
        begin, end = self._times[after - 1 : after + 1]
        one, two = self._places[after - 1 : after + 1]
        part = (when - begin) / (end - begin)
        return one[0] + part * (two[0] - one[0]), one[1] + part * (two[1] - one[1])

    def set_out(self, when: float, way: Sequence[Passed]) -> None:
        """Go another way from a time on, first to where that begins."""
        if way[0].at >= when:
            self.stop(when)
        self._go(way)

    def stop(self, when: float) -> None:
        """Stay where it is at a time."""
        self._go([Passed(when, self.place_at(when))])

    def _go(self, way: Sequence[Passed]) -> None:
        """Pass what is on a way, and after its beginning nothing else."""
        while len(self._times) > 1 and self._times[-1] > way[0].at:
            self._times.pop()
            self._places.pop()
        for at, place in way:
            self._times.append(at)
            self._places.append(place)

    def passed(self) -> list[Passed]:
        """Return all that was passed."""
        return [Passed(*pair) for pair in zip(self._times, self._places, strict=True)]


def tracks_of(record: Record, drawn_at: Callable[[Place], Place]) -> list[Track]:
    """Return the track of each robot; a lost one stays where it was lost.

    `drawn_at` says where a place is drawn, where that is not the place itself.
    """
    tracks = [Track(drawn_at(robot.at)) for robot in record.mission.robots]
    for event in record.events:
        for robot in event.robots:
            if event.kind in HAVE_WAYS:
                way = [Passed(at, drawn_at(place)) for at, place in event.way]
                tracks[robot].set_out(event.at, way)
            elif event.kind in ("lost", "empty"):
                tracks[robot].stop(event.at)
    return tracks
