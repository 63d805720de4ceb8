"""Which teams a snapshot of a fleet shows, and how they came of those of the snapshot before."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from teamformer.mission.parts.grid import Place
from teamformer.record.snapshots.deeds import Deed

Teams = dict[int, tuple[int, ...]]
"""The robots of each team, by its lowest."""


def teams_shown(
    said: Mapping[int, tuple[int, Place]], done: Sequence[Deed], taking: Sequence[Deed] = ()
) -> tuple[dict[int, Place], Teams, set[int]]:
    """Return places by robot, teams, and the slots of teams that have just done something.

    `said` has each robot's team by its word, and its place; `taking` are the loads taken up. Who
    has done several tasks in a step is where it did the last.
    """
    did = {robot: deed for deed in (*taking, *done) for robot in deed.robots if robot in said}
    groups: dict[tuple[int, int, Place], list[int]] = {}
    places = {}
    for robot, (team, place) in sorted(said.items()):
        deed = did.get(robot)
        places[robot] = place if deed is None else deed.at
        key = (-1, team, place) if deed is None else (deed.task, 0, deed.at)
        groups.setdefault(key, []).append(robot)
    teams = {robots[0]: tuple(robots) for robots in groups.values()}
    return places, teams, {slot for slot in teams if did.get(slot) in done}


def doers_goals(doers: Iterable[int], taken: Mapping[int, int]) -> dict[int, int | None]:
    """Return what teams are shown to head for: those that have just done something for nothing.

    Who has taken up a load heads for that; `taken` has the team by the load.
    """
    nothing: dict[int, int | None] = dict.fromkeys(doers)
    return nothing | {slot: load for load, slot in taken.items()}


def who_did(deed: Deed, teams: Teams) -> int:
    """Return the team to show as the one that did a task: that with most of those who did it."""
    return max(
        sorted(teams),
        key=lambda slot: len(set(teams[slot]) & set(deed.robots)),
        default=0,
    )


def team_changes(
    before: Teams, after: Teams, lost: Sequence[int]
) -> tuple[
    tuple[tuple[tuple[int, ...], tuple[int, ...]], ...],
    tuple[tuple[int, int], ...],
]:
    """Return the splits, then the joins, that make one set of teams of another.

    Robots that are lost then, which comes after both in a step, part from the others before.
    """
    splits, pieces = [], []
    after = after | {robot: (robot,) for robot in lost}
    for robots in before.values():
        parts = [tuple(r for r in robots if r in team) for team in after.values()]
        parts = sorted(part for part in parts if part)
        pieces += parts
        rest = robots
        for part in parts[:-1]:
            rest = tuple(robot for robot in rest if robot not in part)
            splits.append((part, rest))
    joins = []
    for slot, team in sorted(after.items()):
        joins += [(min(piece), slot) for piece in sorted(pieces) if slot < min(piece) in team]
    return tuple(splits), tuple(joins)
