"""Truths that could be behind what has been seen of a mission so far, drawn at random."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from teamformer.mission.arrivals import once_appeared
from teamformer.mission.keys.kinds import LARGEST_NUMBER
from teamformer.mission.model import Absence, Mission, Robot, Task
from teamformer.mission.parts.grid import Place
from teamformer.mission.truth import draw_absences, draw_between, draw_truth


class Seen(NamedTuple):
    """What has been seen of a task.

    It is in one of some `places`; if there are none, everybody knows where it is. Its duration is
    known once it is done, or its load taken up; until then it has been `served` for so long, if it
    is.
    """

    places: Sequence[Place]
    are_needs_known: bool
    is_duration_known: bool
    served: float | None = None


def possible_truth(
    mission: Mission, truth: Mission, now: float, seen: Callable[[int], Seen], seed: int
) -> Mission:
    """Draw a truth that could be behind what has been seen until now of a mission and its truth.

    `seen` tells it of a task of the mission, by number.
    """
    rng, drawn = np.random.default_rng(seed), draw_truth(mission, seed)
    rows = zip(mission.tasks, drawn.tasks, truth.tasks, strict=False)  # the first has no arrivals
    tasks = [
        _possible_task(mission, task, other, real, seen(number), rng)
        for number, (task, other, real) in enumerate(rows)
    ]
    known = once_appeared(mission, truth, now)
    arrived = truth.tasks[len(mission.tasks) : len(known.tasks)]
    later = draw_truth(known, seed).tasks[len(known.tasks) :]
    robots = (
        _possible_robot(mission, robot, real, now, rng)
        for robot, real in zip(mission.robots, truth.robots, strict=True)
    )
    return replace(drawn, tasks=(*tasks, *arrived, *later), robots=tuple(robots))


def _possible_task(
    mission: Mission, task: Task, drawn: Task, real: Task, seen: Seen, rng: np.random.Generator
) -> Task:
    """Return a task as it could be."""
    at = seen.places[int(rng.integers(len(seen.places)))] if seen.places else real.at
    needs = real.needs if seen.are_needs_known else drawn.needs
    duration = real.duration if seen.is_duration_known else drawn.duration
    if task.lasts is not None and seen.served is not None and not seen.is_duration_known:
        duration = _lasts_on(mission, task.lasts, seen.served, rng)
    return task.once_known(at, needs, duration)


def _lasts_on(
    mission: Mission, ends: tuple[float, float], so_far: float, rng: np.random.Generator
) -> float:
    """Return how long something lasts that has lasted so long and is not over."""
    so_far += 1 if mission.time == "steps" else 0
    return draw_between((max(ends[0], so_far), max(ends[1], so_far)), mission, rng)


def _possible_robot(
    mission: Mission, robot: Robot, real: Robot, now: float, rng: np.random.Generator
) -> Robot:
    """Return a robot as it could be: lost and back when it was, and later when nobody knows.

    Nor does anybody know when it will stand still; in steps the past is played again, with it.
    """
    is_open = mission.time == "continuous"
    if is_open and robot.delays is not None and robot.delays.seed is None:
        seed = int(rng.integers(LARGEST_NUMBER))
        real = replace(real, delays=replace(robot.delays, seed=seed))
    if robot.breaks is None:
        return real
    been = [away for away in real.absences if away.lost <= now]
    if been and been[-1].back is None:
        return replace(real, absences=tuple(been))
    sound_from = now
    if been and robot.breaks.repair is not None and (been[-1].back or 0) > now:
        lost = been[-1].lost
        sound_from = lost + _lasts_on(mission, robot.breaks.repair, now - lost, rng)
        been[-1] = Absence(lost, sound_from)
    later = draw_absences(robot.breaks, mission, rng, sound_from)
    return replace(real, absences=(*been, *later))
