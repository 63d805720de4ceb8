"""What is told of a record, as it stands in its file and in messages to pages."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Any, TypeVar

from teamformer.mission.parts.layout import Layout
from teamformer.record.critical_path.stretches import Stretch
from teamformer.record.phases import PHASES
from teamformer.record.told.told_record import Level, Run, ToldOfStep, ToldRecord, ToldService
from teamformer.world.rules.constants import NOBODY

Tree = dict[str, Any]
Row = TypeVar("Row")

DIGITS = 9
"""Places after the point that are told of how full a battery is."""

NUMBERS = {None: None} | {phase: number for number, phase in enumerate(PHASES)}

CHARGE = "charge"
"""The key that says how full batteries are."""

LAYOUT = "map"
"""The key that says where places of roads are drawn, which is nobody's claim."""


def told_to_tree(told: ToldRecord) -> Tree:
    """Return what is told of a record as the tree of its file."""
    return {
        "services": [_service(service) for service in told.services],
        "phases": [[_run(run) for run in row] for row in told.runs],
        "texts": list(told.texts),
        "path": path_to_tree(told.path),
        **({} if told.layout is None else {LAYOUT: _layout(told.layout)}),
        **({CHARGE: [[*map(_level, row)] for row in told.levels]} if told.levels else {}),
    }


def news_to_tree(news: ToldOfStep) -> Tree:
    """Return what a step adds, as pages are told."""
    return {
        "services": [[row, _service(service)] for row, service in news.services],
        "phases": [[robot, _run(run)] for robot, run in news.runs],
        "texts": list(news.texts),
    }


def added_to_tree(before: ToldRecord, after: ToldRecord) -> Tree:
    """Return what is told of events and was not told before the latest, as pages are told.

    There is a path only if the mission has ended.
    """
    known = len(before.services)
    services = [
        [row, _service(service)]
        for row, service in enumerate(after.services)
        if row >= known or service != before.services[row]
    ]
    tree: Tree = {
        "services": services,
        "phases": [[robot, _run(run)] for robot, run in _added(before.runs, after.runs)],
        "texts": list(after.texts[len(before.texts) :]),
    }
    if after.levels:
        tree[CHARGE] = [[robot, _level(one)] for robot, one in _added(before.levels, after.levels)]
    return tree | {"path": path_to_tree(after.path)} if after.path else tree


def _added(
    before: Sequence[Sequence[Row]], after: Sequence[Sequence[Row]]
) -> Iterator[tuple[int, Row]]:
    """Yield what each robot has more than before."""
    for robot, row in enumerate(after):
        for one in row[len(before[robot]) :]:
            yield robot, one


def path_to_tree(path: Iterable[Stretch]) -> list[list[Any]]:
    """Return the rows of a critical path."""
    return [
        [_time(s.begin), _time(s.end), NUMBERS.get(s.doing, s.doing), _one(s.robot), _one(s.task)]
        for s in path
    ]


def _layout(layout: Layout) -> Tree:
    return {
        "names": list(layout.names),
        "size": [layout.width, layout.height],
        "places": [list(place) for place in layout.places],
        "roads": [list(road) for road in layout.roads],
    }


def _service(service: ToldService) -> list[Any]:
    """Return the row of a service: robots that began it as a team by its slot, the same once."""
    begun, ended = _time(service.begun), _time(service.ended)
    begun_by = list(service.begun_by) if service.slot is None else service.slot
    row = [service.task, NUMBERS[service.doing], begun, ended, begun_by]
    is_told = service.ended is None or service.robots == service.begun_by
    return row if is_told else [*row, list(service.robots)]


def _run(run: Run) -> list[Any]:
    return [_time(run.begun), NUMBERS[run.phase], _one(run.task), *run.why]


def _level(level: Level) -> list[Any]:
    return [_time(level.begun), round(level.full, DIGITS), round(level.rate, DIGITS)]


def _time(when: Any) -> Any:
    """Return a time without a point if it is whole."""
    return int(when) if isinstance(when, float) and when.is_integer() else when


def _one(number: int) -> int | None:
    return None if number == NOBODY else number
