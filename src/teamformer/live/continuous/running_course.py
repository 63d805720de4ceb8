"""A mission in continuous time as it runs, to which things happen.

An incident changes the mission: a task that appears, a task called off, a robot lost or back, just
now. The present is forked under the mission as it is then (`Course.under`), so that what has been
stays as it was, and nothing is planned but what follows from now on. The record is at every moment
what `run` makes of the mission with all its incidents. A plan that an operator has taken over, and
another weight of a task, are the exceptions: the record holds their plans, and `run` makes its own.

A mission that is over goes on if something happens to it: its last moment comes again then, with
that in view.
"""

from __future__ import annotations

import copy
import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

from teamformer.base.errors import TeamformerError
from teamformer.live.continuous.futures import PastInTime, ends_of
from teamformer.live.running.incidents import (
    Happening,
    Incident,
    NewWeight,
    PlanTakenOver,
    Present,
    mission_after,
    plan_of,
)
from teamformer.methods.by_name import Method
from teamformer.methods.coordinators.reordered import Reordered
from teamformer.methods.coordinators.replayed import Replayed
from teamformer.mission.coordination import Coordinator, Plan
from teamformer.mission.model import Mission
from teamformer.mission.truth import draw_truth
from teamformer.planning.continuous.mission_bound import bound_in_time
from teamformer.record.files.events import event_to_tree
from teamformer.record.record import Record
from teamformer.trials.continuous_trial import INTERRUPTED, coordinator_of, record_of
from teamformer.world.continuous.course import Course

BEAT = 0.2
"""Seconds between two moves of the clock."""

USUAL_LENGTH = 60.0
"""Seconds that a mission takes about at its usual speed."""

DIGITS = 9
"""Places after the point of the clock."""

PLACES = 3
"""Places after the point of the moment at which an incident happens, if that is possible."""

SHOWN = frozenset({"know", "done", "lost", "back", "appear", "overdue", "found", "moved"})
"""Kinds of events that tell something of an uncertain mission."""


class _Before(NamedTuple):
    """What undoing an incident brings back."""

    course: Course
    last: Course
    source: Mission


class RunningCourse:
    """One mission in continuous time that runs by one method; see `LiveMission`.

    `plans` were made before, with the times then; they are not made again. `make_method` makes the
    method anew.
    """

    def __init__(
        self,
        mission: Mission,
        make_method: Callable[[], Method],
        seed: int,
        plans: Sequence[tuple[float, Plan]] = (),
    ) -> None:
        method = make_method()
        if method.needs_everything:
            mission = draw_truth(mission, seed)
        self.source, self.seed, self.drawn = mission, seed, mission
        self.incidents: list[tuple[float, Happening]] = []
        self.method_name = method.name
        self._make_method, self._needs_everything = make_method, method.needs_everything
        truth = draw_truth(mission, seed)
        self._own = Replayed(plans, coordinator_of(method, truth))
        course = Course(mission, truth, self._own, method.needs_everything)
        course.begin()
        course.go_until(0.0)
        self._course = course
        self._last = course  # before the moment at which the mission ended, if it has
        self._seen, self._planned = 0, 0  # events and plans before the latest move
        self._before: list[_Before] = []  # by incident
        self._bound: float | None = None

    def anew(self) -> RunningCourse:
        """Return the same mission at its start, to which nothing has happened."""
        return RunningCourse(self.drawn, self._make_method, self.seed)

    @property
    def now(self) -> float:
        """Return the time."""
        return self._course.world.now

    @property
    def status(self) -> str:
        """Return `running`, or how the mission has ended."""
        return self._course.status

    @property
    def is_running(self) -> bool:
        """Say whether time goes on."""
        return self._course.is_running

    @property
    def is_planned(self) -> bool:
        """Say whether robots go by plans of a coordinator: in continuous time they do."""
        return True

    @property
    def has_shown_more(self) -> bool:
        """Say whether the latest move has told something of an uncertain mission."""
        events = self._course.world.events[self._seen :]
        return self.source.has_surprises and any(event.kind in SHOWN for event in events)

    @property
    def truth(self) -> Mission:
        """Return what the mission really is, with all that has happened to it."""
        return self._course.world.truth

    @property
    def latest_plans(self) -> list[tuple[float, Plan]]:
        """Return the plans of the latest move, or of an incident since, and when they were made."""
        return list(self._course.plans[self._planned :])

    @property
    def latest(self) -> dict[str, Any]:
        """Return what time it is, and the events of the latest move."""
        events = self._course.world.events[self._seen :]
        return {"now": self.now, "events": [event_to_tree(event) for event in events]}

    def ends(self) -> dict[int, float]:
        """Return when each task was done that was, by number."""
        return ends_of(self._course.world)

    def usual_speed(self, speed: float) -> float:
        """Return the units of time a second by which the mission takes about a minute."""
        length = max((plan.makespan for _, plan in self._course.plans), default=0.0)
        return nice(length / USUAL_LENGTH) if length else speed

    def beat(self, speed: float) -> tuple[float, float]:
        """Return how many seconds there are between two moves, and how far each goes."""
        return BEAT, BEAT * speed

    def move(self, units: float | None = None) -> None:
        """Let so much time pass; by default until something happens.

        Whoever looks sees the mission as it was until all that is done.
        """
        if units is not None:
            self._move_to(round(self.now + units, DIGITS))
            return
        course, count = self._course, len(self._course.world.events)
        while course.is_running and len(course.world.events) == count:
            course = self._next(course)
        self._put(course)

    def again(self, latest: dict[str, Any]) -> dict[str, Any]:
        """Move as far as is told of an earlier move; return what this one has brought."""
        self._move_to(float(latest["now"]))
        return self.latest

    def _move_to(self, when: float) -> None:
        course = self._course
        while course.is_running and _upcoming(course) <= when:
            course = self._next(course)
        if course is self._course:
            course = course.fork()
        course.go_until(when)
        self._put(course)

    def _next(self, course: Course) -> Course:
        """Return a course after its next moment; as it was before that, it is kept."""
        self._last = course
        after = course.fork()
        after.go_until(_upcoming(after))
        return after

    def happen(self, incident: Happening) -> None:
        """Let something happen now; TeamformerError says why it cannot, and nothing changes."""
        incident, course, mission = self._changed(incident)
        self.incidents.append((course.world.now, incident))
        self._before.append(_Before(self._course, self._last, self.source))
        self.source, self._bound = mission, None
        self._put(course)

    def undo(self) -> Happening:
        """Go back to just before the latest incident, and return it; what was since is undone.

        Raises TeamformerError if nothing has happened.
        """
        if not self.incidents:
            raise TeamformerError("nothing has happened that could be undone")
        _, incident = self.incidents.pop()
        self._course, self._last, self.source = self._before.pop()
        self._bound = None
        self._seen, self._planned = len(self._course.world.events), len(self._course.plans)
        return incident

    def mission_with(self, happening: Happening) -> Mission:
        """Return the mission if something happened now; TeamformerError says why it cannot."""
        return self._mission_at(self._moment(), happening)

    def work_out_bound(self) -> float | None:
        """Return what no plan can beat, as `run` tells it; the record has it then."""
        mission = self.source
        if self._bound is None:
            bound = bound_in_time(draw_truth(mission, self.seed))
            if self.source is not mission:  # an incident has happened meanwhile
                return None
            self._bound = bound or None
        return self._bound

    def record(self) -> Record:
        """Return the record so far; that of a mission that still runs is of an interrupted one."""
        course = self._course.fork()
        course.break_off(INTERRUPTED)
        return record_of(course, self.source, self.method_name, self.seed, self._bound)

    def as_it_stands(self) -> RunningCourse:
        """Return the mission as it is now, to be asked about while it goes on itself."""
        now = copy.copy(self)
        now.incidents = list(self.incidents)
        return now

    def past(self) -> PastInTime:
        """Return the present, to be played ahead while the mission goes on."""
        return PastInTime(self.source, self._course)

    def past_planned_anew(self, order: int) -> PastInTime:
        """Return the present with a plan that is made now, in another order of robots and tasks."""
        course = self._course
        known = course.known(("task appeared",))
        return self.past().with_plan(self._coordinator(order).update(known, course.rest()))

    def past_with(self, incident: Incident, order: int = 0) -> PastInTime:
        """Return the present as it would be if an incident happened now.

        What then follows is planned in an order of robots and tasks.
        """
        _, course, mission = self._changed(incident, order)
        return PastInTime(mission, course)

    def _put(self, course: Course) -> None:
        """Have a course that went on be the mission's."""
        self._seen, self._planned = len(self._course.world.events), len(self._course.plans)
        self._course = course

    def _coordinator(self, order: int = 0) -> Coordinator:
        return Reordered(self._own, order) if order else self._own

    def _moment(self) -> float:
        """Return when an incident happens: now, or just after what has happened now.

        What comes from outside is first of what happens at one moment, so it would come before
        that; a plan that an operator brings comes last. If possible the moment has few places after
        the point.
        """
        world = self._course.world
        latest = max((event.at for event in world.events), default=0.0)
        upcoming = world.next_time if self.is_running else math.inf
        least = 10.0**-PLACES
        rounded = round(math.ceil(self.now / least) * least, PLACES)
        for moment in (rounded, self.now, round(rounded + least, PLACES)):
            if latest < moment < upcoming and moment >= self.now:
                return moment
        return (self.now + min(upcoming, self.now + 2 * least)) / 2

    def _mission_at(self, moment: float, happening: Happening) -> Mission:
        present = Present(moment, moment, self.truth, self.ends(), is_planned=True)
        planner = self.method_name if self._needs_everything else None
        return mission_after(happening, self.source, present, planner)

    def _changed(self, happening: Happening, order: int = 0) -> tuple[Happening, Course, Mission]:
        """Return what happens, with its plan, and the course and the mission after it."""
        brings_plan = isinstance(happening, PlanTakenOver | NewWeight)
        moment = self.now if brings_plan else self._moment()
        mission = self._mission_at(moment, happening)
        present = self._course if self.is_running else self._last
        course = present.under(mission, draw_truth(mission, self.seed))
        course.coordinator = self._coordinator(order)
        course.go_until(moment)
        if not course.is_running and (brings_plan or course.world.now < moment):
            raise TeamformerError("the mission is over, and this changes nothing about it")
        if isinstance(happening, NewWeight) and happening.plan is None:
            happening = happening.planned(course.known(), course.rest(), course.coordinator)
        if (plan := plan_of(happening)) is not None:
            course.take_over(plan)
        return happening, course, mission


def nice(number: float) -> float:
    """Return the largest one of ..., 0.5, 1, 2, 5, 10, ... that is no larger than a number."""
    ten = 10.0 ** math.floor(math.log10(number))
    return max(digit * ten for digit in (1, 2, 5) if digit * ten <= number)


def _upcoming(course: Course) -> float:
    """Return the next time at which something is due, be it the end."""
    return min(course.world.next_time, float(course.mission.step_limit))
