"""The page of advice: a bar for each change, how much it wins, beside what is noise."""

from __future__ import annotations

import html
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from teamformer.viewer.gantt import tick_step
from teamformer.viewer.html import plain_page
from teamformer.whole_files import write_whole

ROW, BAR, LABEL, WIDTH, TOP, END = 24, 14, 340, 640, 30, 170
"""Sizes in pixels: of a row, a bar, the changes, the gains, the axis, the makespans."""

MOST_ROWS = 60
"""Of more changes, those that win or lose most are shown."""

LONGEST_LOSS = 1.5
"""So many times the largest gain; the bar of a larger loss ends at the edge."""

LONGEST_NAME = 50

STYLE = """
body{font:14px/1.4 system-ui,sans-serif;margin:24px;color:#1d2733;background:#fff}
h1{font-size:20px;margin:0 0 4px}p{margin:0 0 12px;color:#4a5766;max-width:75ch}
main{overflow-x:auto}svg{display:block}
text{font:12px system-ui,sans-serif;fill:#1d2733}.dim{fill:#6b7785}
.grid{stroke:#e3e8ee}.zero{stroke:#6b7785}.noise{fill:#e3e8ee}
.wins{fill:#157347}.loses{fill:#b3402a}.unsure{fill:#9aa7b5}
@media(prefers-color-scheme:dark){body{background:#12181f;color:#dfe6ee}text{fill:#dfe6ee}
p{color:#9aa7b5}.noise,.grid{fill:#2a3542;stroke:#2a3542}.dim{fill:#9aa7b5}
.wins{fill:#3fa873}.loses{fill:#d9725c}}
"""


def write_advice(advice: Mapping[str, Any], path: Path) -> None:
    """Write the page of advice, given as `teamformer advise --json` prints it."""
    write_whole(path, advice_page(advice))


def advice_page(advice: Mapping[str, Any]) -> str:
    """Return the page."""
    name = html.escape(str(advice["scenario"]))
    said = "".join(f"<p>{html.escape(line)}</p>" for line in _sentences(advice))
    body = f"<h1>{name}: what would help</h1>{said}<main>{_drawing(advice)}</main>"
    return plain_page(f"{name}, advice", STYLE, body)


def _sentences(advice: Mapping[str, Any]) -> list[str]:
    """Return what stands above the picture."""
    measure = "it takes" if advice["measure"] == "makespan" else "it costs"
    least, most = advice["range"]
    lines = [
        f"By {advice['method']} {measure} {advice['makespan']:g}, the median of "
        f"{advice['searches']} searches ({least:g} to {most:g}). Each bar is what a change wins; "
        "the pale band is what luck alone may look like. At the right is what the mission takes "
        "with the change."
    ]
    if advice["impossible"]:
        lines.append(f"Impossible: {', '.join(advice['impossible'])}.")
    left_out = len(advice["advice"]) - MOST_ROWS
    if left_out > 0:
        lines.append(f"{left_out} changes that win and lose less are left out.")
    if advice["unmeasured"]:
        lines.append(f"There was no time for {len(advice['unmeasured'])} changes.")
    return lines


def _drawing(advice: Mapping[str, Any]) -> str:
    rows = _shown(advice["advice"])
    ends = [end for row in rows for end in (row["gain"], row["noise"], -row["noise"])]
    most, least = max([0.0, *ends]), min([0.0, *ends])
    if most > 0:
        least = max(least, -LONGEST_LOSS * most)
    scale = WIDTH / max(most - least, 1e-9)
    zero = LABEL - least * scale
    height, width = TOP + ROW * len(rows) + 8, LABEL + WIDTH + END
    parts = _axis(least, most, zero, scale, height)
    for number, row in enumerate(rows):
        parts += _row(row, TOP + ROW * number, zero, scale, least)
    return (
        '<svg role="img" aria-label="What each change wins" '
        f'width="{width}" height="{height}" viewBox="0 0 {width} {height}">{"".join(parts)}</svg>'
    )


def _shown(rows: Sequence[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """Return the rows in their order, of too many those that win or lose most."""
    most = sorted(rows, key=lambda row: -abs(row["gain"]))[:MOST_ROWS]
    kept = {id(row) for row in most}
    return [row for row in rows if id(row) in kept]


def _axis(least: float, most: float, zero: float, scale: float, height: int) -> list[str]:
    step = tick_step(max(most - least, 1e-9))
    parts = []
    for number in range(int(least / step), int(most / step) + 1):
        x, looks = zero + number * step * scale, "grid" if number else "zero"
        parts.append(f'<line class="{looks}" x1="{x:.1f}" x2="{x:.1f}" y1="20" y2="{height}"/>')
        label = _signed(number * step)
        parts.append(f'<text class="dim" x="{x:.1f}" y="14" text-anchor="middle">{label}</text>')
    return parts


def _signed(value: float) -> str:
    return f"{value:+g}" if value else "0"


def _row(row: Mapping[str, Any], y: int, zero: float, scale: float, least: float) -> list[str]:
    """Return a change's name, the band of noise, its bar and the makespan with it."""
    end = zero + max(least, row["gain"]) * scale
    gain, noise, middle = row["gain"], row["noise"], y + ROW / 2
    name = str(row["change"])
    cut = name if len(name) <= LONGEST_NAME else f"{name[: LONGEST_NAME - 1]}…"
    looks = "unsure" if abs(gain) <= noise else "wins" if gain > 0 else "loses"
    told = f"{name}: {row['makespan']:g}, {_signed(gain)}; luck up to {noise:g}"
    return [
        f"<g><title>{html.escape(told)}</title>"
        f'<text x="{LABEL - 12}" y="{middle + 4}" text-anchor="end">{html.escape(cut)}</text>',
        _rect("noise", zero - noise * scale, zero + noise * scale, y + 2, ROW - 4),
        _rect(looks, min(zero, end), max(zero, end), y + (ROW - BAR) // 2, BAR),
        f'<text x="{LABEL + WIDTH + 12}" y="{middle + 4}">{round(row["makespan"], 2):g}'
        f'<tspan class="dim" dx="10">{_signed(round(gain, 2))}</tspan></text></g>',
    ]


def _rect(looks: str, left: float, right: float, top: int, height: int) -> str:
    width = max(0.0, right - left)
    return f'<rect class="{looks}" x="{left:.1f}" y="{top}" width="{width:.1f}" height="{height}"/>'
