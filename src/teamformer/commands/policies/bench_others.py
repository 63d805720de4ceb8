"""`teamformer bench others`: instances of others, methods of ours, and what is published."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TextIO

from rich.table import Table

from teamformer.bench.others.instances import Instance, read_instances
from teamformer.bench.others.report import (
    COLUMNS,
    collections,
    results_of,
    table_of_means,
    write_report,
)
from teamformer.bench.others.results import Result, measure, result_of
from teamformer.bench.peers.names import LIBRARIES, PEERS
from teamformer.bench.peers.peer_plan import OutOfReachError
from teamformer.commands.console import Counting, out, prepare_folder, say
from teamformer.errors import TeamformerError
from teamformer.extras import require
from teamformer.mission.links import is_linked
from teamformer.planning.continuous.rules import LINKED_PLANNERS, PLANNERS, is_compiled, warm_up
from teamformer.whole_files import write_whole

ROWS, REPORT = "rows.jsonl", "report.md"


def bench_others(
    folders: Sequence[Path],
    methods: Sequence[str],
    time_limit: float,
    folder: Path | None,
    as_json: bool,
) -> int:
    """Measure and show; return the exit status."""
    is_asked = bool(methods)
    methods = methods or tuple(PLANNERS)
    for method in methods:
        if method not in (*PLANNERS, *PEERS):
            hint = f"use {', '.join((*PLANNERS, *PEERS))}"
            raise TeamformerError(f"--methods {method} is unknown here", hint)
        if method in LIBRARIES:
            require("peers", LIBRARIES[method])
    instances = read_instances(folders)
    if not is_asked and any(is_linked(instance.mission) for instance in instances):
        methods = tuple(LINKED_PLANNERS)
    if folder is not None:
        prepare_folder(folder)
    known = [] if folder is None else _rows_in(folder / ROWS)
    results: list[Result] = []
    try:
        for result in _measure_all(instances, methods, time_limit, known, folder):
            results.append(result)
            if as_json:
                print(json.dumps(_row(result)), flush=True)
    except KeyboardInterrupt:
        kept = f"; {folder / ROWS} has what was measured, run again to go on" if folder else ""
        say(f"interrupted{kept}")
        return 1
    if folder is not None:
        write_whole(folder / REPORT, write_report(results))
        say(f"written: {folder / ROWS}, {folder / REPORT}")
    if not as_json:
        _show(results)
    return 0


def _measure_all(
    instances: Sequence[Instance],
    methods: Sequence[str],
    time_limit: float,
    known: Sequence[Result],
    folder: Path | None,
) -> Iterator[Result]:
    """Plan every instance by every method, but for what was measured before."""
    before = {(result.instance, result.method, result.time_limit): result for result in known}
    if not is_compiled():
        say("compiling the planner, on the first run only (half a minute, more if busy) ...")
    warm_up()
    pairs = [(instance, method) for instance in instances for method in methods]
    file: TextIO | None = None if folder is None else (folder / ROWS).open("a", encoding="utf-8")
    try:
        with Counting("plans") as counting:
            for done, (instance, method) in enumerate(pairs, 1):
                result = before.get((instance.name, method, time_limit))
                if result is None:
                    result = _measured(instance, method, time_limit)
                    if file is not None and result is not None:
                        print(json.dumps(_row(result)), file=file, flush=True)
                if result is not None:
                    yield result
                counting.update(done, len(pairs))
    finally:
        if file is not None:
            file.close()


def _measured(instance: Instance, method: str, time_limit: float) -> Result | None:
    """Return what a method makes of an instance; if a peer makes nothing of it, that is said."""
    try:
        result = measure(instance, method, time_limit)
    except OutOfReachError as error:
        say(f"{instance.name}: {error}")
        return None
    if result is None:
        say(f"{instance.name}: {method} found no plan in {time_limit:g} s")
    return result


def _row(result: Result) -> dict[str, object]:
    return asdict(result)


def _rows_in(path: Path) -> list[Result]:
    """Return what was measured into a folder before."""
    if not path.exists():
        return []
    results = []
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        try:
            results.append(result_of(json.loads(line)))
        except (ValueError, TypeError, TeamformerError):
            hint = "take the line out, or name another folder with --out"
            message = f"{path}:{number}: this is no row of `bench others`"
            raise TeamformerError(message, hint) from None
    return results


def _show(results: Sequence[Result]) -> None:
    for collection in collections(results):
        table = Table(*COLUMNS, box=None, title=collection, title_justify="left")
        for row in table_of_means(results_of(results, collection)):
            table.add_row(*row)
        out.print(table)
    say("wins, ties and losses are against the best published makespan of each instance")
