"""The page of a plan: a row for each robot, its ways, waits and tasks along the time."""

from __future__ import annotations

import html
import math
from collections.abc import Mapping, Sequence
from itertools import groupby, zip_longest
from operator import itemgetter
from pathlib import Path
from typing import Any

from teamformer.base.whole_files import write_whole
from teamformer.viewer.html import plan_page
from teamformer.viewer.plan_table import STYLE_OF_TABLE, table_of_tasks

ROW, BAR, LABEL, WIDTH, TOP = 26, 16, 110, 1100, 34
"""Sizes in pixels: of a row, a bar, the robots' names, the time, the axis."""

LETTER, LONGEST_NAME = 7, 15
"""Pixels of a letter, and letters of a robot's name that there is room for."""

STYLE = """
body{font:14px/1.4 system-ui,sans-serif;margin:24px;color:#1d2733;background:#fff}
h1{font-size:20px;margin:0 0 4px}p{margin:0 0 16px;color:#4a5766}
.chart{display:flex}.chart>svg{flex:none}.times{flex:1;min-width:0;overflow-x:auto}
svg{display:block}
text{font:12px system-ui,sans-serif;fill:#1d2733}
.way{stroke:#9aa7b5;stroke-width:2}.wait{fill:#e3e8ee}.grid{stroke:#e3e8ee}
.bound{stroke:#b3402a;stroke-dasharray:4 3}.task text{fill:#fff;font-size:11px}
.beside{font-size:10px}
.path{fill:none;stroke:#d9730d;stroke-width:2.5}
.late rect{stroke:#b3402a;stroke-width:3}
.window{fill:#5d6977}[data-task],[data-robot]{cursor:pointer}
.chosen .task{opacity:.3}.chosen .task.now{opacity:1}text.now{font-weight:700}
@media(max-width:640px){body{margin:14px}}
@media(prefers-color-scheme:dark){body{background:#12181f;color:#dfe6ee}text{fill:#dfe6ee}
p{color:#9aa7b5}.wait{fill:#2a3542}.grid{stroke:#2a3542}}
"""


def write_gantt(plan: Mapping[str, Any], path: Path) -> None:
    """Write the page of a plan, given as `teamformer plan --json` prints it."""
    write_whole(path, gantt_page(plan))


def gantt_page(plan: Mapping[str, Any]) -> str:
    """Return the page."""
    name = html.escape(str(plan["mission"]))
    said = f"<h1>{name}</h1><p>{html.escape(_summary(plan))}</p>"
    chosen = '<p id="said" role="status"></p>'
    body = f"<main>{said}{chosen}{_drawing(plan)}{table_of_tasks(plan)}</main>"
    return plan_page(f"{name}, plan", STYLE + STYLE_OF_TABLE, body, plan)


def _summary(plan: Mapping[str, Any]) -> str:
    late = "".join(f"; {task} is late by {by:g}" for task, by in plan["late"].items())
    if plan.get("missed"):
        late += f"; left out: {', '.join(plan['missed'])}"
    over = f"Over at {plan['makespan']:g}"
    if "cost" in plan:
        over += f", at a cost of {plan['cost']:g}"
    legend = "Lines are ways, pale bars waits"
    if plan.get("windows"):
        legend += ", thin lines below bars the windows of tasks"
    if plan.get("critical_path"):
        legend += "; orange is the critical path"
    if plan["bound"] <= 0:
        return f"{over}{late}. {legend}."
    least = f"can take less than {plan['bound']:g}"
    over += f"; no plan {'is better' if plan['proven'] else least}"
    return f"{over}{late}. {legend}; the dashed line is the bound."


def _drawing(plan: Mapping[str, Any]) -> str:
    """Return the robots' names and, beside them, what scrolls in narrow windows: the time."""
    routes: Sequence[Mapping[str, Any]] = plan["routes"]
    height = TOP + ROW * len(routes) + 8
    scale = WIDTH / max(plan["makespan"], 1e-9)
    tasks = sorted({stop["task"] for route in routes for stop in route["stops"]})
    hue = {task: round(360 * n * 0.618034) % 360 for n, task in enumerate(tasks)}
    names, parts = [], [*_axis(plan, scale, height)]
    for number, route in enumerate(routes):
        y = TOP + ROW * number
        names.append(_name(str(route["robot"]), y))
        parts += _row(route, y, scale, hue, plan)
    parts += _critical_path(plan, scale)
    left = LABEL - 8  # half of the axis's first number is left of the time's beginning
    width = LABEL + WIDTH + 24 - left
    return (
        f'<div class="chart"><svg role="img" aria-label="Robots" width="{left}" '
        f'height="{height}">{"".join(names)}</svg>'
        '<div class="times" tabindex="0" role="group" aria-label="Time">'
        '<svg role="img" aria-label="Gantt chart of the plan" '
        f'width="{width}" height="{height}" '
        f'viewBox="{left} 0 {width} {height}">{"".join(parts)}</svg></div></div>'
    )


def _critical_path(plan: Mapping[str, Any], scale: float) -> list[str]:
    """Return frames around what the end hangs on, and lines from row to row between them."""
    row_of = {route["robot"]: number for number, route in enumerate(plan["routes"])}
    parts: list[str] = []
    before: float | None = None
    for robot, part in groupby(plan.get("critical_path", ()), key=itemgetter("robot")):
        stretches = list(part)
        begin, end = LABEL + stretches[0]["from"] * scale, LABEL + stretches[-1]["to"] * scale
        row = row_of.get(robot)
        middle = TOP - 8.0 if row is None else TOP + ROW * (row + 0.5)
        if before is not None and before != middle:
            parts.append(f'<path class="path" d="M{begin:.1f} {before}V{middle}"/>')
        height = 0 if row is None else ROW - 2
        parts.append(
            f'<rect class="path" x="{min(begin, end):.1f}" y="{middle - height / 2}" '
            f'width="{abs(end - begin):.1f}" height="{height}"/>'
        )
        before = middle
    return parts


def _name(robot: str, y: int) -> str:
    """Return a robot's name left of its row, cut where it is long."""
    name = html.escape(robot if len(robot) <= LONGEST_NAME else f"{robot[: LONGEST_NAME - 1]}…")
    title = "" if len(robot) <= LONGEST_NAME else f"<title>{html.escape(robot)}</title>"
    middle = y + ROW / 2
    known = f'data-robot="{html.escape(robot)}"'
    return f'<text {known} x="{LABEL - 10}" y="{middle + 4}" text-anchor="end">{title}{name}</text>'


def _axis(plan: Mapping[str, Any], scale: float, height: int) -> list[str]:
    step = tick_step(plan["makespan"])
    parts = []
    for number in range(int(plan["makespan"] / step) + 1):
        x = LABEL + number * step * scale
        parts.append(f'<line class="grid" x1="{x:.1f}" x2="{x:.1f}" y1="20" y2="{height}"/>')
        parts.append(f'<text x="{x:.1f}" y="14" text-anchor="middle">{number * step:g}</text>')
    if plan["bound"] <= 0:
        return parts
    x = LABEL + plan["bound"] * scale
    return [*parts, f'<line class="bound" x1="{x:.1f}" x2="{x:.1f}" y1="20" y2="{height}"/>']


def tick_step(length: float) -> float:
    """Return 1, 2 or 5 times a power of ten, so that up to a dozen fit into a length."""
    step = 1e-9
    while length / step > 12:
        for factor in (2, 2.5, 2):
            step *= factor
            if length / step <= 12:
                break
    return step


def _row(
    route: Mapping[str, Any],
    y: int,
    scale: float,
    hue: Mapping[str, int],
    plan: Mapping[str, Any],
) -> list[str]:
    """Return a robot's row: lines for ways, pale bars for waits, bars for tasks."""
    middle = y + ROW / 2
    parts: list[str] = []
    free = 0.0
    stops = route["stops"]
    for stop, after in zip_longest(stops, stops[1:]):
        parts.append(_way(free, stop["arrive"], middle, scale))
        if stop["start"] > stop["arrive"]:
            parts.append(_bar(stop["arrive"], stop["start"], y, scale, 'class="wait"'))
        parts += _window(plan, stop["task"], y, scale)
        parts.append(_task(stop, y, scale, hue[stop["task"]], stop["task"] in plan["late"]))
        begins = math.inf if after is None else min(after["arrive"], after["start"])
        parts.append(_name_beside(stop, (begins - stop["end"]) * scale, y, scale))
        free = stop["end"]
    return [*parts, _way(free, route["back"], middle, scale)]


def _window(plan: Mapping[str, Any], task: str, y: int, scale: float) -> list[str]:
    """Return a line below a task's bar from when to when it is to be done, if that is said."""
    if task not in plan.get("windows", {}):
        return []
    begin, end = (LABEL + min(when, plan["makespan"]) * scale for when in plan["windows"][task])
    place = f'x="{begin:.1f}" y="{y + ROW - 4}" width="{max(1, end - begin):.1f}" height="2"'
    return [f'<rect class="window" {place}/>']


def _name_beside(stop: Mapping[str, Any], room: float, y: int, scale: float) -> str:
    """Return a task's name above the way that follows, if its bar is too short for it."""
    width = LETTER * len(str(stop["task"]))
    if (stop["end"] - stop["start"]) * scale > width or width + 6 > room:
        return ""
    x, name = LABEL + stop["end"] * scale + 5, html.escape(str(stop["task"]))
    return f'<text class="beside" x="{x:.1f}" y="{y + ROW / 2 - 3}">{name}</text>'


def _way(begin: float, end: float, y: float, scale: float) -> str:
    if end <= begin:
        return ""
    x, to = LABEL + begin * scale, LABEL + end * scale
    return f'<line class="way" x1="{x:.1f}" x2="{to:.1f}" y1="{y}" y2="{y}"/>'


def _bar(begin: float, end: float, y: int, scale: float, looks: str) -> str:
    x, width = LABEL + begin * scale, max(2.0, (end - begin) * scale)
    top = y + (ROW - BAR) / 2
    return f'<rect {looks} x="{x:.1f}" y="{top}" width="{width:.1f}" height="{BAR}" rx="3"/>'


def _task(stop: Mapping[str, Any], y: int, scale: float, hue: int, is_late: bool) -> str:
    name = html.escape(str(stop["task"]))
    said = f"{name}: there {stop['arrive']:g}, from {stop['start']:g} to {stop['end']:g}"
    bar = _bar(stop["start"], stop["end"], y, scale, f'fill="hsl({hue},45%,38%)"')
    width = (stop["end"] - stop["start"]) * scale
    label = ""
    if width > LETTER * len(str(stop["task"])):
        x = LABEL + stop["start"] * scale + width / 2
        label = f'<text x="{x:.1f}" y="{y + ROW / 2 + 4}" text-anchor="middle">{name}</text>'
    marked = "task late" if is_late else "task"
    known = f'data-task="{name}"'
    return f'<g class="{marked}" {known}><title>{said}</title>{bar}{label}</g>'
