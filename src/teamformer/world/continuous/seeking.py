"""What nobody knows before somebody is there: what tasks need, and where they are.

Robots look where they stand and, on their way, where they pass a place that tells something: near
where a task is, or is believed to be. What they see is ruled out; the task is then believed at the
nearest place that is left.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise

from teamformer.mission.model import Mission
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.places import possible_places, sight_of
from teamformer.mission.parts.roads import Roads
from teamformer.world.continuous.body import RealRobot, turning
from teamformer.world.continuous.events import Passed
from teamformer.world.continuous.moving import LOOK, MovingWorld

ROUNDING = 1e-9
"""Of lengths: what is as far away as the radius is seen."""


class SeekingWorld(MovingWorld):
    """What is hidden: `unseen` needs, and by task the places that it `maybe` is at."""

    def __init__(self, mission: Mission, truth: Mission, is_all_known: bool) -> None:
        super().__init__(mission, truth, is_all_known)
        self.unseen = {k for k, task in enumerate(mission.tasks) if task.may_need}
        self.maybe: dict[int, tuple[Place, ...]] = {
            number: possible_places(mission.world, task.at, task.within)
            for number, task in enumerate(mission.tasks)
            if task.within
        }
        self.believed = {task: places[0] for task, places in self.maybe.items()}
        self._radius = mission.finding_radius + ROUNDING

    def place_of(self, task: int) -> Place:
        """Return where a task is believed to be, or its load lies."""
        if task in self.maybe:
            return self.believed[task]
        return super().place_of(task)

    def sense(self, robot: int) -> None:
        """Let it be known what a robot finds where it is: what tasks need, and where they are."""
        body = self.bodies[robot]
        if body.is_lost:
            return
        if self.maybe:
            self.look_around(robot)
            self.plan_looks(robot)
        if self.unseen and not body.is_walking:
            self._learn_needs(robot, body.way[0].place)

    def _learn_needs(self, robot: int, place: Place) -> None:
        for task in sorted(self.unseen & self.appeared - self.over.keys() - self.maybe.keys()):
            if self.place_of(task) == place:
                self.unseen.discard(task)
                needs = self.truth.tasks[task].needs
                cause = self.cause_among([self.bodies[robot].since])
                self.tell("know", (robot,), task, cause, needs=needs)
                self.note("needs known", tasks=(task,))

    def look_around(self, robot: int) -> None:
        """Let a robot rule out the places that it is near to, or find what is there."""
        here = _place_at(self.bodies[robot], self.now, self.is_plane)
        for task in sorted(self.maybe.keys() & self.appeared - self.over.keys()):
            left = tuple(at for at in self.maybe[task] if self._sight(at, here) > self._radius)
            if len(left) == len(self.maybe[task]):
                continue
            cause = self.bodies[robot].since  # the way on which it came near
            real, was = self.truth.tasks[task].at, self.believed[task]
            self.maybe[task] = left
            if real not in left:
                del self.maybe[task], self.believed[task]
                self.tell("found", (robot,), task, cause, place=real)
                self.note("task found" if real != was else "", tasks=(task,))
            elif was not in left:
                self.believed[task] = min(left, key=lambda at: self._way_on(robot, here, at))
                self.tell("moved", (), task, cause, place=self.believed[task])
            if task not in self.maybe or self.believed[task] != was:
                heading = (r for r, body in enumerate(self.bodies) if body.task == task)
                self.note(robots=heading)

    def set_out(self, robot: int, goal: Place | None, task: int, cause: int) -> None:
        """Have a robot go somewhere, and look around where its way tells something."""
        super().set_out(robot, goal, task, cause)
        if self.maybe:
            self.plan_looks(robot)

    def plan_looks(self, robot: int) -> None:
        """Put on the agenda when a robot on its way first sees where tasks are, or may be."""
        body = self.bodies[robot]
        if not body.is_walking or body.is_lost:
            return
        for task in self.maybe:
            for place in {self.truth.tasks[task].at, self.believed[task]}:
                moment = next(self._sights(body.way, place), None)
                if moment is not None:
                    self.put(moment, LOOK, robot, body.set_out)

    def _sight(self, one: Place, other: Place) -> float:
        return sight_of(self.mission.world, one, other)

    def _way_on(self, robot: int, here: Place, place: Place) -> float:
        """Return how far a place is, straight on; on roads how long the way of a robot takes."""
        if isinstance(self.mission.world, Roads):
            return self.ways.length(here, place, self.mission.robots[robot].moves)
        return math.dist(here, place)

    def _sights(self, way: tuple[Passed, ...], place: Place) -> Iterator[float]:
        """Yield when somebody on a way comes near to a place, from now on."""
        for before, after in pairwise(way):
            if self.is_plane:
                moment = _when_near(before, after, place, self._radius)
            else:
                moment = after.at if self._sight(after.place, place) <= self._radius else math.inf
            if self.now < moment < math.inf:
                yield moment


def _place_at(body: RealRobot, now: float, is_plane: bool) -> Place:
    """Return where a robot is: on a grid the cell that it passed last."""
    return turning(body.way, now, is_plane)[0].place


def _when_near(before: Passed, after: Passed, place: Place, radius: float) -> float:
    """Return when one who walks straight on is first within a radius; infinite for never."""
    (x, y), (to_x, to_y) = before.place, after.place
    step_x, step_y, away_x, away_y = to_x - x, to_y - y, x - place[0], y - place[1]
    square, half = step_x**2 + step_y**2, step_x * away_x + step_y * away_y
    rest = away_x**2 + away_y**2 - radius**2
    if rest <= 0:
        return before.at
    inside = half**2 - square * rest
    if square == 0 or inside < 0:
        return math.inf
    part = (-half - math.sqrt(inside)) / square
    return before.at + part * (after.at - before.at) if 0 <= part <= 1 else math.inf
