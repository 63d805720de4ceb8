"""How methods do beside another one on the same worlds: the shared plan, the authors' heuristic."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from teamformer.bench.report.evidence import Evidence
from teamformer.bench.report.tables import markdown, number, plus_minus
from teamformer.bench.rows import Row
from teamformer.bench.runner import AUTHORS
from teamformer.bench.summary import Summary

OTHERS = ("crews", "heuristic", "teamformer")
"""What stands beside `plan`; the last one is learned."""


def steps_of(summary: Summary | None) -> str:
    """Return the mean makespan with its standard error."""
    return "" if summary is None else plus_minus(summary.makespan, summary.makespan.error)


def beside_the_plan(rows: Sequence[Row]) -> str:
    """Return how methods do beside the shared plan, on missions; nothing without rows."""
    evidence = Evidence(rows)
    settings = dict.fromkeys(summary.setting for summary in evidence.summaries)
    table = [[setting, *_beside_the_plan(evidence, setting)] for setting in settings]
    headers = ["setting", "worlds", "`plan`", *map("`{}`".format, OTHERS)]
    return markdown(headers, table, words=1) if table else ""


def _beside_the_plan(evidence: Evidence, setting: str) -> Iterator[str]:
    plan = evidence.summary(setting, "plan")
    yield "" if plan is None else str(plan.trials)
    for method in ("plan", *OTHERS):
        summary = evidence.summary(setting, method)
        saving = None if method == "plan" else evidence.saving(setting, method, "plan")
        more = "" if saving is None else f" ({-saving.value:+.0%})"
        has_cost = summary is not None and summary.cost.count > 0
        cost = f", cost {number(summary.cost.value)}" if summary and has_cost else ""
        failed = f", {summary.failures} failed" if summary and summary.failures else ""
        yield steps_of(summary) + more + cost + failed


def beside_the_authors(rows: Sequence[Row]) -> str:
    """Return how ours do beside the authors' heuristic, on their worlds; nothing without rows."""
    evidence = Evidence(rows)
    settings = dict.fromkeys(summary.setting for summary in evidence.summaries)
    methods = ("heuristic", "join-all", "teamformer")
    table = [[setting, *_beside(evidence, setting, methods)] for setting in settings]
    headers = ["setting", "worlds", AUTHORS, "it failed", *methods]
    return markdown(headers, table, words=1) if table else ""


def _beside(evidence: Evidence, setting: str, methods: Sequence[str]) -> Iterator[str]:
    theirs = evidence.summary(setting, AUTHORS)
    if theirs is not None:
        yield from (str(theirs.trials), steps_of(theirs), str(theirs.failures))
    for method in methods:
        ours, saving = evidence.summary(setting, method), evidence.saving(setting, method, AUTHORS)
        yield steps_of(ours) + ("" if saving is None else f" ({-saving.value:+.0%})")
