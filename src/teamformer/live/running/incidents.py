"""Incidents: what happens to a mission from outside while it runs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

from teamformer.base.errors import MissionError, TeamformerError
from teamformer.live.running.forecasts import Forecast, IsOver, Past, forecast, never
from teamformer.mission.arrivals import once_appeared
from teamformer.mission.checks.optional import has_optional
from teamformer.mission.coordination import Coordinator, Known, Plan
from teamformer.mission.model import Absence, Mission, Robot, Task, World
from teamformer.mission.parts.capabilities import describe
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.roads import Roads

SEARCHES = 4
"""Plans that are searched for, each from other random numbers, and played: the best play counts."""


@dataclass(frozen=True)
class Present:
    """A mission as it stands when something happens to it; times as missions have them.

    What appears now does so at `now`. Whatever else happens is felt `next`: in steps with the next
    step, in continuous time at once.
    """

    now: float
    next: float
    truth: Mission
    ends: Mapping[int, float]  # of the tasks that are done
    is_planned: bool  # robots go by plans of a coordinator

    def told(self, when: float) -> str:
        """Return a moment as words."""
        return f"in step {when:g}" if self.truth.time == "steps" else f"at {when:g}"


class _Told:
    """Something that happens.

    In steps, records have it `steps_later` steps after the latest step. If all is planned as well
    as can be, a mission ends no sooner by what `can_only_delay` it, and no later by what
    `can_only_hasten` it.
    """

    steps_later: ClassVar[int] = 0
    can_only_delay: ClassVar[bool] = False
    can_only_hasten: ClassVar[bool] = False


@dataclass(frozen=True)
class NewTask(_Told):
    """A task that everybody learns of now."""

    can_only_delay: ClassVar[bool] = True

    task: Task

    def apply(self, mission: Mission, now: Present) -> Mission:
        """Return the mission in which this has happened."""
        return _checked(mission, tasks=(*mission.tasks, replace(self.task, appears=now.now)))

    def text(self, mission: Mission) -> str:
        """Return the incident as words."""
        place = place_text(mission.world, self.task.at)
        return f"task {self.task.name} at {place} that needs {describe(self.task.needs)}"


@dataclass(frozen=True)
class LostRobot(_Told):
    """A robot that counts for nothing from the next step on."""

    steps_later: ClassVar[int] = 1
    can_only_delay: ClassVar[bool] = True

    robot: str

    def apply(self, mission: Mission, now: Present) -> Mission:
        """Return the mission in which the robot is lost in the next step."""
        number = _number_of(mission.robots, self.robot, "robot")
        been = _absences_so_far(now, number)
        last = been[-1] if been else None
        if last is not None and (last.back is None or last.back > now.next):
            when = now.told(last.lost)
            raise TeamformerError(f"robot '{self.robot}' was lost {when} already")
        if last is not None and last.back == now.next:  # it is not back after all
            return _with_absences(mission, number, (*been[:-1], Absence(last.lost)))
        return _with_absences(mission, number, (*been, Absence(now.next)))

    def text(self, mission: Mission) -> str:
        """Return the incident as words."""
        return f"robot {self.robot} lost"


@dataclass(frozen=True)
class RobotBack(_Told):
    """A lost robot that is there again from the next step on, where it was lost."""

    steps_later: ClassVar[int] = 1
    can_only_hasten: ClassVar[bool] = True

    robot: str

    def apply(self, mission: Mission, now: Present) -> Mission:
        """Return the mission in which the robot is back in the next step."""
        number = _number_of(mission.robots, self.robot, "robot")
        been = _absences_so_far(now, number)
        if not been:
            raise TeamformerError(f"robot '{self.robot}' is not lost")
        back = been[-1].back
        if back is not None and back <= now.now:
            raise TeamformerError(f"robot '{self.robot}' came back {now.told(back)} already")
        later = mission.robots[number].absences[len(been) :]
        again = (*been[:-1], replace(been[-1], back=now.next), *later)
        return _with_absences(mission, number, again)

    def text(self, mission: Mission) -> str:
        """Return the incident as words."""
        return f"robot {self.robot} back"


@dataclass(frozen=True)
class CancelledTask(_Told):
    """A task that nobody is to do any more, from the next step on."""

    steps_later: ClassVar[int] = 1
    can_only_hasten: ClassVar[bool] = True

    task: str

    def apply(self, mission: Mission, now: Present) -> Mission:
        """Return the mission in which the task is called off in the next step."""
        number = _number_of_undone(mission, self.task, now)
        task = mission.tasks[number]
        if task.cancelled is not None and task.cancelled <= now.next:
            raise TeamformerError(f"task '{self.task}' was called off already")
        return _with_task(mission, number, replace(task, cancelled=now.next))

    def text(self, mission: Mission) -> str:
        """Return the incident as words."""
        return f"task {self.task} called off"


@dataclass(frozen=True)
class NewWeight(_Told):
    """Another weight of a task; `plan` is what follows, which `planned` makes."""

    task: str
    weight: float
    plan: Plan | None = None

    def apply(self, mission: Mission, now: Present) -> Mission:
        """Return the mission in which the task has always had this weight."""
        number = _number_of_undone(mission, self.task, now)
        if mission.cost is None and not has_optional(mission):
            what = "this mission has no cost and no optional tasks, so weights change nothing"
            raise TeamformerError(what)
        if not now.is_planned:
            raise TeamformerError(
                "with this method robots follow no plan that a weight could change"
            )
        return self._weighed(mission, number)

    def planned(self, known: Known, plan: Plan | None, coordinator: Coordinator) -> NewWeight:
        """Return the same with what a coordinator makes of the plan in force because of it."""
        number = _number_of(known.mission.tasks, self.task, "task")
        mission = self._weighed(known.mission, number)
        asked = replace(known, news=("task appeared",), mission=mission)
        return replace(self, plan=coordinator.update(asked, plan))

    def text(self, mission: Mission) -> str:
        """Return the incident as words."""
        return f"task {self.task} has the weight {self.weight:g}"

    def _weighed(self, mission: Mission, number: int) -> Mission:
        return _with_task(mission, number, replace(mission.tasks[number], weight=self.weight))


Incident = NewTask | CancelledTask | LostRobot | RobotBack | NewWeight


@dataclass(frozen=True)
class PlanTakenOver(_Told):
    """A plan that was searched for longer, and by which the robots go from now on."""

    plan: Plan
    forecast: Forecast
    without: Forecast  # how the mission was to end before

    def apply(self, mission: Mission, now: Present) -> Mission:
        """Return the mission as it is: it holds no plans."""
        return mission

    def text(self, mission: Mission) -> str:
        """Return what happened as words."""
        unit = " steps" if mission.time == "steps" else ""
        found, before = (it.text(unit) for it in (self.forecast, self.without))
        return f"plan of central taken over: {found}; before: {before}"


Happening = Incident | PlanTakenOver


def place_text(world: World, place: Place) -> str:
    """Return a place as words: the name of one on roads."""
    if isinstance(world, Roads):
        return world.places[int(place[0])]
    return f"[{place[0]}, {place[1]}]"


def plan_of(happening: Happening) -> Plan | None:
    """Return the plan by which the robots go from now on, if it brings one."""
    return happening.plan if isinstance(happening, NewWeight | PlanTakenOver) else None


def mission_after(
    happening: Happening, source: Mission, now: Present, planner: str | None = None
) -> Mission:
    """Return the mission if something happened to it; TeamformerError says why it cannot.

    What has appeared at random until now is known then, as tasks of the mission, which stand before
    one that an operator adds. `planner` names the method if it was told everything beforehand.
    """
    if planner is not None:
        raise TeamformerError(
            f"'{planner}' plans with all that the mission says, so that nothing can "
            "happen to it; run it by another method"
        )
    if isinstance(happening, PlanTakenOver):
        return source
    return happening.apply(once_appeared(source, now.truth, now.now), now)


def note_of_plans(happenings: Iterable[Happening]) -> str:
    """Return what there is to know of a mission if plans were brought; empty if none was."""
    if all(plan_of(happening) is None for happening in happenings):
        return ""
    return (
        "a mission holds no plans: those that an operator had made are in the record, and "
        "`run` makes plans of its own, so that its mission may end at another step"
    )


def search_plan(past: Past, seconds: float, is_over: IsOver = never) -> PlanTakenOver:
    """Search for a better plan from the present on, as `central` does; say what it would gain.

    `is_over` says that nobody wants to know any more.
    """
    if not past.is_planned:
        raise TeamformerError(
            "with this method robots follow no plan that could be made anew; "
            "run the mission with the method 'plan'"
        )
    searches = 1 if past.mission.has_surprises else SEARCHES
    plans = [
        past.search_plan(seconds / searches, seed, is_over)
        for seed in range(searches)
        if seed == 0 or not is_over()
    ]
    ends = [forecast(past.with_plan(plan), is_over) for plan in plans]
    found = [
        PlanTakenOver(plan, end, Forecast(0, ())) for plan, end in zip(plans, ends, strict=True)
    ]
    best = min(found, key=lambda it: it.forecast.rank)
    return replace(best, without=forecast(past, is_over))


def _absences_so_far(now: Present, robot: int) -> list[Absence]:
    return [away for away in now.truth.robots[robot].absences if away.lost <= now.now]


def _number_of(those: Sequence[Robot | Task], name: str, what: str) -> int:
    number = next((number for number, it in enumerate(those) if it.name == name), None)
    if number is None:
        raise TeamformerError(f"there is no {what} '{name}'")
    return number


def _number_of_undone(mission: Mission, name: str, now: Present) -> int:
    number = _number_of(mission.tasks, name, "task")
    ended = now.ends.get(number)
    if ended is not None:
        raise TeamformerError(f"task '{name}' was done {now.told(ended)}")
    return number


def _with_task(mission: Mission, number: int, task: Task) -> Mission:
    """Return the mission with another task in the place of one."""
    tasks = list(mission.tasks)
    tasks[number] = task
    return _checked(mission, tasks=tuple(tasks))


def _with_absences(mission: Mission, number: int, absences: tuple[Absence, ...]) -> Mission:
    """Return the mission with a robot whose absences are sure."""
    robots = list(mission.robots)
    robots[number] = replace(robots[number], absences=absences, breaks=None)
    return _checked(mission, robots=tuple(robots))


def _checked(mission: Mission, **changes: object) -> Mission:
    """Return a changed mission; TeamformerError says why it cannot be."""
    try:
        return replace(mission, **changes)  # type: ignore[arg-type]
    except MissionError as error:
        raise TeamformerError("; ".join(problem.message for problem in error.problems)) from None


def free_name(mission: Mission) -> str:
    """Return a name for a new task that no task of a mission has."""
    names = {task.name for task in mission.tasks}
    number = len(names) + 1
    while f"t{number}" in names:
        number += 1
    return f"t{number}"
