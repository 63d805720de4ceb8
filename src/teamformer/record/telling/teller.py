"""Tells a record, step by step or whole: the one place where it is worked out what robots did."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from teamformer.record.critical_path.stretches import Stretch
from teamformer.record.phases import LOST, WAITING
from teamformer.record.record import Record
from teamformer.record.telling.charge_levels import LevelsInSteps
from teamformer.record.telling.reasons import Narrator
from teamformer.record.telling.unrolled import Unrolled
from teamformer.record.told.told_record import Run, ToldOfStep, ToldRecord
from teamformer.world.rules.constants import NOBODY


class Teller:
    """Goes through a record once; `go_on` tells of the next step, `told` of all up to there."""

    def __init__(self, record: Record) -> None:
        self.unrolled = Unrolled(record)
        self._narrator = Narrator(self.unrolled)
        self._runs: list[list[Run]] = [[] for _ in record.mission.robots]
        self._texts: dict[str, int] = {}
        self._levels = LevelsInSteps(record, self.unrolled) if record.mission.charging else None
        self._apart: set[int] = set()  # the teams whose robots did not all do the same before

    @property
    def steps(self) -> int:
        """Return how many steps it has told of."""
        return self.unrolled.steps

    def go_on(self, record: Record) -> ToldOfStep:
        """Tell of the next step of a record, which begins as what has been told of."""
        now, known = self.unrolled, len(self._texts)
        now.go_on(record)
        self._narrator.go_on()
        if self._levels is not None:
            self._levels.go_on(now)
        runs = tuple(self._added())
        self._apart = self._teams_apart()
        rows = now.services.rows
        services = tuple((row, rows[row]) for row in now.services.changed)
        return ToldOfStep(services, runs, (*self._texts,)[known:])

    def told(self, path: tuple[Stretch, ...] = ()) -> ToldRecord:
        """Return all that has been told, with the critical path."""
        services = tuple(self.unrolled.services.rows)
        runs = tuple(tuple(row) for row in self._runs)
        levels = tuple(map(tuple, self._levels.rows)) if self._levels else ()
        return ToldRecord(self.steps, services, runs, tuple(self._texts), path, levels=levels)

    def _added(self) -> Iterator[tuple[int, Run]]:
        """Add what robots do since the latest step to their runs, and yield it, if it is other."""
        for robot, run in self._what_robots_did():
            row = self._runs[robot]
            if not row or row[-1][1:] != run[1:]:
                row.append(run)
                yield robot, run

    def _what_robots_did(self) -> Iterator[tuple[int, Run]]:
        """Yield the runs that may begin with the latest step."""
        now, since = self.unrolled, self.steps - 1
        for slot in self._whose_story_goes_on():
            why = tuple(self._text(reason) for reason in self._narrator.why(slot))
            yield slot, Run(since, *now.phases.deeds[slot], why)
        for robot, slot in self._other_mates():
            yield robot, Run(since, *now.phases.apart.get(robot, (None, slot)))
        for robot in now.latest.lost:
            yield robot, Run(since, LOST, NOBODY)

    def _whose_story_goes_on(self) -> Iterable[int]:
        """Return the teams that do something else, or for another reason."""
        now, opened = self.unrolled, self.unrolled.opened
        if now.is_planned or self.steps == 1:
            return sorted(now.teams.robots)
        others, news = {*now.others, *now.formed}, set(opened)
        turned = now.services.turned
        news.update(*(room.tasks for room in now.rooms if room.tasks & turned))
        if news:
            deeds = now.phases.deeds
            waiting = {(WAITING, task) for task in news}
            others |= {slot for slot in now.teams.robots if deeds[slot] in waiting}
        return sorted(others)

    def _other_mates(self) -> Iterator[tuple[int, int]]:
        """Yield each robot that may have another lowest mate than before, and that one."""
        now = self.unrolled
        apart = self._apart | self._teams_apart()
        slots = now.teams.robots if self.steps == 1 else now.formed | apart
        for slot in sorted(slots):
            for robot in now.teams.robots.get(slot, ())[1:]:
                yield robot, slot

    def _teams_apart(self) -> set[int]:
        """Return the teams of which not all robots did the same in the latest step."""
        return {self.unrolled.teams.slot[robot] for robot in self.unrolled.phases.apart}

    def _text(self, text: str) -> int:
        """Return the number of a text, which is kept once."""
        return self._texts.setdefault(text, len(self._texts))
