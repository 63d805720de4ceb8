"""What a team's view says in relations, for any number of capabilities.

No feature belongs to a capability: each counts, compares or adds up over all of them, so that the
names and the number of capabilities mean nothing. Distances are in cells (on a plane, in units
that count as one), clipped and scaled.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import entry, kernel
from teamformer.methods.learned.feature_layout import OwnRelation as Own
from teamformer.methods.learned.feature_layout import TaskRelation as Task
from teamformer.methods.learned.feature_layout import TeamRelation as Team
from teamformer.methods.learned.macro_actions import (
    HALVE,
    JOIN,
    MAINTAIN,
    SHED,
    SPLIT,
    TASKS,
    TEAMS,
    keep_for,
    legal_choices,
    scripted_counts,
)
from teamformer.methods.scripted.pairing import pair_by_slot
from teamformer.world.rules.constants import NOBODY
from teamformer.world.view import View

OWN_FEATURES, TEAM_FEATURES = len(Own), len(Team)
TASK_FEATURES = len(Task)

FARTHEST, NEAR = 20.0, 4.0  # cells; distances are clipped here, coarse and fine


class Relations(NamedTuple):
    """A token for each team, for teams it sees and for its next tasks; float32 and bool."""

    own: Array  # (teams, OWN_FEATURES)
    teams: Array  # (teams, TEAMS, TEAM_FEATURES)
    tasks: Array  # (teams, TASKS, TASK_FEATURES)
    is_team: Array  # (teams, TEAMS) False for padding
    is_task: Array  # (teams, TASKS)
    is_legal: Array  # (teams, CHOICES)


def relate(view: View) -> Relations:
    """Return the relations of every team of a view."""
    rows, scripted = len(view.slot), scripted_counts(view)
    relations = Relations(
        own=np.zeros((rows, OWN_FEATURES), dtype=np.float32),
        teams=np.zeros((rows, TEAMS, TEAM_FEATURES), dtype=np.float32),
        tasks=np.zeros((rows, TASKS, TASK_FEATURES), dtype=np.float32),
        is_team=np.zeros((rows, TEAMS), dtype=np.bool_),
        is_task=np.zeros((rows, TASKS), dtype=np.bool_),
        is_legal=legal_choices(view, scripted),
    )
    _fill(view, scripted, relations)
    return relations


@entry
def _fill(view: View, scripted: Array, relations: Relations) -> None:
    caps = view.counts.shape[1]
    kept = np.zeros(caps, dtype=np.int32)
    for row in range(len(view.slot)):
        _relate_tasks(view, relations, row, kept)
        _relate_teams(view, relations, row)
        _relate_script(view, scripted, relations, row)
        _relate_self(view, relations, row)
        _relate_parts(view, relations, row, kept)


@kernel
def _cells_between(view: View, row: int, here: Array, there: Array) -> float:
    """Return the Manhattan distance in cells, 0 in the same place."""
    away_x, away_y = abs(here[0] - there[0]), abs(here[1] - there[1])
    if away_x * away_x + away_y * away_y <= view.arrival_radius[row] ** 2:
        return 0.0
    return (away_x + away_y) / view.unit[row]


@kernel
def _distance(view: View, row: int, here: Array, there: Array) -> float:
    return min(_cells_between(view, row, here, there), FARTHEST) / FARTHEST


@kernel
def _nearness(view: View, row: int, here: Array, there: Array) -> float:
    """Return a distance that tells the last cells apart."""
    return min(_cells_between(view, row, here, there), NEAR) / NEAR


@kernel
def _share(have: Array, extra: Array, needs: Array) -> float:
    """Return which share of the needs two teams cover together."""
    covered = needed = 0
    for cap in range(len(needs)):
        needed += needs[cap]
        covered += min(have[cap] + extra[cap], needs[cap])
    return covered / needed if needed > 0 else 1.0


@kernel
def _surplus(have: Array, needs: Array) -> float:
    """Return which share of a team's counts a task does not need."""
    beyond = total = 0
    for cap in range(len(needs)):
        total += have[cap]
        beyond += max(have[cap] - needs[cap], 0)
    return beyond / max(total, 1)


@kernel
def _overlap(have: Array, other: Array) -> float:
    """Return which share of a team's counts another has too."""
    both = total = 0
    for cap in range(len(have)):
        total += have[cap]
        both += min(have[cap], other[cap])
    return both / total if total > 0 else 0.0


@kernel
def _column_of_task(view: View, row: int, task: int) -> int:
    """Return where a task stands in the row's view, or NOBODY."""
    if task != NOBODY:
        for column in range(view.task_number.shape[1]):
            if view.task_number[row, column] == task:
                return column
    return NOBODY


@kernel
def _relate_tasks(view: View, relations: Relations, row: int, kept: Array) -> None:
    caps = view.counts.shape[1]
    have = view.counts[row]
    for column in range(min(TASKS, view.task_number.shape[1])):
        task = view.task_number[row, column]
        if task == NOBODY:
            continue
        relations.is_task[row, column] = True
        needs = view.task_needs[row, column]
        out = relations.tasks[row, column]
        total = covered = 0
        for cap in range(caps):
            total += needs[cap]
            covered += min(have[cap], needs[cap])
            kept[cap] = min(have[cap], needs[cap])
        mine = covered / max(total, 1)
        out[Task.IS_MINE] = task == view.task[row]
        out[Task.RANK] = min(view.task_rank[row, column], 8) / 8
        out[Task.DISTANCE] = _distance(view, row, view.place[row], view.task_place[row, column])
        out[Task.IS_HERE] = out[Task.DISTANCE] == 0.0
        out[Task.COVERED] = mine
        out[Task.IS_COVERED] = mine == 1.0
        out[Task.HELPS] = covered > 0
        out[Task.SURPLUS] = _surplus(have, needs)
        out[Task.FROM_FIRST] = _distance(
            view, row, view.task_place[row, 0], view.task_place[row, column]
        )
        out[Task.NEEDS] = min(total, 10) / 10
        _relate_helpers(view, out, row, task, needs)
        _relate_rest(view, out, row, column, kept)
        _relate_ways(view, out, row, column, kept)
        out[Task.CAN_SPLIT_FOR] = relations.is_legal[row, SPLIT + column]
        out[Task.NEARNESS] = _nearness(view, row, view.place[row], view.task_place[row, column])


@kernel
def _relate_helpers(view: View, out: Array, row: int, task: int, needs: Array) -> None:
    """Say who else in sight heads for the task, and what they bring together."""
    helpers = here = covered = with_me = total = 0
    for other in range(view.seen_slot.shape[1]):
        if view.seen_slot[row, other] != NOBODY and view.seen_task[row, other] == task:
            helpers += 1
            here += view.is_here[row, other]
    for cap in range(len(needs)):
        together = 0
        for other in range(view.seen_slot.shape[1]):
            if view.seen_slot[row, other] != NOBODY and view.seen_task[row, other] == task:
                together += view.seen_counts[row, other, cap]
        total += needs[cap]
        covered += min(together, needs[cap])
        with_me += min(together + view.counts[row, cap], needs[cap])
    out[Task.HELPERS] = min(helpers, 4) / 4
    out[Task.HELPERS_HERE] = min(here, 4) / 4
    out[Task.COVERED_BY_HELPERS] = covered / max(total, 1)
    out[Task.COVERED_WITH_ME] = with_me / max(total, 1)
    out[Task.IS_COVERED_WITH_ME] = with_me == total


@kernel
def _relate_rest(view: View, out: Array, row: int, column: int, kept: Array) -> None:
    """Say what those could do who would leave if only what the task needs stayed."""
    alone = useful = 0
    for other in range(view.task_number.shape[1]):
        if other == column or view.task_number[row, other] == NOBODY:
            continue
        can_do, helps = True, False
        for cap in range(len(kept)):
            rest = view.counts[row, cap] - kept[cap]
            can_do &= rest >= view.task_needs[row, other, cap]
            helps |= rest > 0 and view.task_needs[row, other, cap] > 0
        alone += can_do
        useful += helps
    out[Task.REST_DOES_ALONE] = min(alone, 8) / 8
    out[Task.REST_HELPS] = min(useful, 8) / 8


@kernel
def _relate_ways(view: View, out: Array, row: int, column: int, kept: Array) -> None:
    """Say what way those save who go straight to what comes after the task if it needs them."""
    here, task = view.place[row], view.task_place[row, column]
    for other in range(view.task_number.shape[1]):
        if other == column or view.task_number[row, other] == NOBODY:
            continue
        needs, there = view.task_needs[row, other], view.task_place[row, other]
        helps, all_helps, alone = False, False, True
        for cap in range(len(kept)):
            rest = view.counts[row, cap] - kept[cap]
            helps |= rest > 0 and needs[cap] > 0
            all_helps |= kept[cap] > 0 and needs[cap] > rest
            alone &= rest >= needs[cap]
        if helps:
            around = _cells_between(view, row, here, task) + _cells_between(view, row, task, there)
            straight = _cells_between(view, row, here, there)
            out[Task.WAY_SAVED] = max(-1.0, min(around - straight, FARTHEST) / FARTHEST)
            out[Task.WAY_SAVED_NEAR] = min(around - straight, NEAR) / NEAR
            out[Task.NEXT_IS_DONE_BY_REST] = alone
            out[Task.NEXT_NEEDS_STAYERS] = all_helps
            out[Task.NEXT_DISTANCE] = min(straight, FARTHEST) / FARTHEST
            return


@kernel
def _relate_script(view: View, scripted: Array, relations: Relations, row: int) -> None:
    """Say whom the script would join, and how fast the team is."""
    own = relations.own[row]
    own[Own.PACE] = min(view.pace[row] / view.unit[row], 2.0) / 2
    own[Own.SCRIPT_FORMS] = relations.is_legal[row, MAINTAIN]  # the script would join
    for other in range(min(TEAMS, view.seen_slot.shape[1])):
        if view.seen_slot[row, other] == NOBODY:
            continue
        out = relations.teams[row, other]
        out[Team.IS_MATE] = True
        out[Team.SCRIPT_JOINS] = relations.is_legal[row, MAINTAIN]
        for cap in range(view.counts.shape[1]):
            union = view.counts[row, cap] + view.seen_counts[row, other, cap]
            if union != scripted[row, cap]:
                out[Team.SCRIPT_JOINS] = 0.0
        own[Own.SCRIPT_JOINS] = max(own[Own.SCRIPT_JOINS], out[Team.SCRIPT_JOINS])


@kernel
def _relate_teams(view: View, relations: Relations, row: int) -> None:
    have = view.counts[row]
    own = _column_of_task(view, row, view.task[row])
    pair = pair_by_slot(view, row, False)
    for other in range(min(TEAMS, view.seen_slot.shape[1])):
        if view.seen_slot[row, other] == NOBODY:
            continue
        relations.is_team[row, other] = True
        theirs = view.seen_counts[row, other]
        out = relations.teams[row, other]
        out[Team.DISTANCE] = _distance(view, row, view.place[row], view.seen_place[row, other])
        out[Team.IS_HERE] = view.is_here[row, other]
        out[Team.CAN_JOIN] = relations.is_legal[row, JOIN + other]
        out[Team.HAS_LOWER_SLOT] = view.seen_slot[row, other] < view.slot[row]
        out[Team.HAS_NO_TASK] = view.seen_task[row, other] == NOBODY
        out[Team.SHARES_TASK] = own != NOBODY and view.seen_task[row, other] == view.task[row]
        out[Team.HAS_OF_MINE] = _overlap(have, theirs)
        out[Team.HAVE_OF_THEIRS] = _overlap(theirs, have)
        if own != NOBODY:
            needs = view.task_needs[row, own]
            alone, together = _share_alone(have, needs), _share(have, theirs, needs)
            out[Team.ADDS_TO_MINE] = together - alone
            out[Team.COMPLETES_MINE] = together == 1.0 and alone < 1.0
            out[Team.COVERS_MINE] = _share_alone(theirs, needs)
        column = _column_of_task(view, row, view.seen_task[row, other])
        if column != NOBODY:
            needs = view.task_needs[row, column]
            alone, together = _share_alone(theirs, needs), _share(have, theirs, needs)
            out[Team.GAINS_FROM_ME] = together - alone
            out[Team.IS_COMPLETED_BY_ME] = together == 1.0 and alone < 1.0
            out[Team.DOES_ITS_OWN] = alone == 1.0
            if own != NOBODY:
                out[Team.HAS_EARLIER_TASK] = view.task_rank[row, column] < view.task_rank[row, own]
            there = view.task_place[row, column]
            out[Team.WAY_TO_ITS_TASK] = _distance(view, row, view.seen_place[row, other], there)
            out[Team.NEARNESS_OF_ITS_TASK] = _nearness(
                view, row, view.seen_place[row, other], there
            )
            if own != NOBODY:
                out[Team.WAY_BETWEEN_TASKS] = _distance(view, row, view.task_place[row, own], there)
        out[Team.IS_PAIRED] = other == pair
        out[Team.NEARNESS] = _nearness(view, row, view.place[row], view.seen_place[row, other])
        _relate_union(view, out, row, have, theirs)


@kernel
def _share_alone(have: Array, needs: Array) -> float:
    covered = needed = 0
    for cap in range(len(needs)):
        needed += needs[cap]
        covered += min(have[cap], needs[cap])
    return covered / needed if needed > 0 else 1.0


@kernel
def _relate_union(view: View, out: Array, row: int, have: Array, theirs: Array) -> None:
    """Say how many tasks in view the two could do together and neither alone."""
    gained = shared = 0
    adds = False
    for column in range(view.task_number.shape[1]):
        if view.task_number[row, column] == NOBODY:
            continue
        mine, other, both = True, True, True
        for cap in range(len(have)):
            need = view.task_needs[row, column, cap]
            mine &= have[cap] >= need
            other &= theirs[cap] >= need
            both &= have[cap] + theirs[cap] >= need
            adds |= need > have[cap] and theirs[cap] > 0
        gained += both and not mine and not other
        shared += mine and other
    out[Team.TASKS_GAINED] = min(gained, 8) / 8
    out[Team.TASKS_SHARED] = min(shared, 8) / 8
    out[Team.ADDS_ANYTHING] = adds


@kernel
def _relate_self(view: View, relations: Relations, row: int) -> None:
    out = relations.own[row]
    here = joinable = seen = lower = 0
    for other in range(view.seen_slot.shape[1]):
        if view.seen_slot[row, other] != NOBODY:
            seen += 1
            here += view.is_here[row, other]
            joinable += view.can_join[row, other]
            lower += view.is_here[row, other] and view.seen_slot[row, other] < view.slot[row]
    open_tasks = alone = 0
    for column in range(view.task_number.shape[1]):
        if view.task_number[row, column] != NOBODY:
            open_tasks += 1
            alone += _share_alone(view.counts[row], view.task_needs[row, column]) == 1.0
    counts = 0
    for cap in range(view.counts.shape[1]):
        counts += view.counts[row, cap]
    out[Own.IS_ALONE] = view.size[row] == 1
    out[Own.SIZE] = min(view.size[row], 16) / 16
    out[Own.COUNTS] = min(counts, 16) / 16
    out[Own.HAS_NO_TASK] = view.task[row] == NOBODY
    out[Own.IS_AT_TASK] = view.is_at_task[row]
    out[Own.SEEN] = min(seen, 9) / 9
    out[Own.HERE] = min(here, 9) / 9
    out[Own.JOINABLE] = min(joinable, 9) / 9
    out[Own.HAS_ODD_RANK_HERE] = lower % 2
    out[Own.RANK_HERE] = min(lower, 8) / 8
    out[Own.OPEN_TASKS] = min(open_tasks, 16) / 16
    out[Own.TASKS_ALONE] = alone / max(open_tasks, 1)
    out[Own.FIRST_COVERED] = relations.tasks[row, 0, Task.COVERED]
    out[Own.FIRST_DISTANCE] = relations.tasks[row, 0, Task.DISTANCE]


@kernel
def _relate_parts(view: View, relations: Relations, row: int, kept: Array) -> None:
    """Say which share of the tasks in view each part could do alone after the wholesale splits."""
    out = relations.own[row]
    out[Own.CAN_HALVE] = relations.is_legal[row, HALVE]
    out[Own.CAN_SHED] = relations.is_legal[row, SHED]
    keep_for(view, row, HALVE, kept)
    out[Own.REST_AFTER_HALVING] = _share_done_by_rest(view, row, kept)
    keep_for(view, row, SHED, kept)
    out[Own.REST_AFTER_SHEDDING] = _share_done_by_rest(view, row, kept)


@kernel
def _share_done_by_rest(view: View, row: int, kept: Array) -> float:
    tasks = done = 0
    for column in range(view.task_number.shape[1]):
        if view.task_number[row, column] == NOBODY:
            continue
        can_do = True
        for cap in range(len(kept)):
            rest = view.counts[row, cap] - kept[cap]
            can_do &= rest >= view.task_needs[row, column, cap]
        tasks += 1
        done += can_do
    return done / max(tasks, 1)
