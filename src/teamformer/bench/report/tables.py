"""Summaries as tables: for the terminal, as Markdown and as CSV."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable, Sequence

from teamformer.bench.statistics import Mean, Slope
from teamformer.bench.summary import BASELINES, CENTRAL, PLAN, Summary

HEADERS = (
    "setting",
    "method",
    "trials",
    "makespan",
    "failures",
    "with failures",
    "to heuristic",
    "to join-all",
    "inference, s",
    "to best",
    "to bound",
)
EXPLANATION = """\
- `makespan`: mean steps over completed trials ± standard error. `cost`: the same of the cost, for
  missions that have one. `with failures`: over all trials; a failure counts as its step limit.
- `missed`: the weight of the tasks that were missed, over all trials, for missions with `until`.
- `failures`: how many trials failed, and the 95% interval of the rate (Wilson).
- `to heuristic`, `to join-all`: mean difference on the same worlds, both completed, with its 95%
  interval (paired, Student's t). `to central`: the same to the central planner, as a part of its
  mean, and `to plan` to the shared plan where that has not planned; `cost to central`: that of
  costs. `room won`: of the steps between `plan@needed`, which plans as if everything that may be
  needed were needed, and `central`, which knows the truth, the part that the method wins, on the
  same worlds, with its 95% interval.
- `inference`: CPU seconds that the method takes to complete a trial, mean ± standard deviation,
  over completed ones of the first 50 trials of a setting, which run alone, one after the other, one
  thread each (all others share batches and are not timed).
- `to best`, `to bound`: by how much the makespan is above the best one known of the same world, by
  any method here, and above what is proven that no plan can beat. If `central` planned worlds of a
  setting, only those count.
"""


def cells_of(summary: Summary, headers: Sequence[str] = HEADERS) -> list[str]:
    """Return the cells of a table's row."""
    low, high = summary.failure_interval
    cells = {
        "setting": summary.setting,
        "method": summary.method,
        "trials": str(summary.trials),
        "makespan": plus_minus(summary.makespan, summary.makespan.error),
        "failures": f"{summary.failures} ({100 * low:.1f}-{100 * high:.1f}%)",
        "with failures": number(summary.steps.value),
        "cost": plus_minus(summary.cost, summary.cost.error),
        "missed": plus_minus(summary.missed, summary.missed.error),
        "cost to central": percent_interval(summary.cost_to_central),
        "to central": percent_interval(summary.to_central),
        "to plan": percent_interval(summary.to_plan),
        "room won": percent_interval(summary.room),
        "inference, s": seconds(summary.inference),
        "to best": percent(summary.to_best),
        "to bound": percent(summary.to_bound),
    }
    for bar in BASELINES:
        difference = summary.against.get(bar)
        cells[f"to {bar}"] = "" if difference is None else interval(difference)
    return [cells[header] for header in headers]


def headers_for(summaries: Sequence[Summary]) -> list[str]:
    """Return the columns that have something in them."""
    headers = list(HEADERS)
    if any("authors-heuristic" in summary.against for summary in summaries):
        headers.insert(headers.index("to join-all") + 1, "to authors-heuristic")
    if any(summary.to_central.count for summary in summaries if summary.method != CENTRAL):
        headers.insert(headers.index("inference, s"), "to central")
    if any(summary.to_plan.count for summary in summaries if summary.method != PLAN):
        headers.insert(headers.index("inference, s"), "to plan")
    if any(summary.cost.count for summary in summaries):
        headers.insert(headers.index("failures"), "cost")
    if any(summary.missed.count for summary in summaries):
        headers.insert(headers.index("failures"), "missed")
    if any(summary.cost_to_central.count for summary in summaries if summary.method != CENTRAL):
        headers.insert(headers.index("inference, s"), "cost to central")
    if any(summary.room.count for summary in summaries):
        headers.insert(headers.index("inference, s"), "room won")
    return headers


def markdown(headers: Sequence[str], rows: Iterable[Sequence[str]], words: int = 2) -> str:
    """Return a Markdown table whose first columns are words, to the left; numbers to the right."""
    dashes = ["---"] * words + ["---:"] * (len(headers) - words)
    return "".join(f"{_line(cells)}\n" for cells in [headers, dashes, *rows])


def summary_table(summaries: Sequence[Summary]) -> str:
    """Return the summaries as a Markdown table."""
    headers = headers_for(summaries)
    return markdown(headers, [cells_of(summary, headers) for summary in summaries])


def summary_csv(summaries: Iterable[Summary]) -> str:
    """Return all numbers of the summaries, one line each."""
    text = io.StringIO()
    lines = [_numbers(summary) for summary in summaries]
    writer = csv.DictWriter(text, list(lines[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(lines)
    return text.getvalue()


def _numbers(summary: Summary) -> dict[str, str | int | float]:
    low, high = summary.failure_interval
    numbers: dict[str, str | int | float] = {
        "setting": summary.setting,
        "method": summary.method,
        "trials": summary.trials,
        "failures": summary.failures,
        "failure_rate_low": low,
        "failure_rate_high": high,
        "makespan_mean": summary.makespan.value,
        "makespan_error": summary.makespan.error,
        "cost_mean": summary.cost.value,
        "cost_error": summary.cost.error,
        "missed_mean": summary.missed.value,
        "missed_error": summary.missed.error,
        "steps_mean_with_failures": summary.steps.value,
        "illegal_decisions": summary.illegal,
        "inference_cpu_seconds_mean": summary.inference.value,
        "inference_cpu_seconds_deviation": summary.inference.deviation,
        "inference_seconds_mean": summary.waiting.value,
        "inference_seconds_deviation": summary.waiting.deviation,
        "timed_trials": summary.inference.count,
        "to_central": summary.to_central.value,
        "to_central_half_width": summary.to_central.half_width,
        "to_plan": summary.to_plan.value,
        "to_plan_half_width": summary.to_plan.half_width,
        "cost_to_central": summary.cost_to_central.value,
        "cost_to_central_half_width": summary.cost_to_central.half_width,
        "room_won": summary.room.value,
        "room_won_half_width": summary.room.half_width,
        "to_best_known": summary.to_best.value,
        "to_lower_bound": summary.to_bound.value,
        "steps_to_list_schedule": summary.to_list.value,
        "lower_bound_mean": summary.lower_bound.value,
        "best_known_mean": summary.best_known.value,
        "list_schedule_mean": summary.list_schedule.value,
        "relaxed_mean": summary.relaxed.value,
        "relaxed_proven": summary.proven,
    }
    for bar in BASELINES:
        difference = summary.against.get(bar)
        numbers |= {
            f"{bar}_difference": difference.value if difference else "",
            f"{bar}_half_width": difference.half_width if difference else "",
            f"{bar}_pairs": difference.count if difference else "",
        }
    return {key: _blank(value) for key, value in numbers.items()}


def _blank(value: str | int | float) -> str | int | float:
    if not isinstance(value, float):
        return value
    return "" if math.isnan(value) else round(value, 6)


def _line(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"


def number(value: float) -> str:
    """Return a number with one decimal; nothing for what is not known."""
    return "" if math.isnan(value) else f"{value:.1f}"


def plus_minus(mean: Mean, spread: float) -> str:
    """Return a mean and its spread."""
    return number(mean.value) + ("" if math.isnan(spread) else f" ± {spread:.1f}")


def interval(difference: Mean | Slope) -> str:
    """Return a difference with its 95% interval."""
    if difference.count == 0:
        return ""
    value, reach = difference.value, difference.half_width
    if math.isnan(reach):
        return f"{value:+.1f}"
    return f"{value:+.1f} ({value - reach:+.1f} to {value + reach:+.1f})"


def percent(mean: Mean) -> str:
    """Return a share as percent."""
    return "" if math.isnan(mean.value) else f"{100 * mean.value:+.0f}%"


def percent_interval(mean: Mean) -> str:
    """Return a share as percent with its 95% interval."""
    reach = mean.half_width
    if mean.count == 0 or math.isnan(reach):
        return percent(mean)
    low, high = 100 * (mean.value - reach), 100 * (mean.value + reach)
    return f"{100 * mean.value:+.1f}% ({low:+.1f} to {high:+.1f})"


def seconds(mean: Mean) -> str:
    """Return a time with its standard deviation, three digits of it."""
    if math.isnan(mean.value):
        return ""
    digits = 3 if mean.value < 1 else 2
    if mean.value < 0.01:
        digits = 4
    spread = "" if math.isnan(mean.deviation) else f" ± {mean.deviation:.{digits}f}"
    return f"{mean.value:.{digits}f}{spread}"
