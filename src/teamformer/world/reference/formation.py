"""Phases 1 to 3: what teams' decisions mean, and the splits and joins that follow."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping

from teamformer.world.reference.state import PlainTeam, PlainWorld, Robots, Units, Wish
from teamformer.world.reference.ways import apart_squared

Joins = dict[int, int]
"""The slot that the team of a slot wants to join."""


def read_decisions(
    world: PlainWorld, wishes: Mapping[int, Wish]
) -> tuple[dict[int, Robots], Joins]:
    """Phase 1: return which robots stay where teams split, and who joins whom.

    Who has no wish maintains. What is illegal counts as maintain, and is counted.
    """
    stays: dict[int, Robots] = {}
    joins: Joins = {}
    by_counts: dict[Units, list[int]] = defaultdict(list)
    for slot, team in world.teams.items():
        team.has_formed, team.is_commanded, team.named = False, False, None
        by_counts[team.has].append(slot)
    for slot, wish in wishes.items():
        team = world.teams[slot]
        if wish.task in world.open:
            team.is_commanded, team.named = True, wish.task
        is_legal = wish.task is None or team.is_commanded
        want = team.has if wish.counts is None else wish.counts
        if want != team.has:
            robots, partner = None, None
            is_less = all(w <= h for w, h in zip(want, team.has, strict=True))
            is_more = all(w >= h for w, h in zip(want, team.has, strict=True))
            if is_less and not team.serving:
                robots = who_stays(world, team.robots, want)
            elif is_more and may_join(world, team):
                partner = _find_partner(world, slot, want, by_counts, wish.task is None)
            if robots:
                stays[slot] = robots
            elif partner is not None:
                joins[slot] = partner
            else:
                is_legal = False
        world.illegal += not is_legal
    world.partners = joins
    return stays, joins


def who_stays(world: PlainWorld, robots: Robots, want: Units) -> Robots:
    """Return who stays where so much is wanted: robots in order, while they fit into it."""
    staying: list[int] = []
    room = want
    for robot in robots:
        left = tuple(r - b for r, b in zip(room, world.brings[robot], strict=True))
        if min(left, default=0) >= 0:
            staying.append(robot)
            room = left
    return tuple(staying)


def may_join(world: PlainWorld, team: PlainTeam) -> bool:
    """Say whether a team serves and charges nothing, and all its robots are in their shifts."""
    is_free = not team.serving and team.charger is None
    return is_free and world.is_at_work(team.robots)


def _find_partner(
    world: PlainWorld,
    slot: int,
    want: Units,
    by_counts: Mapping[Units, list[int]],
    prefers_mates: bool,
) -> int | None:
    """Return the nearest team within the join radius that has exactly what is wanted more.

    Ties: the same assignment first, then the lower slot. By a plan, one that has the same task next
    comes before all others, unless the decision names a task.
    """
    team, found = world.teams[slot], []
    more = tuple(w - h for w, h in zip(want, team.has, strict=True))
    mine = next_task(world, team) if prefers_mates and world.is_coordinated else None
    for other_slot in by_counts.get(more, ()):
        other = world.teams[other_slot]
        away = apart_squared(team.at, other.at)
        if other_slot == slot or not may_join(world, other) or away > world.join_radius**2:
            continue
        shares = team.task is not None and team.task == other.task
        is_mate = mine is not None and mine == next_task(world, other)
        found.append((not is_mate, away, not shares, other_slot))
    return min(found)[-1] if found else None


def next_task(world: PlainWorld, team: PlainTeam) -> int | None:
    """Return the task that a team has next by a plan: the earliest of its robots'."""
    mine = {task for robot in team.robots if (task := world.next[robot]) is not None}
    if len(mine) < 2:
        return next(iter(mine), None)
    return min(mine, key=world.rank)


def split_teams(world: PlainWorld, stays: Mapping[int, Robots]) -> None:
    """Phase 2: those who stay and the others become two teams in the same place, both free."""
    for slot, stay in sorted(stays.items()):
        old = world.teams.pop(slot)
        leave = tuple(robot for robot in old.robots if robot not in stay)
        for robots in (stay, leave):
            team = world.found_team(robots, old.at)
            team.has_formed, team.is_commanded = True, old.is_commanded
        world.teams[stay[0]].named = old.named  # who leaves waits for a decision of its own
        world.splits += 1
        world.happened.splits.append((stay, leave))


def join_teams(world: PlainWorld, joins: Joins) -> Joins:
    """Phase 3: make the joins of teams in one place, in slot order; return who walks to whom.

    A team takes part in one formation a step. A join whose partner has formed becomes maintain.
    """
    walks: Joins = {}
    formed = {slot for slot, team in world.teams.items() if team.has_formed}
    for slot, partner in sorted(joins.items()):
        if not {slot, partner} & formed:
            if world.is_same(world.teams[slot].at, world.teams[partner].at):
                formed |= {slot, partner}
                unite(world, slot, partner)
            else:
                walks[slot] = partner
    return {slot: partner for slot, partner in walks.items() if slot not in formed}


def unite(world: PlainWorld, joiner: int, partner: int) -> None:
    """Make one team of two; it has the joiner's command if there is one.

    It has the earlier assignment, or none if one of the two is free or on a detour. It stands where
    the partner stands, or where the joiner does if that is nearer to the assignment.
    """
    one, other = world.teams.pop(joiner), world.teams.pop(partner)
    lower = one if joiner < partner else other
    at, task = other.at, None
    is_any_free = one.is_detour or other.is_detour
    if one.task is not None and other.task is not None and not is_any_free:
        task = min(one.task, other.task, key=world.rank)
        goal = world.at[task]
        at = min(other.at, one.at, key=lambda place: apart_squared(place, goal))
    team = world.found_team((*one.robots, *other.robots), at)
    team.task, team.has_formed, team.pursued = task, True, lower.pursued
    commanding = one if one.is_commanded else other
    team.is_commanded, team.named = commanding.is_commanded, commanding.named
    world.joins += 1
    world.happened.joins.append((joiner, partner))
