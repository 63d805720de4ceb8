"""The report of `bench others`: for each collection means, every instance, and the curve."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from statistics import fmean

from teamformer.bench.others.published import Reported
from teamformer.bench.others.results import (
    Result,
    anytime_curve,
    compare,
    mean_percent_above_best,
    percent_above_optimum,
    published_means,
)
from teamformer.bench.report.tables import markdown

COLUMNS = (
    *("method", "instances", "makespan or cost", "above best", "bound", "gap"),
    *("proven", "wins", "ties", "losses", "threads", "seconds", "processor seconds"),
)

AllReported = Mapping[str, Sequence[Reported]]
"""What others report of each folder."""


def write_report(results: Sequence[Result], reported: AllReported) -> str:
    """Return the report as Markdown."""
    parts = ["# Other people's instances"]
    if len(collections(results)) > 1:
        parts.append("Percent above the best published, in the mean over each folder's instances:")
        parts.append(markdown(*table_of_folders(results, reported), 1).rstrip())
    for collection in collections(results):
        parts += [f"## {collection}", *_sections(results_of(results, collection), reported)]
    return "\n\n".join(parts) + "\n"


def collections(results: Sequence[Result]) -> list[str]:
    """Return the folders that were measured."""
    return list(dict.fromkeys(result.collection for result in results))


def results_of(results: Sequence[Result], collection: str) -> list[Result]:
    """Return the results of one folder's instances."""
    return [result for result in results if result.collection == collection]


def table_of_means(results: Sequence[Result], reported: AllReported) -> list[list[str]]:
    """Return the rows of one folder, as in `COLUMNS`.

    There is one for each published method, each mean that others report, and each method.
    """
    rows = [
        [f"{name} (published)", "", f"{mean:.3f}", *[""] * (len(COLUMNS) - 3)]
        for name, mean in published_means(results).items()
    ]
    rows += [
        [
            *(f"{each.method} (reported)", "", ""),
            *("" if each.is_gap else f"{each.percent:.1f}%", ""),
            *(f"{each.percent:.1f}%" if each.is_gap else "", *[""] * 4),
            *("" if cost is None else f"{cost:g}" for cost in (each.cores, each.seconds)),
            "",
        ]
        for each in reported.get(results[0].collection, ())
    ]
    for method in methods_of(results):
        told = compare(results, method)
        is_bounded = told.gap > 0 or told.proven > 0
        rows.append(
            [
                *(method, f"{told.instances}", f"{told.makespan:.3f}"),
                _percent(told.percent_above_best),
                *(f"{told.bound:.3f}" if told.bound > 0 else "", f"{told.gap:.1f}%" * is_bounded),
                *(f"{told.proven}" if is_bounded else "", f"{told.wins}", f"{told.ties}"),
                *(f"{told.losses}", f"{told.threads}", f"{told.seconds:.2f}"),
                f"{told.processor_seconds:.2f}",
            ]
        )
    return rows


def table_of_folders(
    results: Sequence[Result], reported: AllReported
) -> tuple[list[str], list[list[str]]]:
    """Return headers and rows: percent above the best published by folder, and their means.

    What others report is beside it; the folders' means weigh alike in the last row.
    """
    methods, folders = methods_of(results), collections(results)
    theirs = list(dict.fromkeys(each.label for f in folders for each in reported.get(f, ())))
    table: list[list[float | None]] = []
    for folder in folders:
        mine = [each for each in results if each.collection == folder]
        told = {each.label: each.percent for each in reported.get(folder, ())}
        own = [_percent_above(mine, method) for method in methods]
        table.append([*own, *(told.get(name) for name in theirs)])
    rows = [[name, *map(_percent, row)] for name, row in zip(folders, table, strict=True)]
    rows.append(["mean", *(_percent(_mean_of_all(column)) for column in zip(*table, strict=True))])
    return ["folder", *methods, *theirs], rows


def _percent_above(results: Sequence[Result], method: str) -> float | None:
    """Return how far a method is above the best published or, without any, above proven optima."""
    above = mean_percent_above_best([each for each in results if each.method == method])
    return percent_above_optimum(results, method) if above is None else above


def methods_of(results: Sequence[Result]) -> list[str]:
    """Return the methods that were measured."""
    return list(dict.fromkeys(result.method for result in results))


def _mean_of_all(column: Sequence[float | None]) -> float | None:
    """Return the mean of a column; None if something is missing in it."""
    known = [each for each in column if each is not None]
    return fmean(known) if known and len(known) == len(column) else None


def _percent(value: float | None) -> str:
    return "" if value is None else f"{value:.1f}%"


def _sections(results: Sequence[Result], reported: AllReported) -> Iterator[str]:
    limits = sorted({result.time_limit for result in results if result.method == "central"})
    had = f"; `central` had {limits[0]:g} s" if limits else ""
    yield (
        f"Means{had}. Wins, ties and losses are against the best published of each instance. "
        "Plans are told by their cost if the mission has one, by the prizes that they miss if "
        "tasks are optional, and others by their makespan; above the best are then percent of the "
        "best published prize. "
        "Processor seconds are those of all threads together: fewer than the seconds if the "
        "machine was busy."
    )
    yield markdown(COLUMNS, table_of_means(results, reported), 1).rstrip()
    methods = methods_of(results)
    headers = ("instance", "best published", "bound", *methods)
    yield markdown(headers, _instances(results), 1).rstrip()
    curve = anytime_curve(results)
    if curve:
        yield "How good the plans of `central` are after so many seconds, in the mean:"
        yield markdown(
            ("seconds", "makespan or cost"), [(f"{s:g}", f"{m:.3f}") for s, m in curve], 0
        ).rstrip()


def _instances(results: Sequence[Result]) -> Iterator[list[str]]:
    methods = methods_of(results)
    for name in dict.fromkeys(result.instance for result in results):
        of_it = {result.method: result for result in results if result.instance == name}
        first = next(iter(of_it.values()))
        bound = max(result.bound for result in of_it.values())
        reached = [f"{of_it[p].makespan:.3f}" if p in of_it else "" for p in methods]
        best = "" if first.best is None else f"{first.best:.3f}"
        yield [name.split("/", 1)[1], best, f"{bound:.3f}" if bound else "", *reached]
