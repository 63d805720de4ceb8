"""`teamformer learn`: a mission with what records of its site tell of it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rich.table import Table

from teamformer.base.errors import TeamformerError
from teamformer.cli.terminal.console import out, prepare_file, refuse_existing, say
from teamformer.files.mission_files import read_mission, write_mission
from teamformer.record.files.reading import read_record
from teamformer.trials.advice.experience import Experience, learn

MOST_LINES = 15


def learn_from(path: Path, paths: Sequence[Path], learned: Path) -> int:
    """Write a mission as records of its site show it, and say what changed; return the status.

    A folder stands for all `record.json` in it. Raises `TeamformerError` if the file to be written
    is there already.
    """
    refuse_existing(learned)
    mission = read_mission(path)
    records = [read_record(one) for one in _listed(paths)]
    experience = learn(mission, records)
    prepare_file(learned)
    write_mission(experience.mission, learned)
    _show(experience, len(records))
    say(f"mission: {learned}")
    return 0


def _listed(paths: Sequence[Path]) -> list[Path]:
    listed: list[Path] = []
    for path in paths:
        inside = sorted(path.rglob("record.json")) if path.is_dir() else [path]
        if not inside:
            raise TeamformerError(f"{path}: there is no record.json in this folder")
        listed += inside
    return listed


def _show(experience: Experience, records: int) -> None:
    told = [lesson for lesson in experience.lessons if lesson.said != lesson.learned]
    table = Table("task", "what", "file", "learned", "from tasks", box=None, header_style="dim")
    for it in sorted(told, key=lambda lesson: -lesson.weight)[:MOST_LINES]:
        table.add_row(it.task, it.what, it.said, it.learned, f"{it.weight:.1f}")
    if told:
        out.print(table)
    if len(told) > MOST_LINES:
        out.print(f"... and {len(told) - MOST_LINES} more", style="dim")
    said = len(experience.lessons)
    counted = "1 record" if records == 1 else f"{records} records"
    out.print(f"learned {len(told)} of {said} uncertain values from {counted}")
