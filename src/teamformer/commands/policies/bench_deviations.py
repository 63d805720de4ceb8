"""`teamformer bench deviations`: what one deviation from the shared plan gains, by forks."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from rich.table import Table

from teamformer.bench.measurements.deviations.report import (
    COLUMNS,
    can_teach,
    table_of,
    verdict_on,
)
from teamformer.bench.measurements.deviations.trying import Tried, try_deviations
from teamformer.commands.console import err, out, say
from teamformer.commands.policies.rows_by_world import Asked, Measurement, measure_worlds

if TYPE_CHECKING:
    from teamformer.train.learning.critics import Taught

TRIES = 10
"""Deviations in each world."""

ROWS, CURVES = "tried.jsonl", "curves.png"

DEVIATIONS = Measurement("deviations", ROWS, Tried, partial(try_deviations, tries=TRIES))


def bench_deviations(asked: Asked, as_json: bool) -> int:
    """Measure, teach critics and show; return the exit status."""
    tried = measure_worlds(asked, DEVIATIONS, as_json)
    if tried is None:
        return 1
    if not as_json:
        _show(tried)
    _teach(tried, asked.folder)
    return 0


def _show(tried: Sequence[Tried]) -> None:
    table = Table(*COLUMNS, box=None, header_style="dim")
    for row in table_of(tried):
        table.add_row(*row, style="bold" if row[1] == "all" else "")
    out.print(table)


def _teach(tried: Sequence[Tried], folder: Path | None) -> None:
    """Teach critics what deviations gain, and say what they are worth."""
    if not can_teach(tried):
        err.print(
            "too little was tried to teach a network and test it on other worlds: more --trials"
        )
        return
    from teamformer.train.learning.critics import teach_critics

    features, gain, fold = (
        np.array([getattr(row, part) for row in tried]) for part in ("features", "gain", "fold")
    )
    taught = teach_critics(features, gain, fold)
    for sentence in verdict_on(tried, *taught):
        say(sentence)
    if folder is not None:
        say(f"written: {folder / ROWS}")
        _draw(taught, folder / CURVES)


def _draw(taught: Taught, path: Path) -> None:
    try:
        from teamformer.bench.report.figures import draw_learning
    except ImportError:
        say("no figure: that needs Matplotlib, pip install 'teamformer[plots]'")
        return
    draw_learning(taught.learned, taught.unseen, path)
    say(f"written: {path}")
