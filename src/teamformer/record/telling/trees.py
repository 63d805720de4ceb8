"""What is told of a record, as it stands in its file and in messages to pages."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from teamformer.record.critical_path.stretches import Stretch
from teamformer.record.phases import PHASES
from teamformer.record.telling.told import Chapter, Run, ToldOfStep, ToldRecord, ToldService
from teamformer.world.rules.constants import NOBODY

Tree = dict[str, Any]


def told_to_tree(told: ToldRecord) -> Tree:
    """Return what is told of a record as the tree of its file."""
    return {
        "services": [_service(service) for service in told.services],
        "phases": [[_run(run) for run in row] for row in told.runs],
        "reasons": {
            "texts": list(told.texts),
            "robots": [[_chapter(chapter) for chapter in row] for row in told.chapters],
        },
        "path": path_to_tree(told.path),
    }


def news_to_tree(news: ToldOfStep) -> Tree:
    """Return what a step adds, as pages are told."""
    chapters = [[robot, _chapter(chapter)] for robot, chapter in news.chapters]
    return {
        "services": [[row, _service(service)] for row, service in news.services],
        "phases": [[robot, _run(run)] for robot, run in news.runs],
        "reasons": {"texts": list(news.texts), "robots": chapters},
    }


def path_to_tree(path: Iterable[Stretch]) -> list[list[Any]]:
    """Return the rows of a critical path."""
    return [[s.begin, s.end, s.doing, _one(s.robot), _one(s.task)] for s in path]


def _service(service: ToldService) -> list[Any]:
    return [*service[:4], list(service.begun_by), list(service.robots)]


def _run(run: Run) -> list[Any]:
    phase = None if run.phase is None else PHASES.index(run.phase)
    return [run.begun, phase, _one(run.task)]


def _chapter(chapter: Chapter) -> list[Any]:
    if chapter.what is None:
        return [chapter.begun, None, chapter.why[0]]
    return [chapter.begun, chapter.what, list(chapter.why)]


def _one(number: int) -> int | None:
    return None if number == NOBODY else number
