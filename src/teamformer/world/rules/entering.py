"""Who takes room in zones while a plan is carried out, by the rule of `mission/parts/zones.py`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from teamformer.mission.parts.zones import AtWork, ZoneRoom, may_enter, may_unload
from teamformer.world.rules.starts import RoomLeft


class RoomsTaken:
    """The room of zones at a moment of a plan, whose tasks enter them in an `order`."""

    def __init__(self, rooms: Sequence[RoomLeft], order: Sequence[int]) -> None:
        self._rooms = [
            ZoneRoom(zone, room.tasks, room.room - len(room.taken), room.loads)
            for zone, room in enumerate(rooms)
        ]
        none = frozenset[int]()
        self.entered = none.union(*(room.tasks for room in rooms))  # tasks that take room
        self.unloaded_in = none.union(*(room.loads for room in rooms))  # loads that do at the end
        self._waiting = [task for task in order if task in self.entered]
        self.ready: set[int] = set()  # tasks that could begin but for their zones
        self.queue: list[tuple[float, int]] = []  # loads that wait, and since when
        self._served: set[int] = set()
        self._unloaded: set[int] = set()

    def free(self, zone: int) -> None:
        """Let a zone have room for one more: what went on there before the plan is over."""
        room = self._rooms[zone]
        self._rooms[zone] = room._replace(room=room.room + 1)

    def next_unloaded(self) -> Iterator[int]:
        """Yield loads for which there is room, who came first before who came later."""
        for _, load in sorted(self.queue):
            if may_unload(self._rooms, self._work(), load):
                yield load

    def next_begun(self) -> Iterator[int]:
        """Yield tasks that are ready and have their turn, in the order of the plan."""
        for task in [task for task in self._waiting if task in self.ready]:
            if may_enter(self._rooms, self._waiting, self._work(), task):
                yield task

    def _work(self) -> AtWork:
        return AtWork(self._served, self._unloaded, [load for _, load in sorted(self.queue)])

    def begin(self, task: int) -> None:
        """Let a task take room."""
        self._waiting.remove(task)
        self.ready.discard(task)
        self._served.add(task)

    def unload(self, load: int) -> float:
        """Let a load take room that waits for it; return since when it does."""
        since = next(since for since, other in self.queue if other == load)
        self.queue.remove((since, load))
        self._unloaded.add(load)
        return since

    def leave(self, task: int) -> None:
        """Let a task take no room any more."""
        self._served.discard(task)
        self._unloaded.discard(task)
