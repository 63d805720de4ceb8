"""`teamformer export`: a record for other people's tools, or as a scenario again."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from teamformer.commands.console import prepare_file, prepare_folder, print_json, say
from teamformer.errors import TeamformerError
from teamformer.scenarios.files import write_scenario
from teamformer.sim.replay.reading import read_replay
from teamformer.sim.replay.record import Replay


@dataclass(frozen=True)
class Wanted:
    """Where to write what; None is not asked for."""

    mcap: Path | None = None
    tables: Path | None = None
    gif: Path | None = None
    scenario: Path | None = None


def export(record: Path, wanted: Wanted, as_json: bool) -> int:
    """Write what was asked for; return the exit status."""
    if wanted == Wanted():
        raise TeamformerError(
            "nothing to write is named",
            "add --mcap FILE, --csv FOLDER, --gif FILE or --scenario FILE",
        )
    replay = read_replay(record)
    written: list[Path] = []
    if wanted.tables is not None:
        from teamformer.export.csv_tables import write_tables

        prepare_folder(wanted.tables)
        written += write_tables(replay, wanted.tables)
    if wanted.scenario is not None:
        prepare_file(wanted.scenario)
        write_scenario(replay.scenario, wanted.scenario)
        written.append(wanted.scenario)
    if wanted.mcap is not None:
        prepare_file(wanted.mcap)
        written.append(_write_mcap(replay, wanted.mcap))
    if wanted.gif is not None:
        prepare_file(wanted.gif)
        written.append(_write_gif(replay, wanted.gif))
    if as_json:
        print_json({"files": [str(path) for path in written]})
    for path in written:
        say(f"file: {path}")
    return 0


def _write_mcap(replay: Replay, path: Path) -> Path:
    try:
        from teamformer.export.mcap_file import write_mcap
    except ImportError as error:
        raise TeamformerError(
            f"--mcap needs foxglove-sdk, which is not there ({error})",
            "pip install 'teamformer[mcap]'",
        ) from None
    write_mcap(replay, path)
    return path


def _write_gif(replay: Replay, path: Path) -> Path:
    try:
        from teamformer.export.gif_file import write_gif
    except ImportError as error:
        raise TeamformerError(
            f"--gif needs Pillow, which is not there ({error})", "pip install 'teamformer[gif]'"
        ) from None
    write_gif(replay, path)
    return path
