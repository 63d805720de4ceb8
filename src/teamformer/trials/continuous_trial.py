"""A trial of a mission in continuous time: it runs as the coordinator plans, and all is told."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

from teamformer.base.errors import TeamformerError
from teamformer.base.kernels.clock import compiling_seconds, working_seconds
from teamformer.methods.by_name import Method
from teamformer.methods.central.in_hindsight import InHindsight
from teamformer.methods.central.policy import Central
from teamformer.mission.arrivals import with_arrivals
from teamformer.mission.checks.costs import cost_of, parts_of_ends
from teamformer.mission.checks.windows import latest_end
from teamformer.mission.coordination import Coordinator, Known, Plan, heeded_by, times_of
from teamformer.mission.model import Mission
from teamformer.mission.truth import truth_until
from teamformer.planning.problem.routes import MissionPlan
from teamformer.record.record import Ending, Record
from teamformer.world.continuous.course import COMPLETED, RUNNING, Course
from teamformer.world.env import Tally

INTERRUPTED = "interrupted"

RUN_HERE = "use plan, central, reactive, soonest or a coordinator of your own"
"""What to do instead of what is refused."""


@dataclass(frozen=True)
class ContinuousTrial:
    """A course that has come to its end, or was broken off, and what the clock said of it."""

    course: Course
    method: Method
    coordinator: Coordinator
    planning_seconds: float
    total_seconds: float
    compiling_seconds: float
    is_interrupted: bool

    def record(self, mission: Mission, seed: int, bound: float | None) -> Record:
        """Return the record; that of an uncertain mission has its truth.

        `bound` is a time that no plan is over before; `central` may have proven a higher one.
        """
        proven = self.coordinator.bound if isinstance(self.coordinator, InHindsight) else 0.0
        bound = max(bound or 0.0, proven) or None
        return record_of(self.course, mission, self.method.name, seed, bound)


def run_continuous(
    mission: Mission,
    method: Method,
    truth: Mission,
    on_step: Callable[[Tally], None] | None = None,
    keeps_interrupted: bool = False,
) -> ContinuousTrial:
    """Run one trial; Ctrl-C raises KeyboardInterrupt or, if it `keeps_interrupted`, ends it.

    `on_step` is called after each moment. Raises `TeamformerError` for a method that plays steps.
    """
    begun, compiled, working = time.perf_counter(), compiling_seconds(), working_seconds()
    coordinator = coordinator_of(method, truth)
    planned = working_seconds() - working
    is_told, is_interrupted = method.needs_everything, False
    course = Course(truth if is_told else mission, truth, coordinator, is_told)
    try:
        course.begin()
        while course.is_running:
            course.go_on()
            if on_step is not None:
                on_step(_tally(course))
    except KeyboardInterrupt:
        if not keeps_interrupted:
            raise
        is_interrupted = True
        course.break_off(INTERRUPTED)
    return ContinuousTrial(
        course,
        method,
        coordinator,
        planning_seconds=planned + course.seconds,
        total_seconds=time.perf_counter() - begun,
        compiling_seconds=compiling_seconds() - compiled,
        is_interrupted=is_interrupted,
    )


@dataclass(frozen=True)
class GivenPlan:
    """A coordinator that keeps to the plan that it is given, whatever happens."""

    plan: Plan
    heeds: tuple[str, ...] = ()
    times: tuple[str, ...] = ("continuous",)

    def update(self, known: Known, plan: Plan | None) -> Plan:
        """Return the plan at the start, and later what is left of it."""
        return self.plan if plan is None else plan


def carry_out(mission: Mission, made: MissionPlan, method: str) -> Record:
    """Return the record of a plan of a mission in which nothing is uncertain.

    Tasks that appear later are known from the start, as whoever made the plan knew them.
    """
    ends = {stop.task: stop.end for route in made.routes for stop in route.stops}
    plan = Plan(made.order, made.coalitions, tuple(ends[task] for task in made.order))
    course = Course(mission, mission, GivenPlan(plan), is_told_all=True)
    course.begin()
    while course.is_running:
        course.go_on()
    return record_of(course, mission, method, 0, made.bound or None)


def record_of(
    course: Course, mission: Mission, method: str, seed: int, bound: float | None = None
) -> Record:
    """Return the record of a course; that of an uncertain mission has what has shown of its truth.

    Breakdowns that were yet to come are not part of it.
    """
    truth, now = course.world.truth, course.world.now
    return Record(
        mission=with_arrivals(mission, truth),
        method=method,
        seed=seed,
        end=ending_of(course),
        events=tuple(course.world.events),
        lower_bound=bound,
        truth=truth_until(mission, truth, now) if mission.has_surprises else None,
        heeds=heeded_by(course.coordinator),
    )


def coordinator_of(method: Method, truth: Mission) -> Coordinator:
    """Return who plans a mission in continuous time; `central` plans by what it really is.

    Raises `TeamformerError` for a method that only plays steps.
    """
    if isinstance(method.policy, Central):
        return InHindsight(truth, method.policy)
    if method.coordinator is None:
        what = f"method '{method.name}' decides step by step, which continuous time does not have"
        raise TeamformerError(what, RUN_HERE)
    if "continuous" not in times_of(method.coordinator):
        what = f"method '{method.name}' plans in steps, and the mission is in continuous time"
        raise TeamformerError(what, RUN_HERE)
    return method.coordinator


def ending_of(course: Course) -> Ending:
    """Return how a course has ended; its times are in the mission's unit."""
    world, mission = course.world, course.world.truth
    ends = {task: world.events[world.over[task]].at for task in sorted(world.done)}
    late = {task: end - latest_end(mission.tasks[task].between) for task, end in ends.items()}
    is_completed = course.status == COMPLETED
    cost = None
    if mission.cost is not None and is_completed:
        parts = {"makespan": world.now, "travel": world.travel}
        called_off = world.over.keys() - world.done - set(world.missed)
        cost = cost_of(mission.cost, {**parts, **parts_of_ends(mission.tasks, ends, called_off)})
    return Ending(
        status=course.status,
        makespan=world.now if is_completed else None,
        tasks_done=len(world.done),
        blocked_tasks=tuple(mission.tasks[task].name for task in course.blocked),
        cost=cost,
        late={mission.tasks[task].name: by for task, by in late.items() if by > 0},
        broken_links=tuple(
            (mission.tasks[gap.task].name, mission.tasks[gap.other].name)
            for gap in course.links.broken(world)
        ),
        missed=tuple(mission.tasks[task].name for task in sorted(world.missed)),
    )


def _tally(course: Course) -> Tally:
    """Return how a trial stands, for a display of progress."""
    status = RUNNING if course.is_running else course.status
    return Tally(status, int(course.world.now), len(course.world.done), 0, 0, 0)
