"""Files of a mission that a page asks for: made of its record, as the command line makes them."""

from __future__ import annotations

import io
import tempfile
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path

from teamformer.base.extras import require
from teamformer.files.mission_files import write_mission
from teamformer.record.export.csv_tables import write_tables
from teamformer.record.files.writing import record_to_tree, save_record
from teamformer.record.record import Record
from teamformer.viewer.html import write_page


def make_download(record: Record, name: str) -> bytes:
    """Return the content of the file `name`, one of `DOWNLOADS`, made of a record.

    Raises TeamformerError if a library for it is missing, which says how to install it.
    """
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / name
        DOWNLOADS[name](record, path)
        return path.read_bytes()


def _write_page(record: Record, path: Path) -> None:
    write_page(record_to_tree(record), path)


def _write_tables(record: Record, path: Path) -> None:
    """Write the tables of `teamformer export RECORD FOLDER` into one archive."""
    archive = io.BytesIO()
    with tempfile.TemporaryDirectory() as folder, zipfile.ZipFile(archive, "w") as zipped:
        for table in write_tables(record, Path(folder)):
            zipped.write(table, table.name, zipfile.ZIP_DEFLATED)
    path.write_bytes(archive.getvalue())


def _write_mcap(record: Record, path: Path) -> None:
    require("mcap", "foxglove")
    from teamformer.record.export.mcap_file import write_mcap

    write_mcap(record, path)


DOWNLOADS: Mapping[str, Callable[[Record, Path], None]] = {
    "mission.yaml": lambda record, path: write_mission(record.mission, path),
    "record.json": save_record,
    "record.html": _write_page,
    "tables.zip": _write_tables,
    "record.mcap": _write_mcap,
}
"""By name, what writes a file of a record: the mission with all that happened, the record, its
page, tables, and MCAP."""
