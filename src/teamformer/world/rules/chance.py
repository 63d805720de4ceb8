"""Random numbers for kernels: xorshift64 (Marsaglia, Journal of Statistical Software 2003)."""

from __future__ import annotations

import math

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import kernel

STEPS = 1024
SLACKS = np.array([int(-STEPS * math.log((i + 0.5) / STEPS)) for i in range(STEPS)], np.int64)
"""How much worse a plan may be while annealing, in 1024ths of the temperature: the chance to be
allowed x or more is exp(-x). No entry is near enough to a whole number for a processor to round it
otherwise."""


def first_state(seed: int) -> np.uint64:
    """Return the state that a sequence of random numbers begins with; seeds differ, states too."""
    return np.uint64((seed * 2654435769 + 88172645463325252) % 2**64)


@kernel
def next_state(state: np.uint64) -> np.uint64:
    """Return the state after this one; never 0 if this one is not."""
    state ^= state << np.uint64(13)
    state ^= state >> np.uint64(7)
    state ^= state << np.uint64(17)
    return state


@kernel
def fraction(state: np.uint64) -> float:
    """Return the random number of a state, from 0 to just below 1."""
    return np.float64(state >> np.uint64(11)) / 9007199254740992.0


@kernel
def draw(random: Array) -> float:
    """Return a random number from 0 to just below 1, stepping the state that `random` holds."""
    random[0] = next_state(random[0])
    return fraction(random[0])


@kernel
def draw_below(random: Array, count: int) -> int:
    """Return a random whole number from 0 to count - 1, stepping the state that `random` holds."""
    return int(draw(random) * count)
