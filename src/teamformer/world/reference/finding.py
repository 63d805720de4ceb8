"""Tasks whose place nobody knows: what teams see is ruled out, until one is near the task."""

from __future__ import annotations

from collections.abc import Sequence

from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.plane import Plane
from teamformer.world.reference.state import PlainTeam, PlainWorld
from teamformer.world.reference.ways import ROUNDING, apart_squared, cells, micrometres

CHOICES = 8
"""How many of the nearest places are compared with a view to what may come."""

MOST_PLACES = 100
"""In a wider region robots look in the nearest place next."""


def find_tasks(world: PlainWorld) -> None:
    """Rule out what teams are near to; what is found or ruled out is believed elsewhere."""
    farthest = (world.finding_radius + ROUNDING) ** 2
    for task in sorted(world.maybe.keys() & world.open):
        places = [team.at for team in world.teams.values()]
        before, believed, true = world.maybe[task], world.at[task], world.truth.tasks[task].at
        left = [p for p in before if all(apart_squared(at, p) > farthest for at in places)]
        world.maybe[task] = left
        if true not in left:
            del world.maybe[task]
            world.happened.found.append(task)
            world.happened.is_elsewhere |= believed != true
            _believe(world, task, true)
        elif left != before:
            _look_on(world, task, left)


def _look_on(world: PlainWorld, task: int, left: list[Place]) -> None:
    """Believe in the next place to look in, where the one believed in is ruled out or not best."""
    believed = world.at[task]
    teams = world.in_slot_order()
    _, seeker = min(teams, key=lambda one: (micrometres(one[1].at, believed), one[0]))
    if world.foresight == "scouting" and len(left) <= MOST_PLACES:
        _believe(world, task, _soonest(world, seeker.at, left, task))
    elif believed not in left:
        _believe(world, task, min(left, key=lambda place: _way(world, seeker, place)))


def _believe(world: PlainWorld, task: int, place: Place) -> None:
    if place != world.at[task]:
        world.put_task(task, place)
        world.happened.moved[task] = place


def _way(world: PlainWorld, seeker: PlainTeam, place: Place) -> int:
    return world.ways.length(place, seeker.at, seeker.flies)


def _soonest(world: PlainWorld, seeker: Place, left: list[Place], task: int) -> Place:
    """Return where to look next so that the task is reached soonest on average.

    All is counted in whole cells or units from the place that was believed in first.
    """
    plane = world.world if isinstance(world.world, Plane) else None
    unit = plane.unit if plane else 1
    origin = world.first_places[task]
    start, *places = (
        (round((x - origin[0]) / unit), round((y - origin[1]) / unit)) for x, y in (seeker, *left)
    )
    radius = (world.finding_radius + ROUNDING) / unit
    nearest = sorted(places, key=lambda place: cells(place, start))[:CHOICES]
    best = min(nearest, key=lambda first: _steps_if_first(start, first, places, radius))
    return left[places.index(best)]


def _steps_if_first(start: Place, first: Place, places: Sequence[Place], radius: float) -> int:
    """Return the steps to the task, summed over where it may be, for who looks there first.

    Then it looks in the nearest place that it has not seen, as if nothing were in the way.
    """
    (x, y), goal, unseen, total, steps = start, first, places, 0, 0
    while unseen:
        if goal not in unseen:
            goal = min(unseen, key=lambda place: cells(place, (x, y)))
        if abs(goal[0] - x) >= abs(goal[1] - y):
            x += 1 if goal[0] > x else -1
        else:
            y += 1 if goal[1] > y else -1
        steps += 1
        seen = {place for place in unseen if apart_squared(place, (x, y)) <= radius * radius}
        total += sum(steps + cells(place, (x, y)) for place in seen)
        unseen = [place for place in unseen if place not in seen]
    return total
