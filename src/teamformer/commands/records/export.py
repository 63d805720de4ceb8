"""`teamformer export`: a record for other people's tools, or as a mission again."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from teamformer.commands.console import prepare_file, prepare_folder, refuse_existing, say
from teamformer.errors import TeamformerError
from teamformer.extras import require
from teamformer.scenarios.files import write_scenario
from teamformer.sim.replay.reading import read_replay
from teamformer.sim.replay.record import Replay

MISSIONS = (".yaml", ".yml", ".json")
HINT = "name .mcap for Foxglove, .gif, .yaml for the mission, or a folder for tables"


def export(record: Path, wanted: Sequence[Path]) -> int:
    """Write a record into each of the files wanted, as its ending says; return the exit status.

    `.mcap` and `.gif` are as named, `.yaml`, `.yml` and `.json` the mission with all that happened
    to it, and a name without an ending is a folder for CSV tables. Raises `TeamformerError` for
    other endings, for a mission that is there already, and for a record that cannot be read, before
    anything is written.
    """
    for path in wanted:
        if path.resolve() == record.resolve():
            raise TeamformerError(f"{path}: this is the record itself", "name another file")
        _refuse_unwritten(path)
    replay = read_replay(record)
    for path in wanted:
        (prepare_folder if _is_folder(path) else prepare_file)(path)
    for path in wanted:
        for written in _write(replay, path):
            say(f"file: {written}")
    return 0


def _is_folder(path: Path) -> bool:
    """Say whether a name is that of a folder for tables."""
    return path.is_dir() or not path.suffix


def _refuse_unwritten(path: Path) -> None:
    """Raise `TeamformerError` for what cannot be written by its name, or is there already."""
    ending = path.suffix.lower()
    if _is_folder(path):
        return
    if ending not in (".mcap", ".gif", *MISSIONS):
        raise TeamformerError(f"{path}: what is to be in this file?", HINT)
    if ending in MISSIONS:
        refuse_existing(path)
    if ending == ".mcap":
        require("mcap", "foxglove")
    if ending == ".gif":
        require("gif", "PIL")


def _write(replay: Replay, path: Path) -> Sequence[Path]:
    """Write one of the files wanted, or a folder's; return what was written."""
    ending = path.suffix.lower()
    if _is_folder(path):
        from teamformer.export.csv_tables import write_tables

        return write_tables(replay, path)
    if ending == ".mcap":
        from teamformer.export.mcap_file import write_mcap

        write_mcap(replay, path)
    elif ending == ".gif":
        from teamformer.export.gif_file import write_gif

        write_gif(replay, path)
    else:
        write_scenario(replay.scenario, path)
    return [path]
