"""The files that a benchmark leaves beside its rows: tables and figures."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from teamformer.base.extras import how_to_install
from teamformer.base.whole_files import write_whole
from teamformer.bench.report.tables import EXPLANATION, summary_csv, summary_table
from teamformer.bench.rows import Row
from teamformer.bench.suites import Suite
from teamformer.bench.summary import on_shared_worlds, summarise
from teamformer.methods.by_name import BARE


def write_report(
    suite: Suite, rows: Sequence[Row], folder: Path, say: Callable[[str], None]
) -> Iterator[Path]:
    """Write tables and figures; yield each file. Without matplotlib the figures are left out.

    Tables are over all trials, figures over the worlds that all methods of a setting have run.
    """
    summaries = summarise(rows)
    report = folder / "report.md"
    heading = f"# {suite.name}: {suite.about}\n\n"
    write_whole(report, f"{heading}{summary_table(summaries)}\n{EXPLANATION}")
    yield report
    table = folder / "summary.csv"
    write_whole(table, summary_csv(summaries))
    yield table
    try:
        from teamformer.bench.report.figures import draw_anytime, draw_suite
    except ImportError:
        say(f"no figures: they need matplotlib; {how_to_install('plots')}")
        return
    yield from draw_suite(suite, summarise(on_shared_worlds(bare_if_run(rows))), folder)
    yield from draw_anytime(rows, folder)


def bare_if_run(rows: Sequence[Row]) -> list[Row]:
    """Leave out learned methods with their deadlock guard where they have run without it, too.

    The paper's policies have none.
    """
    played = {(row.setting, row.method) for row in rows}
    return [row for row in rows if (row.setting, row.method + BARE) not in played]
