"""What the trials of deviations say: tables, and what critics won."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from teamformer.bench.measurements.deviations.choosing import Chosen
from teamformer.bench.measurements.deviations.edits import KINDS
from teamformer.bench.measurements.deviations.trying import Tried
from teamformer.bench.statistics import mean_of
from teamformer.sim.arrays import Array

COLUMNS = ("deviation", "setting", "tried", "better", "worse", "steps won")

COLUMNS_OF_CHOICES = (
    "setting", "moments", "chosen at", "promised", "won", "won at a moment", "won in a mission",
)  # fmt: skip

LEAST = 50
"""Deviations from which on it makes sense to learn from them."""

MARGINS = (0.0, 0.5, 1.0)
"""Steps that a deviation has to promise to be chosen."""


def table_of(tried: Sequence[Tried]) -> list[tuple[str, ...]]:
    """Return a row for each kind and setting, and one for each kind."""
    table = []
    settings = sorted({row.setting for row in tried})
    for kind in KINDS:
        of_kind = [row for row in tried if row.kind == kind]
        for setting in settings:
            rows = [row for row in of_kind if row.setting == setting]
            if rows:
                table.append((kind, setting, *_figures(rows)))
        if of_kind:
            table.append((kind, "all", *_figures(of_kind)))
    return table


def table_of_choices(chosen: Sequence[Chosen]) -> list[tuple[str, ...]]:
    """Return a row for each setting.

    Where something was chosen: what it promised on average, and what it won in other futures. Then
    what choosing wins at a moment, and at all of a mission if that could be added up.
    """
    table: list[tuple[str, ...]] = []
    for setting in sorted({row.setting for row in chosen}):
        rows = [row for row in chosen if row.setting == setting]
        ahead = [row for row in rows if row.kind]
        plans = mean_of([row.plans for row in rows]).value
        table.append(
            (
                setting,
                str(len(rows)),
                str(len(ahead)),
                _with_interval([row.promised for row in ahead]) if ahead else "",
                _with_interval([row.gain for row in ahead]) if ahead else "",
                _with_interval([row.gain for row in rows]),
                _with_interval([row.gain * plans for row in rows]),
            )
        )
    return table


def _figures(rows: Sequence[Tried]) -> tuple[str, ...]:
    gains = [row.gain for row in rows]
    better, worse = (sum(np.sign(gain) == sign for gain in gains) for sign in (1, -1))
    return (
        str(len(gains)),
        f"{100 * better / len(gains):.0f}%",
        f"{100 * worse / len(gains):.0f}%",
        _with_interval(gains),
    )


def _with_interval(gains: Sequence[float]) -> str:
    mean = mean_of(gains)
    return f"{mean.value:+.2f} ± {mean.half_width:.2f}" if len(gains) > 1 else f"{mean.value:+.2f}"


def can_teach(tried: Sequence[Tried]) -> bool:
    """Say whether there is enough to learn from some worlds and be tested on others."""
    gains: dict[int, set[int]] = {}
    for row in tried:
        gains.setdefault(row.fold, set()).add(row.gain)
    is_varied = all(len(different) > 1 for different in gains.values())
    return len(tried) >= LEAST and len(gains) > 1 and is_varied


def verdict_on(tried: Sequence[Tried], promised: Array, learned: Array, unseen: Array) -> list[str]:
    """Return sentences on what critics that choose deviations would win in worlds unseen by them.

    They promised so many steps for each, (rows,); their errors after each epoch, (epochs,), are
    those on what they learned from and on unseen worlds.
    """
    gain = np.array([row.gain for row in tried], float)
    said = [
        f"error of critics at the end: {learned[-1]:.2f} of that of the mean on what they "
        f"learned from, {unseen[-1]:.2f} on other worlds, {unseen.min():.2f} at best"
    ]
    for margin in MARGINS:
        chosen = gain[promised > margin]
        won = _with_interval(chosen.tolist()) if len(chosen) else "nothing"
        said.append(
            f"of what they promise more than {margin:g} steps for: {len(chosen)} of {len(gain)}, "
            f"steps won: {won}"
        )
    return said
