"""A mission in continuous time played ahead: its present is forked, under each truth that could be.

Nothing is played again: what has been seen stays as it is, and what is yet open is drawn anew.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial

from teamformer.live.running.forecasts import IsOver, Played
from teamformer.live.running.possible_truths import Seen, possible_truth
from teamformer.mission.coordination import Plan
from teamformer.mission.model import Mission
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
        truth = self.possible_truth(seed)
        return PastInTime(self.mission, self.course.under(self.mission, truth))

    def possible_truth(self, seed: int) -> Mission:
        """Draw a truth that could be behind what has been seen so far."""
        world = self.course.world
        seen = partial(seen_in, world)
        return possible_truth(self.mission, world.truth, world.now, seen, seed)

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


def seen_in(world: PhysicalWorld, task: int) -> Seen:
    """Return what has been seen of a task in a world so far."""
    work = world.works.get(task)
    is_served = work is not None and work.part == SERVING
    return Seen(
        places=world.maybe.get(task, ()),
        are_needs_known=task not in world.unseen,
        is_duration_known=task in world.over or (work is not None and work.part > SERVING),
        served=world.now - work.begun if work is not None and is_served else None,
    )
