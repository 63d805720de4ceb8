"""`teamformer export`: a record for other people's tools, or as a mission again."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from teamformer.base.entry_points import OURS, Brought, brought, find_brought
from teamformer.base.errors import TeamformerError
from teamformer.cli.terminal.console import prepare_file, prepare_folder, refuse_existing, say
from teamformer.record.files.reading import read_record

FOLDER = "folder"
"""The exporter for a name without an ending; the others are named by endings."""

MISSIONS = ("yaml", "yml", "json")
HINT = "name .mcap for Foxglove, .trace.json for Perfetto, .gif, .yaml, or a folder for tables"


def export(source: Path, wanted: Sequence[Path]) -> int:
    """Write a record into each of the files wanted, as its ending says; return the exit status.

    `.mcap`, `.gif` and `.trace.json` are as named, `.yaml`, `.yml` and other `.json` the mission
    with all that happened to it, and a name without an ending is a folder for CSV tables. Other
    packages may bring more.
    Raises `TeamformerError` for other endings, for a library that is missing, for a mission that is
    there already, and for a record that cannot be read, before anything is written.
    """
    exporters: list[tuple[Brought, Path]] = []
    for path in wanted:
        if path.resolve() == source.resolve():
            raise TeamformerError(f"{path}: this is the record itself", "name another file")
        exporters.append((_exporter_of(path), path))
    record = read_record(source)
    for path in wanted:
        (prepare_folder if _is_folder(path) else prepare_file)(path)
    for exporter, path in exporters:
        for written in exporter.call(record, path) or (path,):
            say(f"file: {written}")
    return 0


def _is_folder(path: Path) -> bool:
    """Say whether a name is that of a folder for tables."""
    return path.is_dir() or not path.suffix


def _exporter_of(path: Path) -> Brought:
    """Return who writes a file; raise `TeamformerError` for what cannot be written by its name."""
    last = path.suffixes[-2:] if not _is_folder(path) else []
    endings = ["".join(last).lower()[1:], path.suffix.lower()[1:]] if last else [FOLDER]
    found = (find_brought("exporter", ending) for ending in endings)
    exporter = next((one for one in found if one is not None), None)
    if exporter is None:
        raise TeamformerError(f"{path}: the ending says no format", _hint())
    if exporter.name in MISSIONS:
        refuse_existing(path)
    exporter.load()
    return exporter


def _hint() -> str:
    others = [f", .{one.name} of package {one.package}" for one in brought("exporter")]
    ours = len([one for one in brought("exporter") if one.package == OURS])
    return HINT + "".join(others[ours:])
