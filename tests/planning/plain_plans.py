"""The relaxed problem in plain Python: a referee, every schedule there is, and tiny worlds."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from itertools import combinations
from typing import NamedTuple

import numpy as np

from teamformer.base.errors import MissionError
from teamformer.mission.model import Absence, Mission, Robot, Task
from teamformer.mission.parts.grid import BLOCKED, FREE, Grid, Place
from teamformer.planning.problem.coalition_plan import CoalitionPlan
from teamformer.planning.problem.relaxed_problem import Relaxed
from teamformer.planning.relaxation.relaxed_plan import empty_timing, start_tasks


class PlainWorld:
    """A mission with its distances, found by walking."""

    def __init__(self, mission: Mission) -> None:
        self.robots, self.tasks = mission.robots, mission.tasks
        self._grid = mission.world
        self._fields: dict[Place, dict[Place, int]] = {}

    def steps(self, robot: Robot, here: Place, there: Place) -> float:
        """Return the steps of a leg."""
        if here not in self._fields:
            self._fields[here] = self._walk(here)
        return math.ceil(self._fields[here].get(there, math.inf) / robot.speed - 1e-9)

    def _walk(self, start: Place) -> dict[Place, int]:
        field, frontier = {start: 0}, [start]
        for place in frontier:
            for beside in self._grid.neighbours(place):
                if beside not in field:
                    field[beside] = field[place] + 1
                    frontier.append(beside)
        return field

    def is_reachable(self, robot: Robot, task: Task) -> bool:
        return self._grid.region(robot.at) == self._grid.region(task.at)

    def crews(self, task: Task) -> Iterator[tuple[int, ...]]:
        """Return all crews that cannot spare anybody."""
        here = [r for r, robot in enumerate(self.robots) if self.is_reachable(robot, task)]
        enough: list[set[int]] = []
        for size in range(1, len(here) + 1):
            for crew in combinations(here, size):
                if self.covers(crew, task) and not any(less <= set(crew) for less in enough):
                    enough.append(set(crew))
                    yield crew

    def covers(self, crew: tuple[int, ...], task: Task) -> bool:
        return all(
            sum(self.robots[r].can.get(cap, 0) for r in crew) >= count
            for cap, count in task.needs.items()
        )


class Stay:
    """Where a robot is: since when, and until when it is busy there."""

    def __init__(self, place: Place, since: int = 0, until: int = 0) -> None:
        self.place, self.since, self.until = place, since, until

    def go(self, world: PlainWorld, robot: Robot, task: Task) -> Stay:
        """Return the stay in which the robot serves a task next, not yet begun."""
        if self.place == task.at:
            return self
        arrives = self.until + int(world.steps(robot, self.place, task.at))
        return Stay(task.at, arrives, arrives)


def fastest_makespan(mission: Mission) -> int | None:
    """Return the least makespan of all orders and crews, None if none is in time."""
    least = least_cost(mission, lambda ends: max(ends.values(), default=0))
    return None if least == math.inf else int(least)


def least_cost(mission: Mission, cost: Callable[[Mapping[int, int]], float]) -> float:
    """Return the least cost of all orders and crews, infinite if none is in time.

    `cost` is of the ends of tasks by number, and does not fall as more tasks end.
    """
    world = PlainWorld(mission)
    crews = [list(world.crews(task)) for task in world.tasks]
    best = math.inf

    def extend(left: frozenset[int], stays: list[Stay], ends: dict[int, int]) -> None:
        nonlocal best
        if cost(ends) >= best:
            return
        if not left:
            best = cost(ends)
        for k in left:
            for crew in crews[k]:
                after = list(stays)
                end = serve(world, world.tasks[k], crew, after)
                if all(end < last_step(world.robots[r]) for r in crew):
                    extend(left - {k}, after, {**ends, k: end})

    extend(frozenset(range(len(world.tasks))), [Stay(r.at) for r in world.robots], {})
    return best


def last_step(robot: Robot) -> float:
    """Return the step that a robot is missing from; who comes back counts as always there."""
    return math.inf if robot.lost_for_good is None else robot.lost_for_good


def serve(world: PlainWorld, task: Task, crew: tuple[int, ...], stays: list[Stay]) -> int:
    """Let a crew serve a task as soon as it can; return the end."""
    going = {r: stays[r].go(world, world.robots[r], task) for r in crew}
    end = max(task.appears + 1, *(stay.since for stay in going.values())) + task.duration
    for r, stay in going.items():
        stays[r] = Stay(stay.place, stay.since, max(stay.until, end))
    return end


class RelaxedSchedule(NamedTuple):
    """A relaxed plan with its times, per task."""

    order: list[int]
    coalitions: list[list[int]]
    start: list[int]
    end: list[int]
    makespan: int


def schedule_of(problem: Relaxed, plan: CoalitionPlan) -> RelaxedSchedule:
    """Return a plan with the times that kernels work out."""
    timing = empty_timing(problem, plan)
    makespan, _, _ = start_tasks(problem, plan, timing)
    rows = zip(plan.coalition.tolist(), plan.size.tolist(), strict=True)
    coalitions = [robots[:size] for robots, size in rows]
    start, end = timing.start.tolist(), timing.end.tolist()
    return RelaxedSchedule(plan.order.tolist(), coalitions, start, end, int(makespan))


def find_faults(mission: Mission, schedule: RelaxedSchedule) -> list[str]:
    """Return everything that is wrong with a schedule."""
    world, faults = PlainWorld(mission), []
    for k, task in enumerate(world.tasks):
        start, end = schedule.start[k], schedule.end[k]
        if not world.covers(schedule.coalitions[k], task):
            faults.append(f"the crew of task {k} is too small")
        if start <= task.appears or end != start + task.duration:
            faults.append(f"task {k} starts at {start} and ends at {end}")
        if any(end >= last_step(world.robots[r]) for r in schedule.coalitions[k]):
            faults.append(f"task {k} has a lost robot")
    if sorted(schedule.order) != list(range(len(world.tasks))):
        faults.append(f"the order is {schedule.order}")
    for r in range(len(world.robots)):
        route = [k for k in schedule.order if r in schedule.coalitions[k]]
        stay = Stay(world.robots[r].at)
        for k in route:
            stay = stay.go(world, world.robots[r], world.tasks[k])
            if schedule.start[k] < stay.since:
                faults.append(f"robot {r} is not yet at task {k}")
            stay = Stay(stay.place, stay.since, max(stay.until, schedule.end[k]))
    if schedule.makespan != max(schedule.end):
        faults.append("the makespan is not the last end")
    return faults


def tiny_world(
    rng: np.random.Generator, speeds: tuple[float, ...] = (1.0, 1.0, 2.0), losses: float = 0.0
) -> Mission:
    """Return a possible world with up to 3 robots and 4 tasks, often two in one place."""
    while True:
        try:
            return _draw(rng, speeds, losses)
        except MissionError:
            continue


def _draw(rng: np.random.Generator, speeds: tuple[float, ...], losses: float) -> Mission:
    side, caps = int(rng.integers(2, 7)), ("a", "b")
    is_blocked = rng.random((side, side)) < rng.choice([0.0, 0.2])
    grid = Grid(side, side, tuple("".join(BLOCKED if b else FREE for b in y) for y in is_blocked))
    places = [(int(x), int(y)) for x, y in rng.integers(0, side, (5, 2))]

    def place() -> Place:
        return places[rng.integers(len(places))]

    def counts(most: int) -> dict[str, int]:
        return {c: int(rng.integers(1, most + 1)) for c in caps if rng.random() < 0.6} or {"a": 1}

    robots = [
        Robot(
            f"r{r}",
            place(),
            counts(2),
            float(rng.choice(speeds)),
            (Absence(int(rng.integers(4, 20))),) if rng.random() < losses else (),
        )
        for r in range(rng.integers(1, 4))
    ]
    tasks = [
        Task(f"t{k}", place(), counts(2), int(rng.choice([0, 0, 1, 4])), int(rng.choice([0, 0, 7])))
        for k in range(rng.integers(1, 5))
    ]
    return Mission("tiny", grid, caps, tuple(robots), tuple(tasks), forming_steps=0)
