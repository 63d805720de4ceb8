"""`teamformer export`: a record for other people's tools, or as a mission again."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from teamformer.commands.console import prepare_file, prepare_folder, refuse_existing, say
from teamformer.entry_points import OURS, Brought, brought, find_brought
from teamformer.errors import TeamformerError
from teamformer.sim.replay.reading import read_replay

FOLDER = "folder"
"""The exporter for a name without an ending; the others are named by endings."""

MISSIONS = (".yaml", ".yml", ".json")
HINT = "name .mcap for Foxglove, .gif, .yaml for the mission, or a folder for tables"


def export(record: Path, wanted: Sequence[Path]) -> int:
    """Write a record into each of the files wanted, as its ending says; return the exit status.

    `.mcap` and `.gif` are as named, `.yaml`, `.yml` and `.json` the mission with all that happened
    to it, and a name without an ending is a folder for CSV tables. Other packages may bring more.
    Raises `TeamformerError` for other endings, for a library that is missing, and for a mission
    that is there already, before anything is written.
    """
    exporters: list[tuple[Brought, Path]] = []
    for path in wanted:
        if path.resolve() == record.resolve():
            raise TeamformerError(f"{path}: this is the record itself", "name another file")
        exporters.append((_prepare(path), path))
    replay = read_replay(record)
    for exporter, path in exporters:
        for written in exporter.call(replay, path) or (path,):
            say(f"file: {written}")
    return 0


def _prepare(path: Path) -> Brought:
    """Make sure that a file can be written; return who writes it."""
    ending = path.suffix.lower()
    is_folder = path.is_dir() or not ending
    exporter = find_brought("exporter", FOLDER if is_folder else ending[1:])
    if exporter is None:
        raise TeamformerError(f"{path}: what is to be in this file?", _hint())
    if ending in MISSIONS and not is_folder:
        refuse_existing(path)
    exporter.load()
    if is_folder:
        prepare_folder(path)
    else:
        prepare_file(path)
    return exporter


def _hint() -> str:
    others = [f", .{one.name} of package {one.package}" for one in brought("exporter")]
    ours = len([one for one in brought("exporter") if one.package == OURS])
    return HINT + "".join(others[ours:])
