"""`teamformer export`: a record for other people's tools, or as a scenario again."""

from __future__ import annotations

from pathlib import Path

from teamformer.commands.console import prepare_file, prepare_folder, print_json, say
from teamformer.errors import TeamformerError
from teamformer.scenarios.files import write_scenario
from teamformer.sim.replay.reading import read_replay


def export(
    record: Path, mcap: Path | None, tables: Path | None, scenario: Path | None, as_json: bool
) -> int:
    """Write what was asked for; return the exit status."""
    if mcap is None and tables is None and scenario is None:
        raise TeamformerError(
            "nothing to write is named", "add --mcap FILE, --csv FOLDER or --scenario FILE"
        )
    replay = read_replay(record)
    written: list[Path] = []
    if tables is not None:
        from teamformer.export.csv_tables import write_tables

        prepare_folder(tables)
        written += write_tables(replay, tables)
    if scenario is not None:
        prepare_file(scenario)
        write_scenario(replay.scenario, scenario)
        written.append(scenario)
    if mcap is not None:
        prepare_file(mcap)
        written.append(_write_mcap(record, mcap))
    if as_json:
        print_json({"files": [str(path) for path in written]})
    for path in written:
        say(f"file: {path}")
    return 0


def _write_mcap(record: Path, path: Path) -> Path:
    try:
        from teamformer.export.mcap_file import write_mcap
    except ImportError as error:
        raise TeamformerError(
            f"--mcap needs foxglove-sdk, which is not there ({error})",
            "pip install 'teamformer[mcap]'",
        ) from None
    write_mcap(read_replay(record), path)
    return path
