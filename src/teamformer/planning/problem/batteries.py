"""Batteries and chargers of a coalition problem, in ticks."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from teamformer.base.array_types import Floats, Ints

ENDLESS = 10**15
"""Of a battery that never runs down, in ticks."""


class Batteries(NamedTuple):
    """What robots have to spend and where they charge; no kinds where nobody has a battery."""

    lasts: Ints  # (kinds,)
    fills: Floats  # (kinds,) how long a tick of walking takes to charge
    waiting: Floats  # (kinds,) what a tick of waiting takes
    spends: Ints  # (kinds, tasks) what a task may take: its load is carried by the slowest
    serves: Ints  # (kinds, tasks) the same without the way of the load
    services: Ints  # (tasks,) how long a task takes but for that
    left: Ints  # (robots,) what each begins with
    to: Ints  # (paces, places, chargers) ways
    nearest: Ints  # (paces, places) the way to the nearest charger
    fro: Ints  # (kinds, chargers, tasks + 1) ways from chargers, last the way home
    between: Ints  # (paces, chargers, chargers)
    onward: Ints  # the same for who is full there, by way of others if need be; NEVER if it cannot
    room: Ints  # (chargers,)
    taken: Ints  # (taken, 2) chargers where somebody charges, and until when


def no_batteries() -> Batteries:
    """Return what stands for batteries where nobody has one."""
    one, two, three = (np.zeros((0,) * axes, np.int64) for axes in (1, 2, 3))
    none = np.zeros(0)
    return Batteries(one, none, none, two, two, one, one, three, two, three, three, three, one, two)


def with_permits(batteries: Batteries, robots: int, kinds: int, depots: int) -> Batteries:
    """Return batteries beside which there are permits: they spend nothing, and have no ways.

    So many they are, of so many kinds, with so many depots, and all of one pace.
    """
    of_kinds = {
        name: _padded(getattr(batteries, name), [kinds])
        for name in ("fills", "waiting", "spends", "serves", "fro", "onward")
    }
    pace = min(1, robots)
    return batteries._replace(
        **of_kinds,
        lasts=_padded(batteries.lasts, [kinds], ENDLESS),
        left=_padded(batteries.left, [robots], ENDLESS),
        to=_padded(batteries.to, [pace, depots]),
        nearest=_padded(batteries.nearest, [pace, depots]),
        between=_padded(batteries.between, [pace]),
    )


def _padded(table: Any, more: Sequence[int], value: int = 0) -> Any:
    """Return a table with more rows, and columns, of one value behind its own."""
    widths = [(0, width) for width in (*more, *[0] * (table.ndim - len(more)))]
    return np.pad(table, widths, constant_values=value)


def are_charged(batteries: Batteries) -> bool:
    """Say whether anybody has a battery."""
    return len(batteries.lasts) > 0
