"""The page of a folder of records: a row each, sorted by a click, several side by side."""

from __future__ import annotations

import html
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import quote

from teamformer.base.whole_files import write_whole
from teamformer.viewer.html import script_page

BEFORE, AFTER = (
    ("Side by side", "Record", "Mission", "Method", "Seed", "Ended"),
    ("Bound", "Tasks done", "Late by", "Cost"),
)
"""The heads of the columns before and after the length."""

LENGTHS = {(False,): "Steps", (True,): "Time", (False, True): "Steps or time"}
"""The head of the length, by whether records are in continuous time."""

STYLE = """
body{font:14px/1.4 system-ui,sans-serif;margin:24px;color:#1d2733;background:#fff}
h1{font-size:20px;margin:0 0 4px;overflow-wrap:anywhere}p{margin:0 0 16px;color:#4a5766}
.table{overflow-x:auto}table{border-collapse:collapse}
th,td{text-align:left;padding:4px 14px 4px 0;border-bottom:1px solid #e3e8ee;vertical-align:top}
td.number{text-align:right;white-space:nowrap}td{overflow-wrap:anywhere;min-width:5ch}
td.wrong{color:#b3402a}a{color:#1d4fa8}
button{font:inherit;font-weight:600;color:inherit;background:none;border:0;padding:0;cursor:pointer}
th[aria-sort=ascending] button::after{content:" ↑"}
th[aria-sort=descending] button::after{content:" ↓"}
#shown{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,520px),1fr));gap:12px;
margin-top:20px}
#shown[hidden]{display:none}iframe{width:100%;height:72vh;border:1px solid #9aa7b5}
@media(max-width:640px){body{margin:14px}}
@media(prefers-color-scheme:dark){body{background:#12181f;color:#dfe6ee}p{color:#9aa7b5}
th,td{border-color:#2a3542}a{color:#8fb4ff}td.wrong{color:#e58a75}}
"""

SCRIPT = "folder/folder"


@dataclass(frozen=True)
class RecordRow:
    """What the table says of a record, or why it cannot be read."""

    file: str  # its name in the folder
    page: str = ""  # the name of its page in the folder
    mission: str = ""
    method: str = ""
    seed: int | None = None
    ended: str = ""
    length: float | None = None  # in steps, or in the unit of continuous time
    is_continuous: bool = False
    bound: float | None = None
    done: str = ""  # of how many tasks
    late: float | None = None  # all tasks together
    cost: float | None = None
    wrong: str = ""


def write_folder_page(folder: str, rows: Sequence[RecordRow], path: Path) -> None:
    """Write the page of a folder with this name; pages of records are found beside it."""
    count = "1 record" if len(rows) == 1 else f"{len(rows)} records"
    read = {row.is_continuous for row in rows if not row.wrong} or {False}
    names = (*BEFORE, LENGTHS[tuple(sorted(read))], *AFTER)
    heads = "".join(f'<th scope="col">{_head(name)}</th>' for name in names)
    body = (
        f"<h1>{html.escape(folder)}</h1><p>{count}. Click a column to sort by it, a record to open "
        "it; tick several to see them side by side.</p>"
        '<div class="table" tabindex="0" role="group" aria-label="Records"><table>'
        f"<thead><tr>{heads}</tr></thead><tbody>{''.join(map(_row, rows))}</tbody></table></div>"
        '<div id="shown" hidden></div>'
    )
    title = f"{html.escape(folder)}, {count}"
    write_whole(path, script_page(title, STYLE, body, SCRIPT, "frame-src 'self' file:; "))


def _head(name: str) -> str:
    return f'<button type="button">{name}</button>'


def _row(row: RecordRow) -> str:
    name = html.escape(row.file)
    if row.wrong:
        span = len(BEFORE) + len(AFTER) - 1
        rest = f'<td class="wrong" colspan="{span}">{html.escape(row.wrong)}</td>'
        return f"<tr><td></td><td>{name}</td>{rest}</tr>"
    page = html.escape(quote(row.page))
    tick = f'<input type="checkbox" value="{page}" title="{name}" aria-label="{name}">'
    cells = [row.mission, row.method, row.seed, row.ended, row.length, row.bound, row.done]
    told = "".join(_cell(value) for value in (*cells, row.late, row.cost))
    return f'<tr><td>{tick}</td><td><a href="{page}">{name}</a></td>{told}</tr>'


def _cell(value: str | float | None) -> str:
    if value is None:
        return "<td></td>"
    if isinstance(value, str):
        return f"<td>{html.escape(value)}</td>"
    return f'<td class="number">{value:g}</td>'
