"""The report of `bench others`: for each collection means, every instance, and the curve."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from teamformer.bench.others.results import (
    Result,
    anytime_curve,
    compare,
    published_means,
)
from teamformer.bench.report.tables import markdown

COLUMNS = (
    *("method", "instances", "makespan or cost", "bound", "gap"),
    *("proven", "wins", "ties", "losses", "seconds"),
)


def write_report(results: Sequence[Result]) -> str:
    """Return the report as Markdown."""
    parts = ["# Other people's instances"]
    for collection in collections(results):
        parts += [f"## {collection}", *_sections(results_of(results, collection))]
    return "\n\n".join(parts) + "\n"


def collections(results: Sequence[Result]) -> list[str]:
    """Return the folders that were measured."""
    return list(dict.fromkeys(result.collection for result in results))


def results_of(results: Sequence[Result], collection: str) -> list[Result]:
    """Return the results of one folder's instances."""
    return [result for result in results if result.collection == collection]


def table_of_means(results: Sequence[Result]) -> list[list[str]]:
    """Return a row for each published method, and one for each method, as in `COLUMNS`."""
    rows = [
        [f"{name} (published)", "", f"{mean:.3f}", *[""] * (len(COLUMNS) - 3)]
        for name, mean in published_means(results).items()
    ]
    for method in dict.fromkeys(result.method for result in results):
        told = compare(results, method)
        is_bounded = told.bound > 0
        rows.append(
            [
                *(method, f"{told.instances}", f"{told.makespan:.3f}"),
                *(f"{told.bound:.3f}" if is_bounded else "", f"{told.gap:.1f}%" * is_bounded),
                *(f"{told.proven}" if is_bounded else "", f"{told.wins}", f"{told.ties}"),
                *(f"{told.losses}", f"{told.seconds:.2f}"),
            ]
        )
    return rows


def _sections(results: Sequence[Result]) -> Iterator[str]:
    limits = sorted({result.time_limit for result in results if result.method == "central"})
    had = f"; `central` had {limits[0]:g} s" if limits else ""
    yield (
        f"Means{had}. Wins, ties and losses are against the best published of each instance. "
        "Plans are told by their cost if the mission has one, others by their makespan."
    )
    yield markdown(COLUMNS, table_of_means(results), 1).rstrip()
    methods = list(dict.fromkeys(result.method for result in results))
    headers = ("instance", "best published", "bound", *methods)
    yield markdown(headers, _instances(results), 1).rstrip()
    curve = anytime_curve(results)
    if curve:
        yield "How good the plans of `central` are after so many seconds, in the mean:"
        yield markdown(
            ("seconds", "makespan or cost"), [(f"{s:g}", f"{m:.3f}") for s, m in curve], 0
        ).rstrip()


def _instances(results: Sequence[Result]) -> Iterator[list[str]]:
    methods = list(dict.fromkeys(result.method for result in results))
    for name in dict.fromkeys(result.instance for result in results):
        of_it = {result.method: result for result in results if result.instance == name}
        first = next(iter(of_it.values()))
        bound = max(result.bound for result in of_it.values())
        reached = [f"{of_it[p].makespan:.3f}" if p in of_it else "" for p in methods]
        best = "" if first.best is None else f"{first.best:.3f}"
        yield [name.split("/", 1)[1], best, f"{bound:.3f}" if bound else "", *reached]
