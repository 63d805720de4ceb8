"""A mission in continuous time played ahead: its present is forked, under each truth that could be.

Nothing is played again: what has been seen stays as it is, and what is yet open is drawn anew.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from teamformer.live.running.forecasts import IsOver, Played
from teamformer.mission.arrivals import once_appeared
from teamformer.mission.coordination import Plan
from teamformer.mission.keys.kinds import LARGEST_NUMBER
from teamformer.mission.model import Absence, Mission, Robot, Task
from teamformer.mission.truth import draw_absences_by_rate, draw_truth
from teamformer.planning.continuous.longer_search import search_longer
from teamformer.world.continuous.body import SERVING
from teamformer.world.continuous.course import Course
from teamformer.world.continuous.world import PhysicalWorld


@dataclass(frozen=True)
class PastInTime:
    """The present of a mission in continuous time: a course that goes its own way."""

    mission: Mission
    course: Course

    @property
    def tasks(self) -> tuple[int, int]:
        """Return how many tasks there are but for those that are to appear yet, and with these."""
        world = self.course.world
        known = sum(not it.has_arrived or it.appears <= world.now for it in world.mission.tasks)
        return known, len(world.mission.tasks)

    @property
    def is_planned(self) -> bool:
        """Say whether robots go by plans of a coordinator: in continuous time they do."""
        return True

    def play_ahead(self, is_over: IsOver) -> Played:
        """Play to the end, or until nobody wants to know any more."""
        course = self.course.fork()
        while course.is_running and not is_over():
            course.go_on()
        world = course.world
        ends = ends_of(world)
        return Played(
            course.status, world.now, [ends.get(k) for k in range(len(world.truth.tasks))]
        )

    def future(self, seed: int) -> PastInTime:
        """Return the present under a truth that is drawn."""
        truth = possible_truth(self.mission, self.course.world, seed)
        return PastInTime(self.mission, self.course.under(self.mission, truth))

    def with_plan(self, plan: Plan) -> PastInTime:
        """Return the same if a plan were taken over now."""
        course = self.course.fork()
        course.take_over(plan)
        return replace(self, course=course)

    def search_plan(self, seconds: float, seed: int, is_over: IsOver) -> Plan:
        """Search for a better plan from the present on, as `central` does."""
        return search_longer(self.course.known(), self.course.rest(), seconds, seed, is_over)


def ends_of(world: PhysicalWorld) -> dict[int, float]:
    """Return when each task was done that was, by number."""
    return {task: world.events[world.over[task]].at for task in sorted(world.done)}


def possible_truth(mission: Mission, world: PhysicalWorld, seed: int) -> Mission:
    """Draw a truth that could be behind what has been seen in a world so far."""
    rng, drawn = np.random.default_rng(seed), draw_truth(mission, seed)
    own = len(mission.tasks)
    tasks = [
        _possible_task(task, other, number, world, rng)
        for number, (task, other) in enumerate(zip(mission.tasks, drawn.tasks, strict=False))
    ]
    now = once_appeared(mission, world.truth, world.now)
    arrived = world.truth.tasks[own : len(now.tasks)]
    later = draw_truth(now, seed).tasks[len(now.tasks) :]
    robots = (
        _possible_robot(mission, robot, real, world.now, rng)
        for robot, real in zip(mission.robots, world.truth.robots, strict=True)
    )
    return replace(drawn, tasks=(*tasks, *arrived, *later), robots=tuple(robots))


def _possible_task(
    task: Task, drawn: Task, number: int, world: PhysicalWorld, rng: np.random.Generator
) -> Task:
    """Return a task as it could be.

    Where it is once it is found, else in one of the places left; what it needs once that is known;
    how long it takes once it is done, or its load taken up.
    """
    real, work = world.truth.tasks[number], world.works.get(number)
    needs = drawn.needs if number in world.unseen else real.needs
    duration = drawn.duration
    if number in world.over or (work is not None and work.part > SERVING):
        duration = real.duration
    elif task.lasts is not None and work is not None and work.part == SERVING:
        duration = _lasts_on(task.lasts, world.now - work.begun, rng)
    at, left = real.at, world.maybe.get(number, ())
    if left:
        at = left[int(rng.integers(len(left)))]
    return task.once_known(at, needs, duration)


def _lasts_on(lasts: tuple[float, float], so_far: float, rng: np.random.Generator) -> float:
    """Return how long a service lasts that has lasted so long and is not done."""
    least, most = lasts
    return float(rng.uniform(max(least, so_far), max(most, so_far)))


def _possible_robot(
    mission: Mission, robot: Robot, real: Robot, now: float, rng: np.random.Generator
) -> Robot:
    """Return a robot as it could be: lost and back when it was, and later when nobody knows.

    Nor does anybody know when it will stand still.
    """
    if robot.delays is not None and robot.delays.seed is None:
        seed = int(rng.integers(LARGEST_NUMBER))
        real = replace(real, delays=replace(robot.delays, seed=seed))
    if robot.breaks is None:
        return real
    been = [away for away in real.absences if away.lost <= now]
    if been and been[-1].back is None:
        return replace(real, absences=tuple(been))
    sound_from = now
    if been and robot.breaks.repair is not None and (been[-1].back or 0.0) > now:
        lost = been[-1].lost
        sound_from = lost + _lasts_on(robot.breaks.repair, now - lost, rng)
        been[-1] = Absence(lost, sound_from)
    later = draw_absences_by_rate(robot.breaks, mission.step_limit, rng, sound_from)
    return replace(real, absences=(*been, *later))
