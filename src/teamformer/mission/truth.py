"""What an uncertain mission really holds, and what is believed of it: ordinary missions, both.

The truth is drawn from a trial's seed. Nobody sees it before it shows: how long a task takes when
its service ends, what it needs when a robot stands there, where it is when one senses it, a
breakdown when it happens.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from teamformer.mission.arrivals import draw_arrivals
from teamformer.mission.checks.rules import LEAST_CHANCE
from teamformer.mission.keys.kinds import LARGEST_NUMBER
from teamformer.mission.model import Absence, Breakdown, Mission, Robot, Task, as_believed
from teamformer.mission.parts.capabilities import Counts, total
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.places import believed_place, possible_places
from teamformer.mission.parts.zones import zones_by_name

MOST_BREAKDOWNS = 1000
"""Of a robot in a trial; after so many it holds out."""

OF_TASKS, OF_ROBOTS, OF_DELAYS, OF_ARRIVALS = 1, 2, 3, 4
"""What a generator is for: every task and robot has its own, so that more of them change nothing
about the others."""


def draw_truth(mission: Mission, seed: int) -> Mission:
    """Return the mission as it really is: the same one where nothing about it is uncertain."""
    if not mission.has_surprises:
        return mission
    tasks = (
        *(
            _true_task(task, mission, np.random.default_rng([OF_TASKS, seed, number]))
            for number, task in enumerate(mission.tasks)
        ),
        *draw_arrivals(mission, np.random.default_rng([OF_ARRIVALS, seed])),
    )
    robots = tuple(
        _true_robot(robot, mission, seed, number) for number, robot in enumerate(mission.robots)
    )
    # without checks: linked tasks may need more than all robots have, or one longer than any shift
    return as_believed(mission, arrivals=None, tasks=tasks, robots=robots)


def _true_robot(robot: Robot, mission: Mission, seed: int, number: int) -> Robot:
    rng, other = (np.random.default_rng([what, seed, number]) for what in (OF_ROBOTS, OF_DELAYS))
    if robot.breaks is not None:
        robot = replace(robot, breaks=None, absences=draw_absences(robot.breaks, mission, rng))
    if robot.delays is not None and robot.delays.seed is None:
        seed_of_delays = int(other.integers(LARGEST_NUMBER))
        robot = replace(robot, delays=replace(robot.delays, seed=seed_of_delays))
    return robot


def _true_task(task: Task, mission: Mission, rng: np.random.Generator) -> Task:
    duration, world = task.duration, mission.world
    if task.lasts is not None:
        duration = draw_between(task.lasts, mission, rng)
    more = {cap: 1 for cap, probability in task.may_need.items() if rng.random() < probability}
    needs = total([task.needs, more]) if task.may_need else task.needs
    at = task.at
    if task.within:
        places = possible_places(world, task.at, task.within)
        at = places[rng.integers(len(places))]
    return task.once_known(at, needs, duration)


def draw_absences(
    breaks: Breakdown, mission: Mission, rng: np.random.Generator, sound_from: float = 0
) -> tuple[Absence, ...]:
    """Return when a robot that is sound from a time on breaks down and is back.

    As long as a mission may last. In steps breakdowns come with a probability in each step, in
    continuous time at any time, by their rate.
    """
    absences: list[Absence] = []
    is_whole = mission.time == "steps"
    while breaks.rate > 0 and len(absences) < MOST_BREAKDOWNS:
        wait = rng.geometric(breaks.rate) if is_whole else rng.exponential(1 / breaks.rate)
        lost = sound_from + (int(wait) if is_whole else float(wait))
        if lost > mission.step_limit:
            break
        if breaks.repair is None:
            return (*absences, Absence(lost, None))
        sound_from = lost + draw_between(breaks.repair, mission, rng)
        absences.append(Absence(lost, sound_from))
    return tuple(absences)


def draw_between(ends: tuple[float, float], mission: Mission, rng: np.random.Generator) -> float:
    """Return a length of time between two, both included: in steps a whole number."""
    least, most = ends
    if mission.time == "steps":
        return int(rng.integers(int(least), int(most), endpoint=True))
    return float(rng.uniform(least, most))


def truth_until(mission: Mission, truth: Mission, steps: float) -> Mission:
    """Return a truth without the breakdowns that come after so many steps."""
    robots = (
        replace(real, absences=tuple(away for away in real.absences if away.lost <= steps))
        if robot.breaks is not None
        else real
        for robot, real in zip(mission.robots, truth.robots, strict=True)
    )
    return as_believed(truth, robots=tuple(robots))


def believed_mission(
    mission: Mission,
    needs: Mapping[int, Counts],
    places: Mapping[int, Place] | None = None,
    lies: Mapping[int, Place] | None = None,
) -> Mission:
    """Return an uncertain mission as an ordinary one: with the needs that are believed, by task.

    `places` says where tasks are believed to be; left out, it is where they are before anybody has
    looked; `lies` where loads were set down. Durations and speeds are what to expect; nobody breaks
    down, and no more tasks appear.
    """
    if not mission.has_surprises and not places:
        return mission
    places = places or {}
    tasks = (
        task.once_known(
            places[number] if number in places else believed_place(mission.world, task),
            needs.get(number, task.needs),
            task.duration,
        )
        for number, task in enumerate(mission.tasks)
    )
    robots = tuple(robot.as_expected for robot in mission.robots)
    zones = zones_by_name(mission, lies)  # which a task does not leave that is elsewhere
    return as_believed(mission, arrivals=None, tasks=tuple(tasks), robots=robots, zones=zones)


def expected_mission(mission: Mission) -> Mission:
    """Return an uncertain mission as it is believed before it begins; see `expected_needs`."""
    needs = (expected_needs(task, "scouting") for task in mission.tasks)
    return believed_mission(mission, dict(enumerate(needs)))


def expected_needs(task: Task, foresight: str) -> Counts:
    """Return what a task is believed to need before somebody stands there.

    By `foresight` that is what it needs for sure (`absent`), with all that it may need (`needed`)
    or with what is likely to be needed (`scouting`).
    """
    least = LEAST_CHANCE[foresight]
    more = {cap: 1 for cap, chance in task.may_need.items() if chance > 0 and chance >= least}
    return total([task.needs, more])
