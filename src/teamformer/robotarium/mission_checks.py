"""What a mission must be so that it can be flown: size, distances, robots that have room."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

import numpy as np

from teamformer.base.errors import MissionError, Problem
from teamformer.mission.checks.loads import rules_without_loads
from teamformer.mission.checks.rules import rules_of_robotarium
from teamformer.mission.model import Mission, Task
from teamformer.mission.parts.capabilities import describe
from teamformer.mission.parts.plane import Plane
from teamformer.robotarium.control.ring_slots import FROM_WALLS, SPACING, ring_radius
from teamformer.robotarium.robots.arena import HEIGHT, MIDDLE, MOST_ROBOTS, TICK, WIDTH

LEAST_APART = 0.25  # metres between the centres of two robots at the start
SHORTEST_STEP = 10 * TICK  # seconds: decisions take their time


def check_mission(mission: Mission) -> None:
    """Raise `MissionError` with everything that keeps a mission from being flown."""
    problems = list(find_problems(mission))
    if problems:
        raise MissionError(problems)


def find_problems(mission: Mission) -> Iterator[Problem]:
    """Return what is wrong, with the distance needed."""
    yield from rules_of_robotarium(mission)
    yield from rules_without_loads(mission, "the Robotarium")
    world = mission.world
    if not isinstance(world, Plane) or (world.width, world.height) != (WIDTH, HEIGHT):
        size = f"plane: [{WIDTH:g}, {HEIGHT:g}], step: 0.99"
        yield Problem(("world",), f"Robotarium's arena is a plane; use world: {{{size}}}")
        return
    if world.step < SHORTEST_STEP:
        message = f"the step is {world.step:g} s; robots need {SHORTEST_STEP:g} s or more"
        yield Problem(("world",), message)
    if len(mission.robots) > MOST_ROBOTS:
        message = f"there are {len(mission.robots)} robots; Robotarium has {MOST_ROBOTS}"
        yield Problem(("robots",), message)
    fractions = list(_problems_of_fractions(mission))
    yield from fractions
    if fractions:
        return
    yield from _problems_of_starts(mission)
    for number, task in enumerate(mission.tasks):
        yield from _problems_of_walls(number, task)
    yield from _problems_between_tasks(mission)
    if any(robot.absences for robot in mission.robots):
        yield Problem(("robots",), "a robot is to be lost, which missions do not stage; drop it")
    if mission.teams:
        yield Problem(("teams",), "robots start alone here, in places of their own; drop teams")


def _problems_of_fractions(mission: Mission) -> Iterator[Problem]:
    """Return what is needed in fractions: how many robots that is, nobody can say."""
    for number, task in enumerate(mission.tasks):
        if not all(float(count).is_integer() for count in task.needs.values()):
            yield Problem(
                ("tasks", number, "needs"),
                f"task '{task.name}' needs {describe(task.needs)}; robots stand in a ring around "
                "it, one for each count, so use whole numbers",
            )
    for number, robot in enumerate(mission.robots):
        if not all(float(count).is_integer() for count in robot.can.values()):
            yield Problem(
                ("robots", number, "can"),
                f"robot '{robot.name}' can {describe(robot.can)}; use whole numbers here",
            )


def _problems_of_starts(mission: Mission) -> Iterator[Problem]:
    for number, robot in enumerate(mission.robots):
        room = _room(robot.at)
        if room < FROM_WALLS:
            yield Problem(
                ("robots", number, "at"),
                f"robot '{robot.name}' starts {room:.3f} m from a wall; it needs {FROM_WALLS:g} m",
            )
    for (first, one), (second, other) in combinations(enumerate(mission.robots), 2):
        apart = float(np.hypot(one.at[0] - other.at[0], one.at[1] - other.at[1]))
        if apart < LEAST_APART - 1e-9:
            yield Problem(
                ("robots", max(first, second), "at"),
                f"robots '{one.name}' and '{other.name}' start {apart:.3f} m apart; "
                f"they need {LEAST_APART:g} m",
            )


def robots_needed(task: Task) -> int:
    """Return how many robots a task needs if each brings one thing."""
    return int(sum(task.needs.values()))


def _problems_of_walls(number: int, task: Task) -> Iterator[Problem]:
    robots = robots_needed(task)
    needed = min(ring_radius(robots) + FROM_WALLS, min(WIDTH, HEIGHT) / 2)
    room = _room(task.at)
    if room < needed - 1e-9:
        yield Problem(
            ("tasks", number, "at"),
            f"task '{task.name}' is {room:.3f} m from a wall; "
            f"a ring of {robots} {_robots(robots)} around it needs {needed:.3f} m",
        )


def _problems_between_tasks(mission: Mission) -> Iterator[Problem]:
    for (_, one), (number, other) in combinations(enumerate(mission.tasks), 2):
        apart = float(np.hypot(one.at[0] - other.at[0], one.at[1] - other.at[1]))
        needed = apart_needed(robots_needed(one), robots_needed(other))
        if apart < needed - 1e-9:
            yield Problem(
                ("tasks", number, "at"),
                f"tasks '{one.name}' and '{other.name}' are {apart:.3f} m apart; "
                f"the rings of robots around them need {needed:.3f} m",
            )


def apart_needed(robots: int, others: int) -> float:
    """Return how far two tasks must be from each other, in metres, for the robots they need."""
    return ring_radius(robots) + ring_radius(others) + SPACING


def _room(place: tuple[float, float]) -> float:
    """Return how far a place is from the nearest wall, in metres."""
    return float((MIDDLE - np.abs(np.array(place) - MIDDLE)).min())


def _robots(count: int) -> str:
    return "robot" if count == 1 else "robots"
