"""Shifts in ticks: the kernels say what the plain rule says."""

from __future__ import annotations

import math
import random

import numpy as np
import pytest

from teamformer.base.array_types import Int32s
from teamformer.base.kernels.jit import entry
from teamformer.mission.parts.shifts import Rota, fits_all
from teamformer.planning.problem import rotas as kernels
from teamformer.planning.problem.rotas import Rotas, longest_pauses, no_rotas, rotas_in_ticks

LATE = 10**6
KINDS = np.arange(4, dtype=np.int32)


@entry
def times_in(
    rotas: Rotas, kinds: Int32s, kind: int, begin: int, takes: int, size: int, short: int
) -> tuple[int, int, int]:
    """Return when a walk ends, when something fits, and when something short fits for several."""
    walked = kernels.walked(rotas, kind, begin, takes)
    start = kernels.fits(rotas, kind, begin, takes)
    return walked, start, kernels.fits_all(rotas, kinds, kinds, size, begin, short)


def draw_rota(rng: random.Random) -> Rota:
    moments = sorted(rng.sample(range(40), 2 * rng.randint(0, 3)))
    shifts = tuple(zip(moments[::2], moments[1::2], strict=True))
    longest = moments[-1] - moments[0] if moments else 0
    return Rota(shifts, rng.choice([0, longest, longest + 7]) if moments else 0)


@pytest.mark.parametrize("seed", range(20))
def test_kernels_are_twins_of_the_plain_rule(seed: int) -> None:
    rng = random.Random(seed)
    plain = [draw_rota(rng) for _ in range(3)] + [Rota(((2, 30),), 40)]
    rotas = rotas_in_ticks(plain, round, LATE, 0)
    for _ in range(50):
        kind, begin, takes = rng.randrange(4), rng.randrange(90), rng.randrange(60)
        size, short = rng.randint(1, 4), takes // 4
        found = times_in(rotas, KINDS, kind, begin, takes, size, short)
        due = (
            plain[kind].walked(begin, takes),
            plain[kind].fits(begin, takes),
            fits_all(plain[:size], begin, short),
        )
        for one, other in zip(found, due, strict=True):
            assert one >= LATE if math.isinf(other) else one == other


def test_a_walk_of_many_turns_is_worked_out_at_once() -> None:
    """Two ticks of every five, from tick 1 on: the last of 10,000 is done as a shift ends."""
    rota = Rota(((1, 3),), 5)
    rotas = rotas_in_ticks([rota], round, 10**12, 0)
    end, _, _ = times_in(rotas, KINDS, 0, 0, 10**4, 1, 0)
    assert end == 5 * (10**4 // 2 - 1) + 3 == rota.walked(0, 10**4)


def test_where_everybody_always_works_nothing_is_kept() -> None:
    rotas = rotas_in_ticks([Rota(), Rota()], round, LATE, 0)
    assert [part.size for part in rotas] == [0, 0, 0, 0]
    assert [part.size for part in no_rotas()] == [0, 0, 0, 0]
    assert longest_pauses([Rota()], 100.0, 5) == 0
    assert times_in(rotas, KINDS, 3, 5, 7, 1, 2)[0] == 12


def test_shifts_are_longer_by_what_times_are_rounded() -> None:
    rotas = rotas_in_ticks([Rota(((0, 10), (20, 30)))], round, LATE, 2)
    assert [times_in(rotas, KINDS, 0, begin, 9, 1, 0)[1] for begin in (3, 4)] == [3, 20]


@entry
def times_together(
    rotas: Rotas, count: int, begin: int, spent: int, arrival: Int32s, step: int
) -> tuple[int, int]:
    """Return when a walk of several ends, and when teams that arrive are one."""
    end = kernels.walk_together(rotas, KINDS, count, begin * step, spent * step, step)
    arriving = arrival.astype(np.int64)
    return end // step, kernels.pair_off_together(rotas, KINDS, count, arriving, len(arrival), step)


@pytest.mark.parametrize("step", [1, 4])
def test_those_who_walk_or_join_together_do_so_while_all_work(step: int) -> None:
    """Step by step: in steps in which all work they walk, and half of those there join."""
    rng = random.Random(step)
    for _ in range(200):
        plain = [draw_rota(rng) for _ in range(3)] + [Rota(((2, 30),), 40)]
        rotas = kernels.stretched(rotas_in_ticks(plain, int, LATE, 0), step)
        count, begin, spent = rng.randint(1, 4), rng.randrange(50), rng.randrange(20)
        arrival = sorted(rng.randrange(40) for _ in range(rng.randint(1, 4)))
        if not any(plain):
            continue
        found = times_together(rotas, count, begin, spent, np.array(arrival, np.int32), step)
        works = [fits_all(plain[:count], now, 1) == now for now in range(500)]
        if sum(works[begin:400]) >= spent:
            end = next(now for now in range(begin, 500) if sum(works[begin:now]) >= spent)
            assert found[0] == end
        else:
            assert found[0] > 400
        here = 0
        for now in range(400):
            if now and here > 1 and works[now - 1]:
                here = (here + 1) // 2
            here += arrival.count(now)
            if here == 1 and now >= arrival[-1]:
                assert found[1] == now
                break
        else:
            assert found[1] >= 400
