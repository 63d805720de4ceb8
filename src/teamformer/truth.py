"""What an uncertain mission really holds, and what is believed of it: ordinary missions, both.

The truth is drawn from a trial's seed. Nobody sees it before it shows: how long a task takes when
its service ends, what it needs when a robot stands there, where it is when one senses it, a
breakdown when it happens.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from teamformer.grid import Place
from teamformer.mission.checks import LARGEST_NUMBER
from teamformer.mission.places import believed_place, possible_places
from teamformer.model import Absence, Robot, Scenario, Task, World

OF_TASKS, OF_ROBOTS = 1, 2
"""What a generator is for: every task and robot has its own, so that more of them change nothing
about the others."""


def draw_truth(scenario: Scenario, seed: int) -> Scenario:
    """Return the mission as it really is: the same one where nothing about it is uncertain."""
    if not scenario.has_surprises:
        return scenario
    return replace(
        scenario,
        tasks=tuple(
            _true_task(task, scenario.world, np.random.default_rng([OF_TASKS, seed, number]))
            for number, task in enumerate(scenario.tasks)
        ),
        robots=tuple(
            draw_truth_of_robot(robot, np.random.default_rng([OF_ROBOTS, seed, number]))
            for number, robot in enumerate(scenario.robots)
        ),
    )


def _true_task(task: Task, world: World, rng: np.random.Generator) -> Task:
    duration = task.duration
    if task.lasts is not None:
        duration = int(rng.integers(task.lasts[0], task.lasts[1] + 1))
    needs = dict(task.needs)
    for cap, probability in task.may_need.items():
        if rng.random() < probability:
            needs[cap] = needs.get(cap, 0) + 1
    at = task.at
    if task.within:
        places = possible_places(world, task.at, task.within)
        at = places[rng.integers(len(places))]
    return task.once_known(at, needs, duration)


def draw_truth_of_robot(robot: Robot, rng: np.random.Generator) -> Robot:
    """Return when a robot really breaks down and is back."""
    breaks = robot.breaks
    if breaks is None:
        return robot
    sound = replace(robot, breaks=None)
    lost = int(rng.geometric(breaks.rate)) if breaks.rate > 0 else LARGEST_NUMBER
    if lost >= LARGEST_NUMBER // 2:
        return sound
    if breaks.repair is None:
        return replace(sound, absences=(Absence(lost),))
    back = lost + int(rng.integers(*breaks.repair, endpoint=True))
    return replace(sound, absences=(Absence(lost, back),))


def believed_mission(
    scenario: Scenario,
    needs: Mapping[int, Mapping[str, int]],
    places: Mapping[int, Place] | None = None,
) -> Scenario:
    """Return an uncertain mission as an ordinary one: with the needs that are believed, by task.

    `places` says where tasks are believed to be; left out, it is where they are before anybody has
    looked. Durations are what to expect; nobody breaks down.
    """
    if not scenario.has_surprises:
        return scenario
    places = places or {}
    tasks = (
        task.once_known(
            places[number] if number in places else believed_place(scenario.world, task),
            needs.get(number, task.needs),
            task.duration,
        )
        for number, task in enumerate(scenario.tasks)
    )
    robots = (replace(robot, breaks=None) for robot in scenario.robots)
    return replace(scenario, tasks=tuple(tasks), robots=tuple(robots))


def expected_mission(scenario: Scenario) -> Scenario:
    """Return an uncertain mission as it is believed before it begins."""
    needs = (expected_needs(task, scenario.foresight) for task in scenario.tasks)
    return believed_mission(scenario, dict(enumerate(needs)))


def expected_needs(task: Task, foresight: str) -> Mapping[str, int]:
    """Return what a task is believed to need before somebody stands there."""
    return task.needs if foresight == "absent" else task.worst_needs
