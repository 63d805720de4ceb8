"""Where tasks are believed to be, and whether the record finds them when teams are near."""

from __future__ import annotations

import math
from collections.abc import Iterator, Set

from teamformer.mission.model import Mission, Task, World
from teamformer.mission.parts.grid import Grid, Place
from teamformer.mission.parts.plane import Plane
from teamformer.record.record import Step
from teamformer.record.referee.rules.completion import Tasks
from teamformer.record.referee.rules.headway import ShortestWays
from teamformer.record.referee.rules.teams import Fleet
from teamformer.record.referee.rules.verdict import Notes

ROUNDING = 1e-9

CHOICES, MOST_PLACES = 8, 100
"""With a view to what may come the nearest places are compared, if there are not too many."""


def can_be_at(mission: Mission, task: Task, place: Place) -> bool:
    """Say whether a task may really be in a place."""
    return place in places_of(mission.world, task)


def places_of(world: World, task: Task) -> list[Place]:
    """Return where a task may be, the nearest to where the mission has it first."""
    if not task.within:
        return [task.at]
    assert isinstance(world, Grid | Plane)
    cells = _cells(world) if isinstance(world, Grid) else _points(world, task)
    near = [place for place in cells if math.dist(place, task.at) <= task.within + ROUNDING]
    near.sort(key=lambda place: (round(math.dist(place, task.at) ** 2, 6), place[1], place[0]))
    return [place for place in near if world.region(place) == world.region(near[0])]


def _cells(grid: Grid) -> Iterator[Place]:
    for y in range(grid.height):
        for x in range(grid.width):
            if grid.is_free((x, y)):
                yield x, y


def _points(plane: Plane, task: Task) -> Iterator[Place]:
    """Return the points of a plane that are whole numbers of units from a task's place."""
    most = math.ceil(task.within / plane.unit)
    for i in range(-most, most + 1):
        for j in range(-most, most + 1):
            point = (round(task.at[0] + i * plane.unit, 6), round(task.at[1] + j * plane.unit, 6))
            if plane.is_free(point):
                yield point


def _apart(one: tuple[int, int], other: tuple[int, int]) -> int:
    return abs(one[0] - other[0]) + abs(one[1] - other[1])


def _one_nearer(at: tuple[int, int], goal: tuple[int, int]) -> tuple[int, int]:
    """Return the next cell on the way to a goal, along the axis with more left to go."""
    (x, y), (goal_x, goal_y) = at, goal
    if abs(goal_x - x) >= abs(goal_y - y):
        return (x + 1 if goal_x > x else x - 1), y
    return x, (y + 1 if goal_y > y else y - 1)


class PlaceSearch:
    """Which places are left for each task that is not found, and where it is believed to be."""

    def __init__(self, mission: Mission, ways: ShortestWays, foresight: str) -> None:
        world = mission.world
        here = world.arrival_radius if isinstance(world, Plane) else 0.0
        self._radius = max(mission.finding_radius, here)
        self._unit = world.unit if isinstance(world, Plane) else 1
        self._plans_looks = foresight == "scouting"
        self._ways = ways
        self._left = {
            number: places_of(world, task)
            for number, task in enumerate(mission.tasks)
            if task.within
        }
        self._first = {number: places[0] for number, places in self._left.items()}
        ways.goals.update(self._first)
        self.news_after: set[int] = set()
        self._found_after: dict[int, int] = {}

    def is_found(self, task: int, steps_made: int) -> bool:
        """Say whether everybody knows after so many steps where a task is."""
        is_hidden = task in self._first
        return not is_hidden or self._found_after.get(task, steps_made + 1) <= steps_made

    def go_on(
        self,
        fleet: Fleet,
        tasks: Tasks,
        looked_at: Set[int],
        step: Step,
        number: int,
        notes: Notes,
    ) -> bool:
        """Rule out what teams are near to, say where the record differs; is a task elsewhere?

        That is news, and so is a task that is found where somebody has `looked_at` it.
        """
        found: set[int] = set()
        moved: set[tuple[int, float, float]] = set()
        for task in sorted(self._left):
            if tasks.is_open(task, number - 1):
                self._look_for(fleet, task, tasks.mission.tasks[task].at, found, moved)
        is_elsewhere = any(task in found for task, _, _ in moved)
        if is_elsewhere or not found.isdisjoint(looked_at):
            self.news_after.add(number)
        self._found_after |= dict.fromkeys(found, number)
        self._compare(found, moved, step, tasks.mission, notes)
        return is_elsewhere

    def _look_for(
        self,
        fleet: Fleet,
        task: int,
        true: Place,
        found: set[int],
        moved: set[tuple[int, float, float]],
    ) -> None:
        fliers = [(team.at, team.flies) for _, team in sorted(fleet.teams.items())]
        teams = [at for at, _ in fliers]
        left = [
            place
            for place in self._left[task]
            if all(math.dist(at, place) > self._radius + ROUNDING for at in teams)
        ]
        believed, any_ruled_out = self._ways.goals[task], len(left) < len(self._left[task])
        self._left[task] = left
        if true not in left:
            found.add(task)
            del self._left[task]
            self._ways.goals[task] = true
        elif any_ruled_out:
            seeker, flies = min(fliers, key=lambda one: round(math.dist(one[0], believed) * 1e6))
            if self._plans_looks and len(left) <= MOST_PLACES:
                self._ways.goals[task] = self._soonest(seeker, self._first[task], left)
            elif believed not in left:
                self._ways.goals[task] = min(
                    left, key=lambda place: round(self._ways.between(place, seeker, flies), 6)
                )
        if self._ways.goals[task] != believed:
            moved.add((task, *self._ways.goals[task]))

    def _soonest(self, seeker: Place, first: Place, left: list[Place]) -> Place:
        """Return where to look next for the least steps until the task is reached on average."""
        offsets = [self._offset(place, first) for place in left]
        begin = self._offset(seeker, first)
        by_distance = sorted(range(len(left)), key=lambda i: _apart(offsets[i], begin))
        return left[
            min(by_distance[:CHOICES], key=lambda i: self._steps_if_first(begin, offsets, i))
        ]

    def _offset(self, place: Place, first: Place) -> tuple[int, int]:
        """Return a place in whole cells or units from a first one."""
        return (
            round((place[0] - first[0]) / self._unit),
            round((place[1] - first[1]) / self._unit),
        )

    def _steps_if_first(
        self, begin: tuple[int, int], offsets: list[tuple[int, int]], first: int
    ) -> int:
        """Return the steps to the task, summed over where it may be, for who looks there first.

        Then it looks in the nearest place that it has not seen, as if nothing were in the way.
        """
        at, goal, steps, summed = begin, offsets[first], 0, 0
        unseen = dict.fromkeys(offsets)
        while unseen:
            if goal not in unseen:
                goal = min(unseen, key=lambda place: _apart(place, at))
            at, steps = _one_nearer(at, goal), steps + 1
            for place in list(unseen):
                if math.dist(place, at) <= (self._radius + ROUNDING) / self._unit:
                    summed += steps + _apart(place, at)
                    del unseen[place]
        return summed

    def _compare(
        self,
        found: set[int],
        moved: set[tuple[int, float, float]],
        step: Step,
        truth: Mission,
        notes: Notes,
    ) -> None:
        for task in sorted(found ^ set(step.found)):
            name = truth.tasks[task].name
            if task in found:
                notes.note(f"a team is near task {name}, and the record does not find it")
            else:
                notes.note(f"the record finds task {name}, where nobody can know that it is there")
        for task, x, y in sorted(moved ^ set(step.moved)):
            name = truth.tasks[task].name
            if (task, x, y) in moved:
                notes.note(f"the record does not believe task {name} to be at [{x}, {y}]")
            else:
                notes.note(f"the record believes task {name} to be at [{x}, {y}] without reason")
        for said in (step.found, step.moved):
            if len(set(said)) < len(said):
                notes.note("the record finds or moves a task twice")
