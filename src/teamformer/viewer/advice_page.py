"""The page of advice: a bar for each change, how much it wins, beside what is noise."""

from __future__ import annotations

import html
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from teamformer.base.whole_files import write_whole
from teamformer.viewer.html import plain_page

ROW, BAR = 24, 14
"""Heights in pixels: of a row and of a bar. Along a row all is in percent, whatever fits there."""

MOST_ROWS = 60
"""Of more changes, those that win or lose most are shown."""

LONGEST_LOSS = 1.5
"""So many times the largest gain; the bar of a larger loss ends at the edge."""

TICKS_APART = 2
"""Half of the marks that `tick_step` finds room for: phones are narrow."""

STYLE = """
body{font:14px/1.4 system-ui,sans-serif;margin:24px;color:#1d2733;background:#fff}
h1{font-size:20px;margin:0 0 4px;overflow-wrap:anywhere}
p{margin:0 0 12px;color:#4a5766;max-width:75ch;overflow-wrap:anywhere}
ol{list-style:none;margin:0;padding:0;max-width:1200px}
li{display:grid;grid-template-columns:minmax(150px,30%) 1fr 130px;gap:0 14px;align-items:center}
.what{text-align:right;overflow-wrap:anywhere}
svg{display:block;width:100%;overflow:visible}
text{font:12px system-ui,sans-serif}text,.dim{fill:#5d6977;color:#5d6977}
.grid{stroke:#e3e8ee}.zero{stroke:#6b7785}.noise{fill:#e3e8ee}
.wins{fill:#157347}.loses{fill:#b3402a}.unsure{fill:#9aa7b5}
@media(max-width:640px){body{margin:14px}li{grid-template-columns:1fr auto;padding:3px 0}
.what{text-align:left}.bar{grid-column:1/3;grid-row:2}}
@media(prefers-color-scheme:dark){body{background:#12181f;color:#dfe6ee}
p,text,.dim{fill:#9aa7b5;color:#9aa7b5}.noise,.grid{fill:#2a3542;stroke:#2a3542}
.wins{fill:#3fa873}.loses{fill:#d9725c}}
"""


def write_advice(advice: Mapping[str, Any], path: Path) -> None:
    """Write the page of advice, given as `teamformer advise --json` prints it."""
    write_whole(path, advice_page(advice))


def advice_page(advice: Mapping[str, Any]) -> str:
    """Return the page."""
    name = html.escape(str(advice["mission"]))
    said = "".join(f"<p>{html.escape(line)}</p>" for line in _sentences(advice))
    body = f"<main><h1>{name}: what would help</h1>{said}{_drawing(advice)}</main>"
    return plain_page(f"{name}, advice", STYLE, body)


def _sentences(advice: Mapping[str, Any]) -> list[str]:
    """Return what stands above the picture."""
    measure = "it takes" if advice["measure"] == "makespan" else "it costs"
    least, most = advice["range"]
    lines = [
        f"By {advice['method']} {measure} {advice['makespan']:g}, the median of "
        f"{advice['searches']} searches ({least:g} to {most:g}). Each bar is what a change gains; "
        "a gain inside the pale band may be chance. At the right is what the mission takes "
        "with the change."
    ]
    if advice["impossible"]:
        lines.append(f"Impossible: {', '.join(advice['impossible'])}.")
    left_out = len(advice["advice"]) - MOST_ROWS
    if left_out > 0:
        lines.append(f"{left_out} changes with smaller effects are left out.")
    if advice["unmeasured"]:
        lines.append(f"There was no time for {len(advice['unmeasured'])} changes.")
    return lines


def _drawing(advice: Mapping[str, Any]) -> str:
    """Return a list with a row for each change; all bars have one scale."""
    rows = _shown(advice["advice"])
    ends = [end for row in rows for end in (row["gain"], row["noise"], -row["noise"])]
    most, least = max([0.0, *ends]), min([0.0, *ends])
    if most > 0:
        least = max(least, -LONGEST_LOSS * most)
    scale = _Scale(least, most)
    parts = [_axis(scale), *(_row(row, scale) for row in rows)]
    return f'<ol aria-label="What each change gains">{"".join(parts)}</ol>'


@dataclass(frozen=True)
class _Scale:
    """Where gains lie along a row, in percent of its width."""

    least: float
    most: float

    def at(self, gain: float) -> float:
        """Return where a gain lies; a larger loss than fits lies at the edge."""
        return 100 * (max(self.least, gain) - self.least) / max(self.most - self.least, 1e-9)

    @property
    def ticks(self) -> list[float]:
        """Return the gains that have a line, which are round numbers."""
        step = tick_step(max(TICKS_APART * (self.most - self.least), 1e-9))
        return [n * step for n in range(int(self.least / step), int(self.most / step) + 1)]


def _shown(rows: Sequence[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """Return the rows in their order, of too many those that win or lose most."""
    most = sorted(rows, key=lambda row: -abs(row["gain"]))[:MOST_ROWS]
    kept = {id(row) for row in most}
    return [row for row in rows if id(row) in kept]


def _axis(scale: _Scale) -> str:
    labels = "".join(
        f'<text x="{scale.at(gain):.1f}%" y="14" text-anchor="middle">{_signed(gain)}</text>'
        for gain in scale.ticks
    )
    axis = f'<svg class="bar" height="20">{labels}</svg>'
    return f'<li aria-hidden="true"><span></span>{axis}<span></span></li>'


def _signed(value: float) -> str:
    return f"{value:+g}" if value else "0"


def _row(row: Mapping[str, Any], scale: _Scale) -> str:
    """Return a change's name, the band of noise, its bar and the makespan with it."""
    gain, noise, name = row["gain"], row["noise"], html.escape(str(row["change"]))
    looks = "unsure" if abs(gain) <= noise else "wins" if gain > 0 else "loses"
    told = f"{name}: {row['makespan']:g}, {_signed(gain)}; up to {noise:g} may be chance"
    parts = [_rect("noise", -noise, noise, scale, ROW - 4)]
    parts += [_line(tick, scale) for tick in scale.ticks]
    parts.append(_rect(looks, min(0, gain), max(0, gain), scale, BAR))
    bar = f'<svg class="bar" role="img" aria-label="{told}" height="{ROW}"><title>{told}</title>'
    takes = f'{round(row["makespan"], 2):g} <span class="dim">{_signed(round(gain, 2))}</span>'
    return (
        f'<li><span class="what">{name}</span>{bar}{"".join(parts)}</svg><span>{takes}</span></li>'
    )


def _line(gain: float, scale: _Scale) -> str:
    x, looks = f"{scale.at(gain):.1f}%", "grid" if gain else "zero"
    return f'<line class="{looks}" x1="{x}" x2="{x}" y1="0" y2="{ROW}"/>'


def _rect(looks: str, begin: float, end: float, scale: _Scale, height: int) -> str:
    left = scale.at(begin)
    width, top = max(0.0, scale.at(end) - left), (ROW - height) // 2
    return (
        f'<rect class="{looks}" x="{left:.2f}%" y="{top}" width="{width:.2f}%" height="{height}"/>'
    )


def tick_step(length: float) -> float:
    """Return 1, 2 or 5 times a power of ten, so that up to a dozen fit into a length."""
    step = 1e-9
    while length / step > 12:
        for factor in (2, 2.5, 2):
            step *= factor
            if length / step <= 12:
                break
    return step
