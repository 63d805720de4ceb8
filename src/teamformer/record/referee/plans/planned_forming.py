"""Who has to part and join by the plans of a record, and that nobody else does.

Teams decide by the plan wherever they go by one and no decision of the record names a task.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from teamformer.mission.parts.capabilities import covers, total
from teamformer.mission.parts.grid import Place
from teamformer.record.record import Step
from teamformer.record.referee.plans.planned_tasks import PlannedTasks
from teamformer.record.referee.rules.completion import Tasks
from teamformer.record.referee.rules.formation import first_that_fit, list_robots
from teamformer.record.referee.rules.teams import Fleet, RecordedTeam, squared_distance
from teamformer.record.referee.rules.verdict import Notes

Split = tuple[tuple[int, ...], tuple[int, ...]]
Join = tuple[int, int]


class _Forming(NamedTuple):
    """The splits and joins of a step by the plan."""

    splits: set[Split]
    joins: set[Join]  # of teams in one place
    walks: set[Join]  # to a partner elsewhere


def check_forming(
    fleet: Fleet,
    lists: PlannedTasks,
    tasks: Tasks,
    goals: Mapping[int, Place],
    step: Step,
    number: int,
    notes: Notes,
) -> None:
    """Check, before teams form in a step, that those part and join that the plan wants to.

    Writes down which teams may walk to a partner. `goals` says where the tasks are believed to be.
    """
    if not lists.decide:
        return
    lists.give_tasks(fleet, tasks, number - 1)
    wanted = _due_forming(fleet, lists.next_tasks(fleet, tasks, number - 1), lists, goals)
    for stay, leave in sorted(wanted.splits ^ set(step.splits)):
        parts = f"{list_robots(fleet, stay)} stay and {list_robots(fleet, leave)} leave"
        notes.note(_otherwise(parts, (stay, leave) in wanted.splits))
    joiners = {joiner for joiner, _ in wanted.walks}
    for slot, team in fleet.teams.items():
        team.may_seek = slot in joiners
    on_the_way = set[Join]() if fleet.mission.forming_steps else wanted.walks
    for joiner, partner in sorted(wanted.joins ^ (set(step.joins) - on_the_way)):
        one, other = (fleet.mission.robots[slot].name for slot in (joiner, partner))
        how = f"the team of robot {one} joins that of robot {other}"
        notes.note(_otherwise(how, (joiner, partner) in wanted.joins))


def _otherwise(what: str, is_due: bool) -> str:
    if is_due:
        return f"by the plan {what}, and the record does not say so"
    return f"the record says that {what}, and the plan does not"


def _due_forming(
    fleet: Fleet,
    next_of: Mapping[int, int | None],
    lists: PlannedTasks,
    goals: Mapping[int, Place],
) -> _Forming:
    free = {slot: team for slot, team in sorted(fleet.teams.items()) if not team.services}
    parting = {
        slot for slot, team in free.items() if len({next_of[robot] for robot in team.robots}) > 1
    }
    found = (_due_split(fleet, free[slot], next_of, lists) for slot in parting)
    splits = {split for split in found if split is not None}
    formed = {min(part) for split in splits for part in split}
    joins, walks = set[Join](), set[Join]()
    for joiner, wanted in _who_joins(fleet, free, parting, goals).items():
        partner = _partner_of(fleet, free, joiner, wanted)
        if partner is None or {joiner, partner} & formed:
            continue
        if fleet.is_at(free[joiner], free[partner].at):
            joins.add((joiner, partner))
            formed |= {joiner, partner}
        else:
            walks.add((joiner, partner))
    return _Forming(splits, joins, walks)


def _due_split(
    fleet: Fleet, team: RecordedTeam, next_of: Mapping[int, int | None], lists: PlannedTasks
) -> Split | None:
    """Return how a team parts whose robots have different next tasks; None if it cannot.

    In the plan's order those of one task stay or all others, if they are the first that fit.
    """
    robots = sorted(team.robots)
    ways = lists.in_order(task for robot in robots if (task := next_of[robot]) is not None)
    meant = (
        tuple(robot for robot in robots if (next_of[robot] == way) != leaves)
        for way in ways
        for leaves in (False, True)
    )
    fitting = (part for part in meant if first_that_fit(fleet, robots, part) == part)
    part = next(fitting, (robots[0],))
    stay = first_that_fit(fleet, robots, part)
    is_all = covers(total(fleet.mission.robots[robot].can for robot in part), team.counts)
    if is_all or not stay:
        return None
    return stay, tuple(robot for robot in robots if robot not in stay)


def _who_joins(
    fleet: Fleet,
    free: Mapping[int, RecordedTeam],
    parting: set[int],
    goals: Mapping[int, Place],
) -> dict[int, dict[str, float]]:
    """Return the teams that join the next one that waits at their task, by the counts they want."""
    wanted: dict[int, dict[str, float]] = {}
    waiting: dict[int, int] = {}
    for slot, team in free.items():
        if slot in parting or team.due is None or not fleet.is_at(team, goals[team.due]):
            continue
        joiner = waiting.setdefault(team.due, slot)
        if joiner != slot and _is_in_reach(fleet, free[joiner], team):
            del waiting[team.due]
            wanted[joiner] = total((free[joiner].counts, team.counts))
    return wanted


def _partner_of(
    fleet: Fleet, free: Mapping[int, RecordedTeam], joiner: int, wanted: Mapping[str, float]
) -> int | None:
    """Return the team that brings just what is wanted more: one with the same next task first.

    Then comes the nearest, one with the same assignment, the lowest slot.
    """
    team = free[joiner]
    if covers(team.counts, wanted):
        return None
    ranks = {
        slot: (other.due != team.due, squared_distance(team.at, other.at),
               team.task is None or other.task != team.task, slot)
        for slot, other in free.items()
        if slot != joiner
        and _is_in_reach(fleet, team, other)
        and _are_equal(total((team.counts, other.counts)), wanted)
    }  # fmt: skip
    return min(ranks, key=lambda slot: ranks[slot], default=None)


def _are_equal(one: Mapping[str, float], other: Mapping[str, float]) -> bool:
    return covers(one, other) and covers(other, one)


def _is_in_reach(fleet: Fleet, one: RecordedTeam, other: RecordedTeam) -> bool:
    return squared_distance(one.at, other.at) <= fleet.reach**2
