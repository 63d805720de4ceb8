"""`teamformer bench others`: instances of others, methods of ours, and what is published."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TextIO

from rich.table import Table

from teamformer.base.errors import TeamformerError
from teamformer.base.extras import require
from teamformer.base.whole_files import write_whole
from teamformer.bench.others.instances import (
    Instance,
    collections_in,
    read_instances,
    reported_of,
)
from teamformer.bench.others.one_robot_worlds import draw_instances
from teamformer.bench.others.published import Reported, read_reported
from teamformer.bench.others.report import (
    COLUMNS,
    AllReported,
    collections,
    results_of,
    table_of_folders,
    table_of_means,
    write_report,
)
from teamformer.bench.others.results import Result, measure, result_of
from teamformer.bench.peers.names import LIBRARIES, PEERS
from teamformer.bench.peers.peer_plan import OutOfReachError
from teamformer.cli.terminal.console import Counting, prepare_folder, say, wide
from teamformer.planning.continuous.rules import PLANNERS, warm_up

ROWS, REPORT = "rows.jsonl", "report.md"

LEARNED = ("teamformer-tasks",)
"""Learned methods that give out tasks in continuous time, too; a folder of such a training does."""

WORLDS = 2
"""Worlds that are drawn of each setting, if not said otherwise."""


@dataclass(frozen=True)
class Asked:
    """What is to be measured: instances in folders, and worlds that are drawn, by settings."""

    folders: Sequence[Path]
    settings: Sequence[str] = ()
    worlds: int = WORLDS  # of each setting
    first_seed: int = 0

    def instances(self) -> list[Instance]:
        """Return all instances; raises `TeamformerError` if there is none."""
        drawn = draw_instances(self.settings, self.worlds, self.first_seed)
        return [*drawn, *(read_instances(self.folders) if self.folders or not drawn else ())]

    def reported(self) -> dict[str, tuple[Reported, ...]]:
        """Return what others report of each folder of instances."""
        inner = [path for folder in self.folders for path in collections_in(folder)]
        return {path.resolve().name: read_reported(path) + reported_of(path) for path in inner}


def bench_others(
    asked: Asked,
    methods: Sequence[str],
    time_limit: float,
    folder: Path | None,
    as_json: bool,
) -> int:
    """Measure and show; return the exit status."""
    methods = methods or tuple(PLANNERS)
    for method in methods:
        if method not in (*PLANNERS, *LEARNED, *PEERS) and not Path(method).is_dir():
            hint = f"use {', '.join((*PLANNERS, *LEARNED, *PEERS))}"
            raise TeamformerError(f"--methods {method} is unknown here", hint)
        if method in LIBRARIES:
            require("peers", LIBRARIES[method])
    instances, reported = asked.instances(), asked.reported()
    if folder is not None:
        prepare_folder(folder)
    known = [] if folder is None else _rows_in(folder / ROWS)
    results: list[Result] = []
    try:
        for result in _measure_all(instances, methods, time_limit, known, folder):
            results.append(result)
            if as_json:
                print(json.dumps(asdict(result)), flush=True)
    except KeyboardInterrupt:
        kept = f"; {folder / ROWS} has what was measured, run again to go on" if folder else ""
        say(f"interrupted{kept}")
        return 1
    if folder is not None:
        write_whole(folder / REPORT, write_report(results, reported))
        say(f"written: {folder / ROWS}, {folder / REPORT}")
    if not as_json:
        _show(results, reported)
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
                        print(json.dumps(asdict(result)), file=file, flush=True)
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


def _rows_in(path: Path) -> list[Result]:
    """Return what was measured into a folder before."""
    if not path.exists():
        return []
    results = []
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        try:
            results.append(result_of(json.loads(line)))
        except (KeyError, TypeError, ValueError):
            hint = "take the line out, or name another folder with --out"
            message = f"{path}:{number}: this is no row of `bench others`"
            raise TeamformerError(message, hint) from None
    return results


def _show(results: Sequence[Result], reported: AllReported) -> None:
    for collection in collections(results):
        rows = table_of_means(results_of(results, collection), reported)
        _print_table(COLUMNS, rows, collection)
    if len(collections(results)) > 1:
        title = "percent above the best published, in the mean"
        _print_table(*table_of_folders(results, reported), title)
    say("wins, ties and losses are against the best published makespan of each instance")


def _print_table(headers: Sequence[str], rows: Sequence[Sequence[str]], title: str) -> None:
    table = Table(*headers, box=None, title=title, title_justify="left")
    for row in rows:
        table.add_row(*row)
    wide.print(table)
