"""What records of earlier missions at a site tell of the next one: durations, and chances of needs.

A task of the past counts by how near it was to the task at hand and, where that proves right, only
if it needed all that this one needs. What counts as near is what foretells the tasks of the past
best, each from the others. What the mission's file says counts as one task more. This is a kernel
estimate (Nadaraya 1964; Watson 1964); chances are means of beta distributions.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from teamformer.base.array_types import Floats
from teamformer.base.errors import TeamformerError
from teamformer.mission.model import Mission, Task, World, default_step_limit
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.layout import layout_of
from teamformer.mission.parts.roads import Roads
from teamformer.record.record import Record

NEAR = (1 / 32, 1 / 16, 1 / 8, 1 / 4, np.inf)
"""What may count as near, as a share of the longer side of the world; the last: all of it."""

MOST_FORETOLD = 1000
"""How many tasks of the past are foretold from the others, about."""

LEFT_OUT = 0.05
"""A range of durations leaves out this share of them at either end."""

FEWEST = 1.0
"""If fewer tasks than this told a duration, its range stays as the file has it."""

PARTS, PLACES = 200, 6
"""In continuous time ranges begin and end at such parts of what the file says, rounded."""

SURE = 0.01
"""No chance that is learned is nearer to 0 or to 1."""


@dataclass(frozen=True)
class Lesson:
    """What was learned of one thing: `weight` is how many tasks of the past told it, about."""

    task: str
    what: str  # "duration", or "may need" with a capability
    said: str  # by the mission's file
    learned: str
    weight: float


@dataclass(frozen=True)
class Experience:
    """A mission as records of its site show it, and what was learned of its tasks."""

    mission: Mission
    lessons: tuple[Lesson, ...]


def learn(mission: Mission, records: Sequence[Record]) -> Experience:
    """Return a mission whose uncertain durations and needs are as records of its site show them.

    Only what has shown itself counts: durations of tasks that were done, needs that became known.
    Raises `TeamformerError` for a record of another world, and if neither a duration nor a need of
    the mission is uncertain.
    """
    if not any(task.lasts or task.may_need for task in mission.tasks):
        raise TeamformerError(
            f"no task of '{mission.name}' has an uncertain duration or need",
            "write what is not known, as duration: [2, 9] or may_need: {weld: 0.4}",
        )
    for record in records:
        if record.mission.world != mission.world:
            raise TeamformerError(
                f"the record of '{record.mission.name}' is of another world than the mission",
                "name records of missions at the same site",
            )
    site = _site_of(mission.world)
    cases = [case for record in records for case in _cases(record)]
    durations = _Past([case for case in cases if case.cap is None], site)
    caps = sorted({cap for task in mission.tasks for cap in task.may_need})
    needs = {cap: _Past([case for case in cases if case.cap == cap], site) for cap in caps}
    is_whole = mission.time == "steps"
    told = [_told(task, durations, needs, is_whole) for task in mission.tasks]
    is_usual = mission.step_limit == default_step_limit(mission)
    limit = 0 if is_usual else mission.step_limit
    learned = replace(mission, tasks=tuple(task for task, _ in told), step_limit=limit)
    return Experience(learned, tuple(lesson for _, lessons in told for lesson in lessons))


@dataclass(frozen=True)
class _Site:
    """How long the longer side of a world is, and where its places lie in a plane."""

    side: float
    spots: Sequence[Place] | None = None  # of roads, by number

    def spot(self, at: Place) -> Place:
        """Return where a place lies."""
        return at if self.spots is None else self.spots[int(at[0])]


def _site_of(world: World) -> _Site:
    """Return how near places are to one another; on roads as their map has them."""
    if not isinstance(world, Roads):
        return _Site(max(world.width, world.height))
    layout = layout_of(world)
    return _Site(max(layout.width, layout.height), layout.places)


def _told(
    task: Task, durations: _Past, needs: Mapping[str, _Past], is_whole: bool
) -> tuple[Task, Sequence[Lesson]]:
    """Return a task as the past shows it, and what was learned of it; in steps all is whole."""
    lasts, may_need, lessons = task.lasts, dict(task.may_need), []
    if task.lasts is not None:
        lasts, weight = durations.range_of(task, _values(*task.lasts, is_whole))
        said, found = (f"{least:g} to {most:g}" for least, most in (task.lasts, lasts))
        lessons.append(Lesson(task.name, "duration", said, found, weight))
    for cap, chance in task.may_need.items():
        may_need[cap], weight = needs[cap].chance_of(task, chance)
        said, found = f"{chance:g}", f"{may_need[cap]:g}"
        lessons.append(Lesson(task.name, f"may need {cap}", said, found, weight))
    return replace(task, lasts=lasts, may_need=may_need), lessons


def _values(least: float, most: float, is_whole: bool) -> Sequence[float]:
    """Return the durations that a range may begin or end with, ascending."""
    if is_whole:
        return range(int(least), int(most) + 1)
    values: list[float] = np.linspace(least, most, PARTS + 1).round(PLACES).tolist()
    return values


@dataclass(frozen=True)
class _Case:
    """A task of the past: its duration or, of a capability, whether it needed one more."""

    cap: str | None
    at: Place
    needs: frozenset[str]
    value: float
    said: float  # what was to be expected by the file of its mission


def _cases(record: Record) -> Iterator[_Case]:
    """Return what a record shows of durations and needs that were not known."""
    done = {task for step in record.steps for task, _ in step.done}
    done |= {event.task for event in record.events if event.kind == "done"}
    seen = {task for step in record.steps for task in step.shown}
    seen |= {event.task for event in record.events if event.kind == "know"}
    both = zip(record.mission.tasks, record.true_mission.tasks, strict=True)
    for number, (task, true) in enumerate(both):
        needed = frozenset(true.needs)
        if task.lasts is not None and number in done:
            yield _Case(None, true.at, needed, true.duration, task.duration)
        for cap, chance in task.may_need.items():
            if number in seen:
                more = true.needs.get(cap, 0) > task.needs.get(cap, 0)
                yield _Case(cap, true.at, needed, more, chance)


class _Past:
    """Tasks of the past, and how they count for another one."""

    def __init__(self, cases: Sequence[_Case], site: _Site) -> None:
        self._cases, self._site, side = cases, site, site.side
        spots = [site.spot(case.at) for case in cases]
        self._at = np.array(spots, np.float64).reshape(-1, 2)
        self._value = np.array([case.value for case in cases], np.float64)
        caps = {cap for case in cases for cap in case.needs}
        self._lacking = {cap: np.array([cap not in c.needs for c in cases]) for cap in caps}
        ways = [(share * side, is_alike) for share, is_alike in product(NEAR, (False, True))]
        self._way = min(ways, key=lambda way: self._error(*way)) if cases else ways[0]

    def range_of(self, task: Task, values: Sequence[float]) -> tuple[tuple[float, float], float]:
        """Return what a duration may be, out of some values, and how many tasks told it."""
        least, most = values[0], values[-1]
        weight = self._weights(task.at, task.needs.keys(), *self._way)
        weight *= (least <= self._value) & (self._value <= most)
        if weight.sum() < FEWEST:
            return (least, most), float(weight.sum())

        def share_up_to(place: int) -> float:
            told = weight[self._value <= values[place]].sum()
            return float((place + 1) / len(values) + told) / (1 + float(weight.sum()))

        places = range(len(values))
        first = bisect_right(places, LEFT_OUT, key=share_up_to)
        last = bisect_left(places, 1 - LEFT_OUT, key=share_up_to)
        return (values[first], values[last]), float(weight.sum())

    def chance_of(self, task: Task, said: float) -> tuple[float, float]:
        """Return the chance of a need, and how many tasks told it; what is sure stays so."""
        if not 0 < said < 1:
            return said, 0.0
        weight = self._weights(task.at, task.needs.keys(), *self._way)
        chance = (said + weight @ self._value) / (1 + weight.sum())
        return round(float(np.clip(chance, SURE, 1 - SURE)), 2), float(weight.sum())

    def _weights(self, at: Place, needs: Set[str], near: float, is_alike: bool) -> Floats:
        """Return how much each task counts, from 0 to 1."""
        away = ((self._at - np.asarray(self._site.spot(at))) ** 2).sum(axis=1)
        weight: Floats = np.exp(-0.5 * away / near**2)
        for cap in needs if is_alike else ():
            weight[self._lacking.get(cap, slice(None))] = 0
        return weight

    def _error(self, near: float, is_alike: bool) -> float:
        """Return the mean squared error if each task is foretold from the others."""
        error = 0.0
        for number in range(0, len(self._cases), max(1, len(self._cases) // MOST_FORETOLD)):
            case = self._cases[number]
            weight = self._weights(case.at, case.needs, near, is_alike)
            weight[number] = 0
            foretold = (case.said + weight @ self._value) / (1 + weight.sum())
            error += (foretold - case.value) ** 2
        return error
