"""The table of a plan's page: who does each task from when to when, in which window, how late."""

from __future__ import annotations

import html
from collections import defaultdict
from collections.abc import Mapping, Sequence
from typing import Any

STYLE_OF_TABLE = """
.table{overflow-x:auto;margin-top:20px}table{border-collapse:collapse}
th,td{text-align:left;padding:4px 14px 4px 0;border-bottom:1px solid #e3e8ee;vertical-align:top}
td.number{text-align:right;white-space:nowrap}td.late{color:#b3402a;font-weight:600}
tr.now{background:#e8effc}td{overflow-wrap:break-word;max-width:32ch}h1,p{overflow-wrap:anywhere}
button{font:inherit;color:#1d4fa8;background:none;border:0;padding:0;text-align:left;cursor:pointer}
#save{border:1px solid #9aa7b5;border-radius:6px;padding:4px 10px;margin-top:14px}
@media(max-width:640px){th,td{padding-right:9px}}
@media(prefers-color-scheme:dark){th,td{border-color:#2a3542}tr.now{background:#1d2b45}
button{color:#8fb4ff}td.late{color:#e58a75}}
"""


def table_of_tasks(plan: Mapping[str, Any]) -> str:
    """Return a row for each task, the earliest first, and the button that saves all."""
    doers: defaultdict[str, list[str]] = defaultdict(list)
    times: dict[str, tuple[float, float]] = {}
    for route in plan["routes"]:
        for stop in route["stops"]:
            doers[stop["task"]].append(str(route["robot"]))
            times[stop["task"]] = (stop["start"], stop["end"])
    windows, late = plan.get("windows", {}), plan["late"]
    head = ["Task", "Robots", "From", "To", *(["Window"] if windows else [])]
    head += ["Late by"] if late else []
    rows = []
    for task in sorted(times, key=lambda task: times[task]):
        begin, end = (f"{when:g}" for when in times[task])
        cells = [_cell(", ".join(doers[task])), _cell(begin, "number"), _cell(end, "number")]
        if windows:
            cells.append(_cell(" to ".join(f"{when:g}" for when in windows.get(task, ()))))
        if late:
            cells.append(_cell(f"{late[task]:g}" if task in late else "", "number late"))
        rows.append(_row(task, cells))
    titles = "".join(f'<th scope="col">{title}</th>' for title in head)
    return (
        '<div class="table" tabindex="0" role="group" aria-label="Tasks"><table>'
        f"<thead><tr>{titles}</tr></thead><tbody>{''.join(rows)}</tbody></table></div>"
        '<button type="button" id="save" hidden>Save as CSV</button>'
    )


def _row(task: str, cells: Sequence[str]) -> str:
    name = html.escape(task)
    button = f'<button type="button">{name}</button>'
    return f'<tr data-task="{name}"><td>{button}</td>{"".join(cells)}</tr>'


def _cell(text: str, looks: str = "") -> str:
    kind = f' class="{looks}"' if looks else ""
    return f"<td{kind}>{html.escape(text)}</td>"
