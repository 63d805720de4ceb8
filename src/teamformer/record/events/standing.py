"""How everybody stands at a time of a record in continuous time: places, tasks, who is together."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator

from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.layout import Layout
from teamformer.record.events.runs import Runs, add_run
from teamformer.record.events.tracks import tracks_of
from teamformer.record.phases import AT_WORK, FORMING, LOST
from teamformer.record.record import Record
from teamformer.record.told.told_record import Run
from teamformer.world.rules.constants import NOBODY


class StandingAt:
    """A record, ready to be asked; `layout` says where places of roads are drawn, if they are."""

    def __init__(self, record: Record, layout: Layout | None = None) -> None:
        runs = Runs(record)
        self._runs = [[runs.now(robot)] for robot in range(len(record.mission.robots))]
        for event in record.events:
            runs.go_on(event)
            for robot in runs.changed:
                add_run(self._runs[robot], runs.now(robot))
        self._layout = layout
        self._tracks = tracks_of(record, self._on_map)
        self._lies = [[(0.0, self._on_map(task.at))] for task in record.true_mission.tasks]
        self._up: list[list[tuple[float, int]]] = [[] for _ in self._lies]  # who carries since when
        for event in record.events:
            if event.kind == "lift":
                self._up[event.task].append((event.at, event.robots[0]))
            elif event.kind in ("done", "broken", "unload") and self._up[event.task]:
                self._up[event.task].append((event.at, NOBODY))
                if event.place is not None:
                    self._lies[event.task].append((event.at, self._on_map(event.place)))

    def runs_at(self, when: float) -> list[Run]:
        """Return what each robot does from a time on."""
        return [row[bisect_right(row, when, key=lambda it: it.begun) - 1] for row in self._runs]

    def teams_at(self, when: float) -> list[int]:
        """Return by robot the lowest of those who form or work with it; NOBODY of a lost one."""
        led: dict[int, int] = {}
        return list(self._leaders(self.runs_at(when), led))

    def _leaders(self, runs: list[Run], led: dict[int, int]) -> Iterator[int]:
        for robot, run in enumerate(runs):
            if run.phase == LOST:
                yield NOBODY
            elif run.phase in (FORMING, *AT_WORK):
                yield led.setdefault(run.task, robot)
            else:
                yield robot

    def places_at(self, when: float) -> list[Place]:
        """Return where each robot is."""
        return [track.place_at(when) for track in self._tracks]

    def task_places_at(self, when: float) -> list[Place]:
        """Return where each task is; a load that is carried is with its team."""
        return [self._task_place(task, when) for task in range(len(self._lies))]

    def _task_place(self, task: int, when: float) -> Place:
        carried = bisect_right(self._up[task], (when, len(self._tracks)))
        carrier = self._up[task][carried - 1][1] if carried else NOBODY
        if carrier != NOBODY:
            return self._tracks[carrier].place_at(when)
        rows = self._lies[task]
        return rows[bisect_right(rows, when, key=lambda row: row[0]) - 1][1]

    def _on_map(self, place: Place) -> Place:
        return place if self._layout is None else self._layout.places[int(place[0])]
