"""What would have been: the same world played again with one decision changed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor

from teamformer.base.array_types import Array
from teamformer.methods.learned.codec import Codec
from teamformer.methods.learned.macro_actions import FOLLOW
from teamformer.methods.learned.relational_features import Relations
from teamformer.methods.scripted.join_fitting import JoinFitting
from teamformer.mission.model import Mission
from teamformer.world.env import Decision, TeamFormation

LARGEST_GAIN = 6.0
"""Steps; what is won or lost is clipped here, so that a trial that fails outweighs nothing else."""


@dataclass(frozen=True)
class Trials:
    """Decisions in which a team did not follow the script, and what that brought; a row each."""

    tokens: tuple[Tensor, ...]  # each (rows, ...)
    other: Tensor  # (rows,) the choice made instead
    gain: Tensor  # (rows,) steps by which the mission ended earlier, clipped


@dataclass(frozen=True)
class _Tried:
    tokens: tuple[Array, ...]
    other: Array
    world: Array
    ended: Array  # (rows,) steps


def try_others(
    codec: Codec, worlds: Sequence[Mission], rng: np.random.Generator, share: float
) -> tuple[Trials, int]:
    """Play worlds by the script; in a share of the steps, one team of each does something else.

    What is tried is played on to its end by the script, in a fork of the environment, and compared
    with the end that came. Returns that and the steps played, forks included. The first step is
    always tried in; the trials may be none all the same, where no team has a choice.
    """
    env = TeamFormation(worlds)
    tried: list[_Tried] = []
    steps = 0
    while env.is_running.any():
        if not tried or rng.random() < share:
            fork = env.fork()
            tried.append(_try_one(fork, codec, rng))
            steps += int((fork.worlds.count["steps"] - env.worlds.count["steps"]).sum())
        env.step(JoinFitting().decide(env.view()))
    ended = env.worlds.count["steps"].astype(np.float64)
    return _compare(tried, ended), steps + int(ended.sum())


def _try_one(env: TeamFormation, codec: Codec, rng: np.random.Generator) -> _Tried:
    """Change one decision of each running world where there is a choice; play on to the end."""
    view = env.view()
    tokens = codec.encode(view)
    could = Relations(*tokens).is_legal.copy()
    could[:, FOLLOW] = False
    rows = _one_of_each(view.world, np.asarray(could.any(axis=1)), rng)
    other = np.where(could[rows], rng.random((len(rows), could.shape[1])), -1.0).argmax(axis=1)
    world, kept = view.world[rows].copy(), tuple(part[rows] for part in tokens)
    choice = np.full(len(view.slot), FOLLOW)
    choice[rows] = other
    env.step(Decision(codec.decode(view, choice)))
    while len(rows) and env.is_running.any():
        env.step(JoinFitting().decide(env.view()))
    return _Tried(kept, other, world, env.worlds.count["steps"][world].astype(np.float64))


def _one_of_each(world: Array, is_possible: Array, rng: np.random.Generator) -> Array:
    """Return a random possible row of each world that has one."""
    rows = rng.permutation(np.flatnonzero(is_possible))
    return rows[np.unique(world[rows], return_index=True)[1]]


def _compare(tried: Sequence[_Tried], ended: Array) -> Trials:
    tokens = zip(*(one.tokens for one in tried), strict=True)
    gains = [np.clip(ended[one.world] - one.ended, -LARGEST_GAIN, LARGEST_GAIN) for one in tried]
    return Trials(
        tuple(torch.from_numpy(np.concatenate(parts)) for parts in tokens),
        torch.from_numpy(np.concatenate([one.other for one in tried])),
        torch.from_numpy(np.concatenate(gains).astype(np.float32)),
    )
