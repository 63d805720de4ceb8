"""All that is told of a record in continuous time."""

from __future__ import annotations

from teamformer.mission.parts.layout import layout_of
from teamformer.mission.parts.roads import Roads
from teamformer.record.events.charge_levels import ChargeLevels
from teamformer.record.events.path import path_along_causes
from teamformer.record.events.reasons import Explainer
from teamformer.record.events.runs import Runs, add_run
from teamformer.record.record import Record
from teamformer.record.told.told_record import Run, ToldRecord


def tell_events(record: Record) -> ToldRecord:
    """Return what the events of a record come to."""
    mission, runs = record.true_mission, Runs(record)
    explainer, levels = Explainer(mission, runs), ChargeLevels(record, runs)
    texts: dict[str, int] = {}
    rows: list[list[Run]] = [[runs.now(robot)] for robot in range(len(mission.robots))]
    for event in record.events:
        runs.go_on(event)
        explainer.go_on(event)
        levels.go_on(event)
        for robot in explainer.whose(event):
            why = tuple(texts.setdefault(text, len(texts)) for text in explainer.why(robot))
            add_run(rows[robot], runs.now(robot)._replace(begun=event.at, why=why))
    return ToldRecord(
        record.length,
        tuple(runs.services),
        tuple(map(tuple, rows)),
        tuple(texts),
        path_along_causes(record),
        layout_of(mission.world) if isinstance(mission.world, Roads) else None,
        tuple(map(tuple, levels.rows)) if any(levels.rows) else (),
    )
