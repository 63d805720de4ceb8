"""The paper's original action space: to join or to split off every combination of capabilities.

An action is one of 2^(|C|+1) numbers: a set of capabilities, as bits, and above them whether to
split. To join a set is to join the nearest team that has just these capabilities; the empty set is
to maintain. To split a set off is to keep everything but one of each of these capabilities.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.errors import TeamformerError
from teamformer.base.kernels.jit import entry, kernel
from teamformer.methods.learned.onnx_sessions import GreedyChoice, OnnxNetwork, shipped
from teamformer.methods.learned.policy import Learned
from teamformer.methods.learned.token_features import TASK_FEATURES, TEAM_FEATURES, SpellingCodec
from teamformer.world.rules.splitting import anybody_fits
from teamformer.world.view import View

MOST_CAPABILITIES = 10
"""Beyond so many there would be thousands of actions."""


class Combined(NamedTuple):
    """Tokens of the deciding teams, each itself first; float32 and bool."""

    teams: Array  # (teams, 1 + seen, team_features(caps))
    tasks: Array  # (teams, tasks, task_features(caps))
    is_team: Array  # (teams, 1 + seen) False for padding
    is_task: Array  # (teams, tasks)
    is_legal: Array  # (teams, 2 ** (caps + 1))


def team_features(capabilities: int) -> int:
    """Return how many features a team's token has: also which capabilities, and how many."""
    return TEAM_FEATURES + 2 * capabilities


def task_features(capabilities: int) -> int:
    """Return how many features a task's token has."""
    return TASK_FEATURES + 2 * capabilities


class CombinationCodec:
    """Reads views as the paper's network does; an action is a combination, (teams,).

    Fewer capabilities than the network's are padded; more raise `TeamformerError`.
    """

    def __init__(self, capabilities: int) -> None:
        if capabilities > MOST_CAPABILITIES:
            hint = "use network: teamformer, whose actions grow with their number only"
            raise TeamformerError(
                f"{capabilities} capabilities make {2 ** (capabilities + 1)} actions; "
                f"{MOST_CAPABILITIES} are possible",
                hint,
            )
        self.capabilities = capabilities
        self._reader = SpellingCodec(capabilities)

    def encode(self, view: View) -> Combined:
        """Return the tokens of every team of a view."""
        read = self._reader.read(view)
        is_legal = np.zeros((len(view.slot), 2 ** (self.capabilities + 1)), dtype=np.bool_)
        _mark_legal(view, is_legal)
        return Combined(
            teams=_with_counts(read.teams, read.team_counts),
            tasks=_with_counts(read.tasks, read.task_needs),
            is_team=read.is_team,
            is_task=read.is_task,
            is_legal=is_legal,
        )

    def has_choice(self, view: View, tokens: tuple[Array, ...]) -> Array:
        """Return which teams have several legal actions, as (teams,)."""
        several: Array = tokens[-1].sum(axis=1) > 1
        return several

    def decode(self, view: View, action: Array) -> Array:
        """Return the counts that actions stand for, as (teams, caps)."""
        wanted = view.counts.copy()
        _write_wanted(view, np.asarray(action, dtype=np.int64), 2**self.capabilities, wanted)
        return wanted

    def action_for(self, view: View, wanted: Array) -> Array:
        """Return the combinations that are added, or dropped, (teams,) int64.

        What drops more than one of a capability drops only one: nothing more can be said.
        """
        change = wanted.astype(np.int64) - view.counts  # (teams, caps)
        bits = ((change != 0) << np.arange(change.shape[1])).sum(axis=1)
        splits = (change < 0).any(axis=1)
        actions: Array = bits + splits * 2**self.capabilities
        return actions


def _with_counts(features: Array, counts: Array) -> Array:
    """Return tokens that also say which capabilities there are, and how many."""
    parts = (features, counts > 0, np.log1p(counts))
    return np.concatenate(parts, axis=2, dtype=np.float32)


@kernel
def _set_of(counts: Array) -> int:
    """Return which capabilities there are, as bits."""
    bits = 0
    for cap in range(len(counts)):
        if counts[cap] > 0:
            bits |= 1 << cap
    return bits


@entry
def _mark_legal(view: View, is_legal: Array) -> None:
    sets = is_legal.shape[1] // 2
    left = np.empty(view.counts.shape[1], dtype=np.int64)
    for row in range(len(is_legal)):
        is_legal[row, 0] = True
        if view.is_serving[row]:
            continue
        for other in range(view.can_join.shape[1]):
            if view.can_join[row, other]:
                is_legal[row, _set_of(view.seen_counts[row, other])] = True
        if view.size[row] > 1:
            mine = _set_of(view.counts[row])
            off = mine
            while off > 0:  # every subset of what the team has
                is_legal[row, sets + off] = _somebody_stays(view, row, off, left)
                off = (off - 1) & mine


@kernel
def _somebody_stays(view: View, row: int, off: int, left: Array) -> bool:
    """Say whether some member fits into what is left when one of each of a set goes."""
    for cap in range(len(left)):
        left[cap] = view.counts[row, cap] - ((off >> cap) & 1)
    members = view.first_member[row], view.first_member[row + 1]
    return anybody_fits(view.member_counts, members[0], members[1], left)


@entry
def _write_wanted(view: View, action: Array, sets: int, wanted: Array) -> None:
    for row in range(len(wanted)):
        if action[row] >= sets:
            off = action[row] - sets
            for cap in range(wanted.shape[1]):
                wanted[row, cap] -= (off >> cap) & 1
        elif action[row] > 0:
            for other in range(view.can_join.shape[1]):
                theirs = view.seen_counts[row, other]
                if view.can_join[row, other] and _set_of(theirs) == action[row]:
                    for cap in range(wanted.shape[1]):
                        wanted[row, cap] += theirs[cap]
                    break


def combining(content: bytes, name: str, capabilities: int) -> Learned:
    """Return the policy that a network's file makes."""
    network = OnnxNetwork(content, name, Combined._fields)
    if network.width("teams") != team_features(capabilities):
        hint = "its policy.json has been changed; train or export it again"
        raise TeamformerError(f"{name} is not made for {capabilities} capabilities", hint)
    return Learned(CombinationCodec(capabilities), GreedyChoice(network))


def shipped_combining(name: str, capabilities: int) -> Learned:
    """Return the policy of a network that comes with the package: `NAME.onnx`."""
    return combining(shipped(f"{name}.onnx"), name, capabilities)
