"""`teamformer view FOLDER`: a page with a row for each record in a folder."""

from __future__ import annotations

from pathlib import Path

from teamformer.base.errors import TeamformerError
from teamformer.cli.terminal.console import say
from teamformer.files.trees.mission import RECORD
from teamformer.record.files.reading import read_record
from teamformer.record.files.writing import record_to_tree
from teamformer.record.record import Record
from teamformer.record.task_times import cost_of_record, lateness
from teamformer.viewer.folder_page import RecordRow, write_folder_page
from teamformer.viewer.html import write_page

PAGE = "records.html"

BEGINNING = 200
"""Characters of a file in which the key of a record stands, if it is one."""


def view_folder(folder: Path) -> int:
    """Write `records.html` into a folder, and the pages of its records beside these.

    Records in folders inside count, too. A page that is newer than its record is left alone. What
    cannot be read has a row that says why. Raises `TeamformerError` for a folder without records.
    """
    found = [path for path in sorted(folder.rglob("*.json")) if _looks_like_a_record(path)]
    if not found:
        hint = "name a folder in which `run --out` or `compare --out` wrote records"
        raise TeamformerError(f"{folder}: there is no record in this folder", hint)
    rows = [_row(folder, path) for path in found]
    write_folder_page(folder.resolve().name, rows, folder / PAGE)
    say(f"page: {folder / PAGE}")
    return 0


def _looks_like_a_record(path: Path) -> bool:
    try:
        with path.open(encoding="utf-8") as file:
            return f'"{RECORD}"' in file.read(BEGINNING)
    except (OSError, UnicodeDecodeError):
        return False


def _row(folder: Path, path: Path) -> RecordRow:
    name = path.relative_to(folder).as_posix()
    try:
        record = read_record(path)
    except TeamformerError as error:
        return RecordRow(name, wrong=str(error).removeprefix(str(path)).lstrip(": "))
    page = path.with_suffix(".html")
    if not page.exists() or page.stat().st_mtime < path.stat().st_mtime:
        write_page(record_to_tree(record), page)
    return _row_of(name, page.relative_to(folder).as_posix(), record)


def _row_of(name: str, page: str, record: Record) -> RecordRow:
    late = lateness(record)
    return RecordRow(
        file=name,
        page=page,
        mission=record.mission.name,
        method=record.method,
        seed=record.seed,
        ended=record.end.status,
        length=record.length,
        is_continuous=record.is_continuous,
        bound=record.lower_bound,
        done=f"{record.end.tasks_done} of {len(record.true_mission.tasks)}",
        late=sum(late.values()) or None,
        cost=cost_of_record(record),
    )
