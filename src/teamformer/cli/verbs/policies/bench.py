"""`teamformer bench`: measurements, never tests."""

from __future__ import annotations

import shlex
import sys
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from rich.table import Table
from rich.text import Text

from teamformer.base.errors import TeamformerError
from teamformer.base.extras import require
from teamformer.bench.executors import chosen_engine
from teamformer.bench.jobs import ready_method
from teamformer.bench.report.files import write_report
from teamformer.bench.report.results import write_results
from teamformer.bench.report.tables import cells_of, headers_for
from teamformer.bench.rows import Row
from teamformer.bench.runner import AUTHORS, Request, fitting_cells, run_benchmark
from teamformer.bench.store import Store, folders_beside
from teamformer.bench.suites import Suite, load_suite, player_of
from teamformer.bench.summary import Summary, summarise
from teamformer.cli.terminal.compiling import compile_ahead
from teamformer.cli.terminal.console import (
    Counting,
    err,
    out,
    prepare_file,
    prepare_folder,
    print_json,
    processors,
    say,
    wide,
)
from teamformer.cli.verbs.policies.bench_others import WORLDS, Asked, bench_others
from teamformer.files.imports.authors import read_worlds
from teamformer.methods.by_name import Method


@dataclass(frozen=True)
class BenchOptions:
    """What the command line says; None leaves it to the suite."""

    trials: int | None = None
    seed: int = 0
    time_limit: float | None = None
    methods: tuple[str, ...] = ()
    settings: tuple[str, ...] = ()
    worlds: tuple[Path, ...] = ()
    workers: int | None = None
    folder: Path | None = None
    results: Path | None = None


def bench(suite_name: str, options: BenchOptions, as_json: bool) -> int:
    """Measure and show; return the exit status."""
    if suite_name == "speed":
        if options.folder is not None:
            raise TeamformerError("`bench speed` writes nothing", "leave out --out, or use --json")
        return _measure_speed(as_json)
    if suite_name == "size":
        if options.folder is not None:
            prepare_folder(options.folder)
        return _measure_size(options.folder, as_json)
    if suite_name == "others":
        limit = 10.0 if options.time_limit is None else options.time_limit
        worlds = options.trials or WORLDS
        asked = Asked(options.worlds, options.settings, worlds, options.seed)
        return bench_others(asked, options.methods, limit, options.folder, as_json)
    if suite_name == "robotarium":
        return _fly_missions(options, as_json)
    if suite_name == "fleet":
        return _rehearse_worlds(options, as_json)
    request = _request(load_suite(suite_name), options)
    if options.folder is not None:
        prepare_folder(options.folder)
    if options.results is not None:
        _prepare_results(options)
    try:
        rows = _measure(request, options)
    except KeyboardInterrupt:
        kept = f"; the rows so far are in {options.folder}, and the same command goes on from there"
        say(f"interrupted{kept if options.folder else ''}")
        return 1
    if options.results is not None and options.folder is not None:
        folders = (options.folder, *folders_beside(options.folder))
        write_results(options.results, _command_line(), folders)
        say(f"written: {options.results}")
    _show(rows, as_json)
    return 0


def _measure(request: Request, options: BenchOptions) -> list[Row]:
    """Run what is missing, write tables and figures, and return all rows."""
    place = TemporaryDirectory() if options.folder is None else nullcontext(options.folder)
    with place as folder, Store(Path(folder), request.about, say) as store:
        compile_ahead(_to_compile(request))
        with Counting("trials") as counting:
            run_benchmark(request, store, chosen_engine(), say, counting.update)
        rows = list(store.rows.values())
        if options.folder is not None:
            for path in write_report(request.suite, rows, options.folder, say):
                say(f"written: {path}")
    return rows


def _to_compile(request: Request) -> list[Method]:
    """Return the methods that will run, each once."""
    fitting = {player_of(method) for _, method in fitting_cells(request, lambda _: None)}
    return [ready_method(name, request.time_limit) for name in sorted(fitting - {AUTHORS})]


def _prepare_results(options: BenchOptions) -> None:
    """Refuse what could not be written in the end before any work is done."""
    if options.folder is None:
        raise TeamformerError("--report needs a folder for the rows", "add --out FOLDER")
    if options.results is not None:
        prepare_file(options.results)
    folders_beside(options.folder)


def _command_line() -> str:
    return shlex.join(["teamformer", *sys.argv[1:]])


def _request(suite: Suite, options: BenchOptions) -> Request:
    worlds = {path: read_worlds(path)[0].setting for path in _files(options.worlds)}
    settings = options.settings or tuple(worlds.values())
    if suite.name == "authors" and not worlds:
        hint = "name their files: teamformer bench authors FILE"
        raise TeamformerError("the suite 'authors' needs its worlds", hint)
    for setting in settings:
        if setting not in suite.settings:
            hint = f"it has {', '.join(suite.settings)}"
            raise TeamformerError(f"suite '{suite.name}' has no setting '{setting}'", hint)
    limit = suite.time_limit if options.time_limit is None else options.time_limit
    return Request(
        suite=suite,
        trials=options.trials or suite.trials,
        first_seed=options.seed,
        time_limit=limit,
        methods=options.methods,
        settings=settings,
        workers=options.workers or processors(),
        worlds={setting: path.resolve() for path, setting in worlds.items()},
    )


def _files(paths: tuple[Path, ...]) -> list[Path]:
    """Return files, with those in a folder in its place."""
    return [
        file
        for path in paths
        for file in (sorted(path.glob("*.jsonl")) if path.is_dir() else [path])
    ]


def _show(rows: list[Row], as_json: bool) -> None:
    if as_json:
        for row in rows:
            print_json(vars(row))
        return
    summaries = summarise(rows)
    for setting in dict.fromkeys(summary.setting for summary in summaries):
        out.print(Text(setting, style="bold"))
        wide.print(_table([s for s in summaries if s.setting == setting]))


def _table(summaries: list[Summary]) -> Table:
    headers = [header for header in headers_for(summaries) if header != "setting"]
    table = Table(box=None, header_style="dim")
    for header in headers:
        table.add_column(header, justify="left" if header == "method" else "right")
    for summary in summaries:
        table.add_row(*cells_of(summary, headers))
    return table


def _fly_missions(options: BenchOptions, as_json: bool) -> int:
    require("robotarium")
    from teamformer.cli.verbs.robots.robotarium import fly_missions

    method = options.methods[0] if options.methods else "plan"
    return fly_missions(options.trials or 100, method, options.seed, options.folder, as_json)


def _rehearse_worlds(options: BenchOptions, as_json: bool) -> int:
    from teamformer.cli.verbs.robots.bench_fleet import rehearse_worlds

    asked = (options.settings, options.trials or 6, options.seed, options.folder)
    return rehearse_worlds(*asked, as_json)


def _measure_speed(as_json: bool) -> int:
    from teamformer.bench.measurements.speed import measure_speed

    table = Table("what", "figure", "unit", box=None, header_style="dim")
    for row in measure_speed():
        if as_json:
            print_json({"suite": "speed", **vars(row)})
        else:
            err.print(f"{row.setting} ...", markup=False)
            table.add_row(row.setting, f"{row.value:,.4g}", row.unit)
    if not as_json:
        out.print(table)
    return 0


def _measure_size(folder: Path | None, as_json: bool) -> int:
    from teamformer.bench.measurements.size import measure_size

    table = Table(box=None, header_style="dim")
    for header in ("method", "robots, tasks", "makespan", "run, s", "MB", "check, s", "MB"):
        table.add_column(header, justify="right")
    rows = []
    for row in measure_size():
        rows.append(row)
        if as_json:
            print_json({"suite": "size", **vars(row)})
        else:
            err.print(f"{row.count} robots by {row.method} ...", markup=False)
            taken = (row.run_seconds, row.run_megabytes, row.check_seconds, row.check_megabytes)
            table.add_row(
                row.method, str(row.count), str(row.makespan), *(f"{value:.3g}" for value in taken)
            )
    if not as_json:
        out.print(table)
    if folder is not None:
        from teamformer.bench.report.figures import draw_size

        say(f"written: {draw_size(rows, folder)}")
    return 0
