"""Figures like the paper's: bars with standard errors, and growth curves on logarithmic axes."""

from __future__ import annotations

import math
import re
import textwrap
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator

from teamformer.bench.measurements.anytime import anytime_curves
from teamformer.bench.measurements.size import SizeRow
from teamformer.bench.rows import Row
from teamformer.bench.statistics import growth_exponent
from teamformer.bench.suites import Suite
from teamformer.bench.summary import Summary
from teamformer.files.drawn.named_settings import spec_of
from teamformer.methods.by_name import BARE

# Okabe and Ito's colours, which colour-blind readers can tell apart.
FAMILIES = {
    "teamformer-c": "#0072b2",
    "teamformer": "#56b4e9",
    "deepset-c": "#e69f00",
    "gnn-c": "#cc79a7",
    "heuristic": "#d55e00",
    "authors-heuristic": "#8c3b00",
    "join-all": "#009e73",
    "join-fitting": "#66c2a5",
    "crews": "#f0e442",
    "central": "#444444",
}
MARKERS = {"c8": "s", "c100": "^"}  # of networks that differ in their number of capabilities only
OTHERS = ("#999999", "#7f6000", "#5e3c99", "#b2182b", "#1a9850", "#8073ac")
RESOLUTION = 150  # dots an inch
LETTERS_AN_INCH = 13  # of a title
INCHES_A_NAME = 1.6  # of a legend
_NOTE: dict[str, Any] = {"textcoords": "offset points", "fontsize": 6.5, "color": "#333333"}


def draw_suite(suite: Suite, summaries: Sequence[Summary], folder: Path) -> Iterator[Path]:
    """Draw every figure of a suite for which there are trials; yield the files."""
    for part in suite.figures:
        wanted = [summary for summary in summaries if summary.setting in part.settings]
        if wanted:
            figure = _curves(part, wanted) if part.axes else _bars(part, wanted)
            path = folder / f"{part.name}.png"
            figure.savefig(path)
            yield path


def draw_anytime(rows: Sequence[Row], folder: Path) -> Iterator[Path]:
    """Draw how plans come closer to the bound while the planner works; yield the file, if any."""
    curves = anytime_curves(rows)
    if not curves:
        return
    title = "central: best plan so far, as a multiple of the lower bound; means over worlds"
    figure, [axes] = _begin(title, 1, width=7.0)
    for place, (setting, (seconds, ratios)) in enumerate(curves.items()):
        stroke = ("-", "--", ":")[place // 10 % 3]
        axes.plot(seconds, ratios, label=setting, color=f"C{place % 10}", linestyle=stroke)
        axes.annotate(f"{ratios[-1]:.2f}", (seconds[-1], ratios[-1]), (3, -2), **_NOTE)
    axes.set_xlabel("seconds of planning")
    axes.set_ylabel("makespan / lower bound")
    axes.set_xlim(left=0.0)
    _finish(figure, axes)
    path = folder / "anytime.png"
    figure.savefig(path)
    yield path


def draw_size(rows: Sequence[SizeRow], folder: Path) -> Path:
    """Draw how time and memory of running and judging grow with a mission; return the file."""
    title = "run and check against size: as many robots as tasks, each of which needs 3 of 8 skills"
    figure, panels = _begin(title, 2, columns=2, width=8.4)
    labels = ("seconds of one core", "MB at most")
    for axes, label, what in zip(panels, labels, ("seconds", "megabytes"), strict=True):
        for command, stroke in (("run", "-"), ("check", ":")):
            for method in dict.fromkeys(row.method for row in rows):
                points = [(r.count, getattr(r, f"{command}_{what}")) for r in rows
                          if r.method == method]  # fmt: skip
                counts, values = zip(*points, strict=True)
                name = f"{command}, {method}"
                axes.plot(counts, values, stroke, color=colour_of(method), label=name, marker=".")
        _scale(axes, sorted({row.count for row in rows}))
        axes.set_xlabel("robots, and as many tasks")
        axes.set_ylabel(label)
    _finish(figure, panels[0])
    path = folder / "size.png"
    figure.savefig(path)
    return path


def _bars(part: Suite, summaries: Sequence[Summary]) -> Figure:
    """Draw mean makespans with standard errors, a group of bars for each setting."""
    settings = [s for s in part.settings if any(summary.setting == s for summary in summaries)]
    methods = list(dict.fromkeys(summary.method for summary in summaries))
    title = f"{part.about}; {_worlds(summaries)}"
    figure, [axes] = _begin(title, 1, width=max(5.0, 1.5 + 0.45 * len(summaries)))
    width = 0.8 / len(methods)
    for summary in summaries:
        middle = settings.index(summary.setting)
        place = methods.index(summary.method)
        left = middle - 0.4 + (place + 0.5) * width
        _bar(axes, summary, left, width)
    for middle, setting in enumerate(settings):
        _draw_bars_to_beat(axes, [s for s in summaries if s.setting == setting], middle)
    axes.set_xticks(range(len(settings)), settings)
    axes.set_ylabel("mean makespan, steps")
    _finish(figure, axes)
    return figure


def _worlds(summaries: Sequence[Summary]) -> str:
    """Say over how many worlds the bars are."""
    counts = sorted({summary.trials for summary in summaries})
    many = " to ".join(str(count) for count in dict.fromkeys((counts[0], counts[-1])))
    return f"{many} worlds, the same for all methods"


def _bar(axes: Axes, summary: Summary, left: float, width: float) -> None:
    mean = summary.makespan
    colour = colour_of(summary.method)
    height = 0.0 if math.isnan(mean.value) else mean.value
    error = 0.0 if math.isnan(mean.error) else mean.error
    axes.bar(left, height, width * 0.92, yerr=error, color=colour, label=summary.method, capsize=2)
    told = f"{height:.0f}" if height >= 100 else f"{height:.1f}"
    if summary.failures:
        told += f"\n{summary.failures} failed"
    axes.annotate(told, (left, height + error), (0, 2), ha="center", **_NOTE)


def _draw_bars_to_beat(axes: Axes, summaries: Sequence[Summary], middle: int) -> None:
    """Draw what nobody can beat, and the best that is known, across a group."""
    lines = (("lower bound", "lower_bound", ":"), ("best known", "best_known", "--"))
    for label, name, style in lines:
        value = getattr(summaries[0], name).value
        if not math.isnan(value):
            ends = (middle - 0.42, middle + 0.42)
            axes.hlines(value, *ends, color="black", linestyle=style, linewidth=1, label=label)


MEASURES = (("makespan, steps", "makespan"), ("inference for a trial, CPU s", "inference"))


def _curves(part: Suite, summaries: Sequence[Summary]) -> Figure:
    """Draw makespan and inference time along each axis, with fitted growth exponents."""
    count = len(part.axes)
    figure, panels = _begin(part.about, 2 * count, columns=count, width=4.2 * count, height=7.0)
    for column, (axis, settings) in enumerate(part.axes.items()):
        for row, (label, measure) in enumerate(MEASURES):
            axes = panels[row * count + column]
            for method in dict.fromkeys(summary.method for summary in summaries):
                mine = [s for s in summaries if s.method == method and s.setting in settings]
                points = {
                    getattr(spec_of(s.setting), axis): getattr(s, measure).value
                    for s in mine
                    if not math.isnan(getattr(s, measure).value)
                }
                _curve(axes, method, points)
            _scale(axes, sorted({getattr(spec_of(setting), axis) for setting in settings}))
            axes.set_xlabel(axis)
            axes.set_ylabel(label)
            if axes.lines:
                axes.legend(fontsize=7, framealpha=0.85, edgecolor="none")
    return figure


def _scale(axes: Axes, sizes: Sequence[int]) -> None:
    """Make both axes logarithmic, with plain numbers on them."""
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xticks(sizes, [str(size) for size in sizes])
    axes.minorticks_off()
    axes.yaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axes.yaxis.set_major_formatter("{x:g}")


def _curve(axes: Axes, method: str, points: dict[int, float]) -> None:
    if not points:
        return
    sizes, values = zip(*sorted(points.items()), strict=True)
    exponent = growth_exponent(sizes, values)
    label = method if math.isnan(exponent) else f"{method}: n^{exponent:.2f}"
    marker = next((MARKERS[part] for part in method.split("-") if part in MARKERS), "o")
    axes.plot(sizes, values, color=colour_of(method), label=label, marker=marker, markersize=4)


def colour_of(method: str) -> str:
    """Return the colour of a method, the same in every figure."""
    family = re.sub(r"-c\d+(-.*)?$", "-c", method.removesuffix(BARE))
    if family in FAMILIES:
        return FAMILIES[family]
    return OTHERS[sum(method.encode()) % len(OTHERS)]


def _begin(
    title: str, panels: int, columns: int = 1, width: float = 5.0, height: float = 4.0
) -> tuple[Figure, list[Axes]]:
    figure = Figure(figsize=(width, height), dpi=RESOLUTION, layout="constrained")
    letters = int(width * LETTERS_AN_INCH)
    figure.suptitle("\n".join(textwrap.wrap(title, letters)), fontsize=10)
    axes = [figure.add_subplot(panels // columns, columns, n + 1) for n in range(panels)]
    for each in axes:
        each.spines[["top", "right"]].set_visible(False)
    return figure, axes


def _finish(figure: Figure, axes: Axes) -> None:
    """Add the legend, each method once, under the figure."""
    handles, labels = axes.get_legend_handles_labels()
    unique = dict(zip(labels, handles, strict=True))
    figure.legend(
        list(unique.values()),
        list(unique),
        loc="outside lower center",
        ncols=max(1, int(figure.get_figwidth() / INCHES_A_NAME)),
        fontsize=8,
        frameon=False,
    )
