"""Shifts in ticks: when walks end that pause between them, and when tasks fit into one of each.

The plain rule is `mission/parts/shifts.py`. A robot whose last shift is over works again so late as
no plan is that can be carried out; so those that cannot are compared by what is left to do.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from teamformer.base.array_types import Int32s, Ints
from teamformer.base.kernels.jit import kernel
from teamformer.mission.parts.shifts import MOST_TRIED, Rota
from teamformer.planning.problem.constants import NEVER


class Rotas(NamedTuple):
    """The shifts of each kind of robots; empty arrays where everybody always works."""

    shifts: Ints  # (kinds, most, 2) when each begins and ends, then NEVER
    every: Ints  # (kinds,) after how long they come again; 0 if they do not
    worked: Ints  # (kinds,) how long a kind works in that time
    late: Ints  # (1,) when robots work again whose shifts are over


def no_rotas() -> Rotas:
    """Return what a problem has in which everybody always works."""
    nothing = np.zeros(0, np.int64)
    return Rotas(np.zeros((0, 0, 2), np.int64), nothing, nothing, nothing)


def rotas_in_ticks(
    rotas: Sequence[Rota], ticks: Callable[[float], int], late: int, rounding: int
) -> Rotas:
    """Return the shifts of robots in ticks, counted from the present.

    They are longer by what times are rounded, so that what just fits does.
    """
    if not any(rotas):
        return no_rotas()
    rows = [_rows(rota, ticks, late, rounding) for rota in rotas]
    shifts = np.full((len(rows), max(map(len, rows)), 2), NEVER)
    for kind, row in enumerate(rows):
        shifts[kind, : len(row)] = row
    worked = [sum(closes - opens for opens, closes in row) for row in rows]
    return Rotas(
        shifts,
        every=np.array([ticks(rota.every) for rota in rotas]),
        worked=np.array(
            [work if rota.every else 0 for work, rota in zip(worked, rotas, strict=True)]
        ),
        late=np.array([late]),
    )


def _rows(
    rota: Rota, ticks: Callable[[float], int], late: int, rounding: int
) -> list[tuple[int, int]]:
    if not rota:
        return [(0, NEVER)]
    shifts = [(ticks(opens), ticks(closes) + rounding) for opens, closes in rota.shifts]
    return shifts if rota.every else [*(one for one in shifts if one[1] > 0), (late, NEVER)]


def of_kinds(rotas: Rotas, rows: Ints) -> Rotas:
    """Return the shifts of kinds of robots, of which each has those of a row."""
    if len(rotas.every) == 0:
        return rotas
    by_kind = rotas._replace(every=rotas.every[rows], worked=rotas.worked[rows])
    return by_kind._replace(shifts=np.ascontiguousarray(rotas.shifts[rows]))


def with_others(rotas: Rotas, others: int) -> Rotas:
    """Return shifts with those of so many more behind them, who always work."""
    if len(rotas.every) == 0 or others == 0:
        return rotas
    always = np.full((others, *rotas.shifts.shape[1:]), NEVER)
    always[:, 0, 0] = 0
    nothing = np.zeros(others, rotas.every.dtype)
    every, worked = (np.append(row, nothing) for row in (rotas.every, rotas.worked))
    return rotas._replace(shifts=np.concatenate([rotas.shifts, always]), every=every, worked=worked)


def stretched(rotas: Rotas, ticks: int) -> Rotas:
    """Return shifts in a unit of time of which so many make one of that which they are in."""
    shifts = np.where(rotas.shifts == NEVER, NEVER, rotas.shifts * ticks)
    return Rotas(shifts, rotas.every * ticks, rotas.worked * ticks, rotas.late * ticks)


def rotas_as_told(rotas: Rotas, kinds: Int32s) -> list[Rota]:
    """Return when robots of these kinds work, in ticks, by the plain rule; nothing if always."""
    if len(rotas.every) == 0:
        return []
    rows = [
        [(opens, closes) for opens, closes in row if opens != NEVER]
        for row in rotas.shifts.tolist()
    ]
    told = [Rota(tuple(row), every) for row, every in zip(rows, rotas.every.tolist(), strict=True)]
    return [told[kind] for kind in kinds]


def longest_pauses(rotas: Sequence[Rota], busy: float, tasks: int) -> float:
    """Return how much longer all takes at most where robots work in shifts, about."""
    bound = [rota for rota in rotas if rota]
    if not bound:
        return 0.0
    latest = max(rota.shifts[-1][1] for rota in bound)
    turns = (tasks + 1) * max(rota.every for rota in bound)
    share = min(rota.share for rota in bound)
    return max(0.0, latest) + turns + busy * (1 / share - 1)


@kernel
def have_shifts(rotas: Rotas) -> bool:
    """Say whether anybody works in shifts only."""
    return len(rotas.every) > 0


@kernel
def walked(rotas: Rotas, kind: int, begin: int, spent: int) -> int:
    """Return when a robot of a kind has walked so long that sets out at `begin`."""
    if not have_shifts(rotas) or spent <= 0:
        return begin + spent
    left, every = spent, rotas.every[kind]
    later = _turn(rotas, kind, begin)
    while True:
        for row in range(rotas.shifts.shape[1]):
            opens, closes = rotas.shifts[kind, row, 0], rotas.shifts[kind, row, 1]
            if opens == NEVER:
                break
            start = max(begin, opens + later)
            if closes == NEVER or start + left <= closes + later:
                return start + left
            left -= max(0, closes + later - start)
        whole = (left - 1) // rotas.worked[kind]
        left -= whole * rotas.worked[kind]
        later += (1 + whole) * every


@kernel
def worked(rotas: Rotas, kind: int, begin: int, end: int) -> int:
    """Return how long a robot of a kind works between two moments."""
    if not have_shifts(rotas):
        return end - begin
    done, later = 0, _turn(rotas, kind, begin)
    while True:
        for row in range(rotas.shifts.shape[1]):
            opens, closes = rotas.shifts[kind, row, 0], rotas.shifts[kind, row, 1]
            if opens == NEVER or opens + later >= end:
                break
            if closes == NEVER:
                return done + end - max(begin, opens)
            done += max(0, min(end, closes + later) - max(begin, opens + later))
        if rotas.every[kind] == 0:
            return done
        later += rotas.every[kind]
        whole = max(0, (end - rotas.shifts[kind, 0, 0] - later) // rotas.every[kind])
        done += whole * rotas.worked[kind]
        later += whole * rotas.every[kind]
        if rotas.shifts[kind, 0, 0] + later >= end:
            return done


@kernel
def fits(rotas: Rotas, kind: int, earliest: int, takes: int) -> int:
    """Return the first moment from which something fits into a shift of a kind of robots."""
    later = _turn(rotas, kind, earliest)
    for _ in range(3):
        for row in range(rotas.shifts.shape[1]):
            opens, closes = rotas.shifts[kind, row, 0], rotas.shifts[kind, row, 1]
            if opens == NEVER:
                break
            start = max(earliest, opens + later)
            if closes == NEVER or start + takes <= closes + later:
                return start
        later += rotas.every[kind]
    return max(earliest, rotas.late[0])


@kernel
def fits_all(
    rotas: Rotas, kind: Int32s, robots: Int32s, size: int, earliest: int, takes: int
) -> int:
    """Return the first moment from which something fits into a shift of each of some robots."""
    if not have_shifts(rotas):
        return earliest
    start = earliest
    for _ in range(MOST_TRIED):
        before = start
        for seat in range(size):
            start = fits(rotas, kind[robots[seat]], start, takes)
        if start == before:
            return start
    return max(earliest, rotas.late[0])


@kernel
def fit_together(rotas: Rotas, rows: Int32s, count: int, earliest: int, takes: int) -> int:
    """Return the first moment from which something fits into a shift of each of the first rows."""
    start = earliest
    for _ in range(MOST_TRIED):
        before = start
        for place in range(count):
            start = fits(rotas, rows[place], start, takes)
        if start == before:
            return start
    return max(earliest, rotas.late[0])


@kernel
def walk_together(rotas: Rotas, rows: Int32s, count: int, begin: int, spent: int, step: int) -> int:
    """Return when those of the first rows have walked so long who walk while all of them work.

    They do so in whole steps of so many ticks.
    """
    if count == 1:
        return walked(rotas, rows[0], begin, spent)
    now, left = begin, spent
    while 0 < left < rotas.late[0]:  # else there is no way
        now = fit_together(rotas, rows, count, now, step)
        if now >= rotas.late[0]:
            break
        until = NEVER
        for place in range(count):
            until = min(until, _ends(rotas, rows[place], now))
        gone = min(left, until - now)
        now, left = now + gone, left - gone
    return now + left


@kernel
def pair_off_together(
    rotas: Rotas, rows: Int32s, size: int, arrival: Ints, count: int, step: int
) -> int:
    """Return in which step the first `count` teams that arrive, in sorted steps, are one.

    As in `pair_off`, but nobody joins unless all robots work, those of the first rows.
    """
    here, now = 1, arrival[0]
    for index in range(1, count):
        while here > 1:
            joined = fit_together(rotas, rows, size, now * step, step) // step + 1
            if joined > arrival[index]:
                break
            here, now = (here + 1) // 2, joined
        here, now = here + 1, max(now, arrival[index])
    while here > 1:
        here = (here + 1) // 2
        now = fit_together(rotas, rows, size, now * step, step) // step + 1
    return now


@kernel
def _ends(rotas: Rotas, kind: int, moment: int) -> int:
    """Return when the shift of a kind ends in which a moment is; the moment if it is in none."""
    later = _turn(rotas, kind, moment)
    for row in range(rotas.shifts.shape[1]):
        opens, closes = rotas.shifts[kind, row, 0], rotas.shifts[kind, row, 1]
        if opens == NEVER or opens + later > moment:
            break
        if closes == NEVER:
            return closes
        if moment < closes + later:
            return closes + later
    return moment


@kernel
def _turn(rotas: Rotas, kind: int, when: int) -> int:
    """Return by how much later the shifts of a kind come at a moment than they are written."""
    every = rotas.every[kind]
    if every == 0:
        return 0
    return max(0, (when - rotas.shifts[kind, 0, 0]) // every) * every
