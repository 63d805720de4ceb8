"""`teamformer bench deviations`: what one deviation from the shared plan gains, by forks."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, closing
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from rich.table import Table

from teamformer.bench.executors import work_in_processes
from teamformer.bench.measurements.deviations.report import (
    COLUMNS,
    can_teach,
    table_of,
    verdict_on,
)
from teamformer.bench.measurements.deviations.trying import Tried, try_deviations
from teamformer.commands.compiling import announce_compiling
from teamformer.commands.console import Counting, err, out, prepare_folder, print_json, say
from teamformer.errors import TeamformerError
from teamformer.scenarios.named_settings import world_of

if TYPE_CHECKING:
    from teamformer.train.learning.critics import Taught

SETTINGS = ("real-needs", "real-places", "sparse-needs", "sparse-places")
TRIES = 10
"""Deviations in each world."""

ROWS, CURVES = "tried.jsonl", "curves.png"

Place = tuple[str, int]
"""A setting and the number of a world."""


class Asked(NamedTuple):
    """What to measure: so many worlds of each setting, from a first one on."""

    settings: Sequence[str]
    worlds: int
    first: int
    workers: int
    folder: Path | None


def bench_deviations(asked: Asked, as_json: bool) -> int:
    """Measure, teach critics and show; return the exit status."""
    for setting in asked.settings:
        if not world_of(setting, asked.first).has_surprises:
            hint = f"use settings such as {', '.join(SETTINGS)}"
            raise TeamformerError(f"in '{setting}' nothing is uncertain", hint)
    if asked.folder is not None:
        prepare_folder(asked.folder)
    tried: list[Tried] = []
    try:
        for rows in _measure_all(asked):
            tried += rows
            for row in rows if as_json else ():
                print_json(asdict(row))
    except KeyboardInterrupt:
        kept = "; what was tried is kept, run again to go on" if asked.folder else ""
        say(f"interrupted{kept}")
        return 1
    if not as_json:
        _show(tried)
    _teach(tried, asked.folder)
    return 0


def _measure_all(asked: Asked) -> Iterator[list[Tried]]:
    """Yield what was tried in each world, before or now."""
    places = [
        (setting, world)
        for world in range(asked.first, asked.first + asked.worlds)
        for setting in asked.settings
    ]
    known = {} if asked.folder is None else _read_rows(asked.folder / ROWS)
    yield from (known[place] for place in places if place in known)
    missing = [place for place in places if place not in known]
    announce_compiling(is_planned=True, has_shared_plan=True)
    with ExitStack() as stack:
        file = None
        if asked.folder is not None:
            file = stack.enter_context((asked.folder / ROWS).open("a", encoding="utf-8"))
        counting = stack.enter_context(Counting("worlds"))
        work = work_in_processes(partial(_try_at, tries=TRIES), missing, asked.workers)
        for done, (place, rows) in enumerate(stack.enter_context(closing(work)), 1):
            if file is not None:
                setting, world = place
                kept = {"setting": setting, "world": world, "tried": [asdict(row) for row in rows]}
                print(json.dumps(kept), file=file, flush=True)
            yield rows
            counting.update(done, len(missing))


def _try_at(place: Place, tries: int) -> tuple[Place, list[Tried]]:
    return place, try_deviations(*place, tries)


def _read_rows(path: Path) -> dict[Place, list[Tried]]:
    """Return what was tried into a folder before."""
    if not path.exists():
        return {}
    found = {}
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        try:
            row = json.loads(line)
            tried = [Tried(**it) for it in row["tried"]]
            found[str(row["setting"]), int(row["world"])] = tried
        except (ValueError, TypeError, KeyError):
            hint = "take the line out, or name another folder with --out"
            message = f"{path}:{number}: this is no row of `bench deviations`"
            raise TeamformerError(message, hint) from None
    return found


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
