"""`teamformer bench fleet`: rehearsed fleets beside the simulator."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rich.table import Table

from teamformer.base.errors import TeamformerError
from teamformer.base.extras import require
from teamformer.cli.terminal.console import Counting, out, prepare_folder, print_json, write_rows

ROWS = "fleet.jsonl"


def rehearse_worlds(
    settings: Sequence[str], trials: int, first_seed: int, folder: Path | None, as_json: bool
) -> int:
    """Rehearse random worlds and show how long they took; return the exit status.

    It is 1 if one did not end, or broke a promise.
    """
    require("fleet", "msgspec")
    from teamformer.fleet.rehearsal.benchmark import SETTINGS, bench_fleet, summarise

    for setting in settings:
        if setting not in SETTINGS:
            hint = f"it has {', '.join(SETTINGS)}"
            raise TeamformerError(f"suite 'fleet' has no setting '{setting}'", hint)
    if folder is not None:
        prepare_folder(folder)
    settings, seeds = settings or SETTINGS, range(first_seed, first_seed + trials)
    rows = []
    with Counting("worlds") as counting:
        for row in bench_fleet(settings, seeds):
            rows.append(row)
            counting.update(len(rows), len(settings) * trials)
            if as_json:
                print_json(row)
    if folder is not None:
        write_rows(rows, folder / ROWS)
    if not as_json:
        summaries = summarise(rows)
        headers = list(dict.fromkeys(name for summary in summaries for name in summary))
        table = Table(*headers, box=None, header_style="dim")
        for summary in summaries:
            table.add_row(*(str(summary.get(header, "-")) for header in headers))
        out.print(table)
    has_ended = all(None not in (row["agents"], row["lossy"]) for row in rows)
    return 0 if has_ended and not any(row["violations"] for row in rows) else 1
