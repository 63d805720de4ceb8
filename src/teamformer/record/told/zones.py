"""What is said of a task that waits for room in a zone, in steps and in continuous time."""

from __future__ import annotations

from collections.abc import Sequence

from teamformer.base.naming import listed
from teamformer.mission.model import Mission
from teamformer.mission.parts.zones import AtWork, ZoneRoom


def held_in(mission: Mission, room: ZoneRoom, work: AtWork, before: Sequence[int]) -> str:
    """Return what a task waits for in a zone that has no room for it, or its load there.

    `work` is what goes on anywhere, `before` what is to begin before it, in the plan's order.
    """
    names, zone = [task.name for task in mission.tasks], mission.zones[room.zone].name
    inside = room.inside(work)
    if len(inside) >= room.room:
        verb = "go" if len(inside) > 1 else "goes"
        return f"it waits for room in {zone}, where {listed([names[k] for k in inside])} {verb} on"
    if brought := [load for load in work.queue if load in room.loads]:
        return f"it waits until {names[brought[0]]} is unloaded in {zone}"
    first = next(task for task in before if task in room.tasks)
    return f"the plan has {names[first]} enter {zone} before it"
