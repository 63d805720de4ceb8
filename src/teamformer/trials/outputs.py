"""What is written of a trial: its record, and the page of that."""

from __future__ import annotations

from pathlib import Path

from teamformer.record.files.writing import record_to_tree, save_record
from teamformer.record.record import Record
from teamformer.viewer.html import write_page

WRITTEN = ("record.json", "record.html")


def write_record(record: Record, folder: Path) -> tuple[Path, Path]:
    """Write `record.json` and its page `record.html` into a folder; return both paths."""
    written, page = (folder / name for name in WRITTEN)
    save_record(record, written)
    write_page(record_to_tree(record), page)
    return written, page
