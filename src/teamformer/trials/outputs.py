"""What is written of a trial: its record, and the page of that."""

from __future__ import annotations

from pathlib import Path

from teamformer.record.record import Record
from teamformer.record.writing import record_to_tree, save_record
from teamformer.viewer.html import write_page


def write_record(replay: Record, folder: Path) -> tuple[Path, Path]:
    """Write `replay.json` and its page `replay.html` into a folder; return both paths."""
    record, page = folder / "replay.json", folder / "replay.html"
    save_record(replay, record)
    write_page(record_to_tree(replay), page)
    return record, page
