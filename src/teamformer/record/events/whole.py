"""All that is told of a record in continuous time."""

from __future__ import annotations

from teamformer.mission.parts.layout import layout_of
from teamformer.mission.parts.roads import Roads
from teamformer.record.events.path import path_along_causes
from teamformer.record.events.reasons import Explainer
from teamformer.record.events.runs import Runs
from teamformer.record.record import Record
from teamformer.record.told.told_record import Chapter, ToldRecord


def tell_events(record: Record) -> ToldRecord:
    """Return what the events of a record come to."""
    mission, runs = record.true_mission, Runs(record)
    explainer = Explainer(mission, runs)
    texts: dict[str, int] = {}
    chapters: list[list[Chapter]] = [[] for _ in mission.robots]
    for event in record.events:
        runs.go_on(event)
        explainer.go_on(event)
        for robot in explainer.whose(event):
            what, *why = (
                texts.setdefault(text, len(texts))
                for text in (explainer.what(robot), *explainer.why(robot))
            )
            _add(chapters[robot], Chapter(event.at, what, tuple(why)))
    return ToldRecord(
        record.length,
        tuple(runs.rows),
        tuple(map(tuple, runs.runs)),
        tuple(map(tuple, chapters)),
        tuple(texts),
        path_along_causes(record),
        layout_of(mission.world) if isinstance(mission.world, Roads) else None,
    )


def _add(row: list[Chapter], chapter: Chapter) -> None:
    """Begin a chapter, unless it says the same; one that took no time is none."""
    if row and row[-1].begun == chapter.begun:
        row.pop()
    if not row or row[-1][1:] != chapter[1:]:
        row.append(chapter)
