"""Where tasks are believed to be, and whether the record finds them when teams are near."""

from __future__ import annotations

import math
from collections.abc import Iterator

from teamformer.grid import Grid, Place
from teamformer.model import Scenario, Task, World
from teamformer.plane import Plane
from teamformer.referee.completion import Tasks
from teamformer.referee.headway import Ways
from teamformer.referee.teams import Fleet
from teamformer.referee.verdict import Notes
from teamformer.sim.replay.record import Step

ROUNDING = 1e-9


def can_be_at(scenario: Scenario, task: Task, place: Place) -> bool:
    """Say whether a task may really be in a place."""
    return place in places_of(scenario.world, task)


def places_of(world: World, task: Task) -> list[Place]:
    """Return where a task may be, the nearest to where the scenario has it first."""
    if not task.within:
        return [task.at]
    cells = _cells(world, task) if isinstance(world, Grid) else _points(world, task)
    near = [place for place in cells if math.dist(place, task.at) <= task.within + ROUNDING]
    near.sort(key=lambda place: (round(math.dist(place, task.at) ** 2, 6), place[1], place[0]))
    return [place for place in near if world.region(place) == world.region(near[0])]


def _cells(grid: Grid, task: Task) -> Iterator[Place]:
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


class Search:
    """Which places are left for each task that is not found, and where it is believed to be."""

    def __init__(self, scenario: Scenario, ways: Ways) -> None:
        world = scenario.world
        here = world.arrival_radius if isinstance(world, Plane) else 0.0
        self._radius = max(scenario.finding_radius, here)
        self._ways = ways
        self._left = {
            number: places_of(world, task)
            for number, task in enumerate(scenario.tasks)
            if task.within
        }
        for number, places in self._left.items():
            ways.goals[number] = places[0]
        self.moved_after: set[int] = set()

    def go_on(self, fleet: Fleet, tasks: Tasks, step: Step, number: int, notes: Notes) -> bool:
        """Rule out what teams are near to, say where the record differs; is one elsewhere?"""
        found: set[int] = set()
        moved: set[tuple[int, float, float]] = set()
        for task in sorted(self._left):
            if tasks.is_open(task, number - 1):
                self._look_for(fleet, task, tasks.scenario.tasks[task].at, found, moved)
        is_elsewhere = any(task in found for task, _, _ in moved)
        if is_elsewhere:
            self.moved_after.add(number)
        self._compare(found, moved, step, tasks.scenario, notes)
        return is_elsewhere

    def _look_for(
        self,
        fleet: Fleet,
        task: int,
        true: Place,
        found: set[int],
        moved: set[tuple[int, float, float]],
    ) -> None:
        teams = [team.at for _, team in sorted(fleet.teams.items())]
        left = [
            place
            for place in self._left[task]
            if all(math.dist(at, place) > self._radius + ROUNDING for at in teams)
        ]
        believed, self._left[task] = self._ways.goals[task], left
        if true not in left:
            found.add(task)
            del self._left[task]
            self._ways.goals[task] = true
        elif believed not in left:
            seeker = min(teams, key=lambda at: round(math.dist(at, believed) * 1e6))
            self._ways.goals[task] = min(
                left, key=lambda place: round(self._ways.between(place, seeker), 6)
            )
        if self._ways.goals[task] != believed:
            moved.add((task, *self._ways.goals[task]))

    def _compare(
        self,
        found: set[int],
        moved: set[tuple[int, float, float]],
        step: Step,
        truth: Scenario,
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
