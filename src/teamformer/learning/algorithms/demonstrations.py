"""What a script would do, in the states that a network's own decisions lead to.

So the network learns the way back from its own mistakes, too (DAgger; Ross, Gordon and Bagnell
2011), deadlocks above all, into which the script never leads.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor

from teamformer.base.array_types import Array
from teamformer.learning.algorithms.rollout import Chooser
from teamformer.methods.learned.codec import ImitatingCodec
from teamformer.methods.learned.policy import rows_of
from teamformer.methods.scripted.join_fitting import JoinFitting
from teamformer.mission.model import Mission
from teamformer.world.env import Decision, TeamFormation
from teamformer.world.state.arrays import COMPLETED
from teamformer.world.view import View


@dataclass(frozen=True)
class Demonstrations:
    """What the script wanted in states that came up; a row for each decision that is kept."""

    tokens: tuple[Tensor, ...]  # each (rows, ...)
    action: Tensor  # (rows, ...) the script's
    agreed: float  # share of the network's own decisions that were the script's
    ended: float  # share of the worlds it played that it brought to their end


def demonstrate(
    codec: ImitatingCodec,
    choose: Chooser,
    worlds: Sequence[Mission],
    rng: np.random.Generator,
    by_script: float,
    share: float,
) -> tuple[Demonstrations, int]:
    """Let the script play a share of the worlds and a network the others, to their end.

    Kept is what the script wanted of teams that have somebody to join, and of a share of those
    that could only split. Returns that and the steps of worlds played.
    """
    env = TeamFormation(worlds)
    is_scripted = rng.random(len(worlds)) < by_script  # (worlds,)
    kept: list[tuple[Array, ...]] = []
    own = agreed = 0
    while env.is_running.any():
        view = env.view()
        tokens, wanted = codec.encode(view), JoinFitting().decide(view).wanted
        has_choice = codec.has_choice(view, tokens)
        is_kept = view.can_join.any(axis=1) | (rng.random(len(has_choice)) < share)
        rows = np.flatnonzero(has_choice & is_kept)
        action = codec.action_for(view, wanted)
        kept.append((*(part[rows] for part in tokens), action[rows]))
        rows = np.flatnonzero(has_choice & ~is_scripted[view.world])
        played = _play(codec, choose, view, tokens, wanted, rows)
        own, agreed = own + len(rows), agreed + int((played == wanted).all(axis=1)[rows].sum())
        env.step(Decision(played))
    *seen, actions = (torch.from_numpy(np.concatenate(p)) for p in zip(*kept, strict=True))
    has_ended = env.worlds.count["status"][~is_scripted] == COMPLETED
    shown = Demonstrations(
        tuple(seen), actions, agreed / max(1, own), float(has_ended.sum()) / max(1, len(has_ended))
    )
    return shown, int(env.worlds.count["steps"].sum())


def _play(
    codec: ImitatingCodec,
    choose: Chooser,
    view: View,
    tokens: tuple[Array, ...],
    wanted: Array,
    rows: Array,
) -> Array:
    """Return what teams want (teams, caps): in these rows what the network chooses."""
    played = wanted.copy()
    if len(rows):
        action, _ = choose(tuple(part[rows] for part in tokens))
        played[rows] = codec.decode(rows_of(view, rows), action)
    return played
