"""The codec of the paper's network: views as tokens of teams and tasks, actions as wanted counts.

Places are relative to the own team, in units of ten cells, and relative to the box around all that
is in view, so that they mean the same on a grid of any size.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.errors import TeamformerError
from teamformer.base.kernels.jit import entry, kernel
from teamformer.methods.learned.feature_layout import OwnToken, PlaceToken, SeenToken, TaskToken
from teamformer.methods.scripted.pairing import pair_by_slot
from teamformer.world.rules.constants import NOBODY
from teamformer.world.view import View

TEAM_FEATURES, TASK_FEATURES = max(SeenToken) + 1, max(TaskToken) + 1
REACH = 10.0  # cells; offsets are in these units
FARTHEST = 2.0  # of them; clipped here
NEVER_FITS = 1e9  # the counts of a profile that is only padding
MOST_SPELLED = 1000
"""Of a robot's count, in units: one symbol each."""


class Spelled(NamedTuple):
    """Tokens of the deciding teams, each itself first; float32 and bool.

    `singles` holds, for each capability, the least count of it that one of the team's robots with
    no other has (0: there is none); `profiles` the counts of the robots with several, each kind
    once. Both are without robots in a team that must maintain.
    """

    teams: Array  # (teams, 1 + seen, TEAM_FEATURES)
    team_counts: Array  # (teams, 1 + seen, caps)
    tasks: Array  # (teams, tasks, TASK_FEATURES)
    task_needs: Array  # (teams, tasks, caps)
    is_team: Array  # (teams, 1 + seen) False for padding
    is_task: Array  # (teams, tasks)
    can_join: Array  # (teams, 1 + seen) the first, itself, never
    singles: Array  # (teams, caps)
    profiles: Array  # (teams, 1 + seen, caps)


class SpellingCodec:
    """Reads views for a network of so many capabilities; an action is the wanted counts.

    Fewer capabilities are padded; more raise `TeamformerError`. A team with more than
    `1 + seen` different kinds of robots with several capabilities splits for the first ones.
    """

    def __init__(self, capabilities: int) -> None:
        self.capabilities = capabilities

    def encode(self, view: View) -> Spelled:
        """Return the tokens of every team of a view."""
        most = int(view.member_counts.max(initial=0))
        if most > MOST_SPELLED:
            raise TeamformerError(
                f"the network spells counts one by one, and a robot brings {most:,} units of a "
                f"capability; {MOST_SPELLED:,} are possible",
                "use rounder figures, or teamformer, which spells nothing",
            )
        return self.read(view)

    def read(self, view: View) -> Spelled:
        """Return the same for a network that spells nothing."""
        rows, caps = view.counts.shape
        if caps > self.capabilities:
            raise TeamformerError(
                f"the network knows {self.capabilities} capabilities, the mission has {caps}",
                "use teamformer, which serves any number",
            )
        seen, tasks = 1 + view.seen_slot.shape[1], view.task_number.shape[1]
        tokens = Spelled(
            teams=_zeros(rows, seen, TEAM_FEATURES),
            team_counts=_zeros(rows, seen, self.capabilities),
            tasks=_zeros(rows, tasks, TASK_FEATURES),
            task_needs=_zeros(rows, tasks, self.capabilities),
            is_team=np.zeros((rows, seen), dtype=np.bool_),
            is_task=np.zeros((rows, tasks), dtype=np.bool_),
            can_join=np.zeros((rows, seen), dtype=np.bool_),
            singles=_zeros(rows, self.capabilities),
            profiles=np.full((rows, seen, self.capabilities), NEVER_FITS, dtype=np.float32),
        )
        _fill(view, tokens)
        return tokens

    def has_choice(self, view: View, tokens: tuple[Array, ...]) -> Array:
        """Return which teams can do anything but maintain, as (teams,)."""
        spelled = Spelled(*tokens)
        brings = (spelled.team_counts > 0).any(axis=2)  # (teams, seen)
        can_split = (view.size > 1) & ~view.is_serving & (view.counts > 0).any(axis=1)
        can_form: Array = can_split | (spelled.can_join & brings).any(axis=1)
        return can_form

    def decode(self, view: View, action: Array) -> Array:
        """Return the counts that actions (teams, caps) stand for, without the padding."""
        return action[:, : view.counts.shape[1]].astype(np.int32)

    def action_for(self, view: View, wanted: Array) -> Array:
        """Return counts (teams, caps) as they are, with the padding, int64."""
        padding = self.capabilities - wanted.shape[1]
        return np.pad(wanted.astype(np.int64), ((0, 0), (0, padding)))


def _zeros(*shape: int) -> Array:
    return np.zeros(shape, dtype=np.float32)


@entry
def _fill(view: View, tokens: Spelled) -> None:
    box = np.zeros(4)
    for row in range(len(view.slot)):
        _find_box(view, row, box)
        _write_own(view, tokens, row, box)
        paired = pair_by_slot(view, row, False)
        for other in range(view.seen_slot.shape[1]):
            if view.seen_slot[row, other] != NOBODY:
                _write_team(view, tokens, row, other, box)
                tokens.teams[row, other + 1, SeenToken.IS_PAIRED] = other == paired
        for column in range(view.task_number.shape[1]):
            if view.task_number[row, column] != NOBODY:
                _write_task(view, tokens, row, column, box)
        if not view.is_serving[row]:
            _write_members(view, tokens, row)


@kernel
def _find_box(view: View, row: int, box: Array) -> None:
    """Write the middle and half the longer side of the box around all places in view."""
    left = right = view.place[row, 0]
    low = high = view.place[row, 1]
    for column in range(view.task_number.shape[1]):
        if view.task_number[row, column] != NOBODY:
            left = min(left, view.task_place[row, column, 0])
            right = max(right, view.task_place[row, column, 0])
            low = min(low, view.task_place[row, column, 1])
            high = max(high, view.task_place[row, column, 1])
    box[0], box[1] = (left + right) / 2, (low + high) / 2
    box[2] = max(right - left, high - low) / 2


@kernel
def _write_place(view: View, row: int, place: Array, box: Array, out: Array) -> None:
    """Write a place, as seen by a team, into the first eight features."""
    away_x = (place[0] - view.place[row, 0]) / view.unit[row]
    away_y = (place[1] - view.place[row, 1]) / view.unit[row]
    away = abs(away_x) + abs(away_y)
    if (away_x * away_x + away_y * away_y) * view.unit[row] ** 2 <= view.arrival_radius[row] ** 2:
        away = 0.0
    half = max(box[2], 1e-9)
    out[PlaceToken.AWAY_X] = min(max(away_x / REACH, -FARTHEST), FARTHEST)
    out[PlaceToken.AWAY_Y] = min(max(away_y / REACH, -FARTHEST), FARTHEST)
    out[PlaceToken.AWAY] = min(away / REACH, FARTHEST)
    out[PlaceToken.IS_HERE] = away == 0.0
    out[PlaceToken.IS_ONE_AWAY] = 0.0 < away < 1.5
    out[PlaceToken.IS_TWO_AWAY] = 1.5 <= away < 2.5
    out[PlaceToken.IN_BOX_X] = min(max((place[0] - box[0]) / half, -FARTHEST), FARTHEST)
    out[PlaceToken.IN_BOX_Y] = min(max((place[1] - box[1]) / half, -FARTHEST), FARTHEST)


@kernel
def _write_own(view: View, tokens: Spelled, row: int, box: Array) -> None:
    out = tokens.teams[row, 0]
    _write_place(view, row, view.place[row], box, out)
    lower = here = 0
    for other in range(view.seen_slot.shape[1]):
        if view.seen_slot[row, other] != NOBODY and view.is_here[row, other]:
            here += 1
            lower += view.seen_slot[row, other] < view.slot[row]
    total = 0
    for cap in range(view.counts.shape[1]):
        tokens.team_counts[row, 0, cap] = view.counts[row, cap]
        total += view.counts[row, cap]
    out[OwnToken.IS_SELF] = 1.0  # itself
    out[OwnToken.HAS_NO_TASK] = view.task[row] == NOBODY
    out[OwnToken.IS_AT_TASK] = view.is_at_task[row]
    out[OwnToken.HERE] = min(here, 8) / 8
    out[OwnToken.HAS_ODD_RANK_HERE] = lower % 2
    out[OwnToken.RANK_HERE] = min(lower, 8) / 8
    out[OwnToken.COUNTS] = min(total, 16) / 16
    out[OwnToken.IS_ALONE] = view.size[row] == 1
    tokens.is_team[row, 0] = True


@kernel
def _write_team(view: View, tokens: Spelled, row: int, other: int, box: Array) -> None:
    column = other + 1
    out = tokens.teams[row, column]
    _write_place(view, row, view.seen_place[row, other], box, out)
    total = 0
    for cap in range(view.counts.shape[1]):
        tokens.team_counts[row, column, cap] = view.seen_counts[row, other, cap]
        total += view.seen_counts[row, other, cap]
    task = view.seen_task[row, other]
    out[PlaceToken.IS_HERE] = view.is_here[row, other]
    out[SeenToken.HAS_NO_TASK] = task == NOBODY
    out[SeenToken.SHARES_TASK] = task != NOBODY and task == view.task[row]
    out[SeenToken.CAN_JOIN] = view.can_join[row, other]
    out[SeenToken.HAS_LOWER_SLOT] = view.seen_slot[row, other] < view.slot[row]
    out[SeenToken.COUNTS] = min(total, 16) / 16
    _compare_union(view, row, other, out)
    tokens.is_team[row, column] = True
    tokens.can_join[row, column] = view.can_join[row, other]


@kernel
def _compare_union(view: View, row: int, other: Array, out: Array) -> None:
    """Say for what a seen team is of use."""
    useful = completed = 0
    for column in range(view.task_number.shape[1]):
        if view.task_number[row, column] == NOBODY:
            continue
        adds, both, alone = False, True, True
        for cap in range(view.counts.shape[1]):
            need, have = view.task_needs[row, column, cap], view.counts[row, cap]
            theirs = view.seen_counts[row, other, cap]
            adds |= need > have and theirs > 0
            both &= have + theirs >= need
            alone &= have >= need
        useful += adds
        completed += both and not alone
        if column == 0:
            out[SeenToken.ADDS_TO_FIRST] = adds
            out[SeenToken.COMPLETES_FIRST] = both and not alone
    out[SeenToken.TASKS_HELPED] = min(useful, 8) / 8
    out[SeenToken.TASKS_COMPLETED] = min(completed, 8) / 8


@kernel
def _write_task(view: View, tokens: Spelled, row: int, column: int, box: Array) -> None:
    out = tokens.tasks[row, column]
    _write_place(view, row, view.task_place[row, column], box, out)
    task = view.task_number[row, column]
    total = covered = beyond = 0
    for cap in range(view.counts.shape[1]):
        need, have = view.task_needs[row, column, cap], view.counts[row, cap]
        tokens.task_needs[row, column, cap] = need
        total += need
        covered += min(have, need)
        beyond += max(have - need, 0)
    rank = view.task_rank[row, column]
    out[TaskToken.IS_MINE] = task == view.task[row]
    out[TaskToken.RANK] = min(rank, 16) / 16
    out[TaskToken.IS_FIRST_IN_ORDER] = rank == 0
    out[TaskToken.IS_FIRST_IN_VIEW] = column == 0
    out[TaskToken.COVERED] = covered / max(total, 1)
    out[TaskToken.IS_COVERED] = covered == total
    out[TaskToken.HELPS] = covered > 0
    out[TaskToken.HAS_SURPLUS] = beyond > 0
    helpers = 0
    for other in range(view.seen_slot.shape[1]):
        helpers += view.seen_slot[row, other] != NOBODY and view.seen_task[row, other] == task
    out[TaskToken.HELPERS] = min(helpers, 4) / 4
    out[TaskToken.COVERED_TOGETHER] = _share_together(view, row, column, task)
    out[TaskToken.NEEDS] = min(total, 8) / 8
    tokens.is_task[row, column] = True


@kernel
def _share_together(view: View, row: int, column: int, task: int) -> float:
    """Return which share of a task's needs the team covers with those seen heading there."""
    total = covered = 0
    for cap in range(view.counts.shape[1]):
        together = view.counts[row, cap]
        for other in range(view.seen_slot.shape[1]):
            if view.seen_slot[row, other] != NOBODY and view.seen_task[row, other] == task:
                together += view.seen_counts[row, other, cap]
        total += view.task_needs[row, column, cap]
        covered += min(together, view.task_needs[row, column, cap])
    return covered / max(total, 1)


@kernel
def _write_members(view: View, tokens: Spelled, row: int) -> None:
    """Write what the robots of a team need to stay in it."""
    kinds = 0
    for member in range(view.first_member[row], view.first_member[row + 1]):
        several, only = 0, 0
        for cap in range(view.counts.shape[1]):
            if view.member_counts[member, cap] > 0:
                several += 1
                only = cap
        if several == 1:
            need, least = view.member_counts[member, only], tokens.singles[row, only]
            tokens.singles[row, only] = need if least == 0 else min(least, need)
        elif kinds < tokens.profiles.shape[1] and _is_new_kind(view, tokens, row, member, kinds):
            for cap in range(tokens.profiles.shape[2]):
                tokens.profiles[row, kinds, cap] = 0
            for cap in range(view.counts.shape[1]):
                tokens.profiles[row, kinds, cap] = view.member_counts[member, cap]
            kinds += 1


@kernel
def _is_new_kind(view: View, tokens: Spelled, row: int, member: int, kinds: int) -> bool:
    for kind in range(kinds):
        is_same = True
        for cap in range(view.counts.shape[1]):
            is_same &= tokens.profiles[row, kind, cap] == view.member_counts[member, cap]
        if is_same:
            return False
    return True
