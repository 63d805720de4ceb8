"""The seam to coordinators: what everybody knows of a mission, and the plan that follows."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Protocol

from teamformer.mission.checks.links import groups_of, linked_with
from teamformer.mission.keys.mission_keys import TIMES
from teamformer.mission.model import Mission, Robot
from teamformer.mission.parts.capabilities import Counts, covers, total
from teamformer.mission.parts.charging import who_is_able
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.reach import totals_there
from teamformer.mission.parts.roads import Roads
from teamformer.mission.precedence import tasks_before

NEWS = (
    "start",
    "task appeared",
    "robot lost",
    "service broken off",
    "robot back",
    "needs known",
    "service overdue",
    "task found",
    "task cancelled",
    "task done",
)
"""The kinds of news after which a coordinator may be asked for a plan."""

IDLE = "idle"
"""News in continuous time that nobody need heed: nobody has anything to do, and tasks are open."""

TAKEN_OVER = "taken over"
"""The reason of a plan that the coordinator did not make, but an operator of a live mission."""

UNFORESEEN = NEWS[:-1]
"""All news except that a task is done, which plans foresee."""


@dataclass(frozen=True)
class Known:
    """What everybody knows of a mission at a moment. Robots and tasks are given by number.

    `mission` is the mission as it is believed to be: uncertain needs and places have their believed
    values, and the `after` of a task names only tasks that are not over. Places are in cells or
    metres, times in steps; in continuous time in the mission's unit, counted from its start.
    There a robot on its way is free at the next place on it, every robot is a team of its own, and
    the fields from `came_from` on are filled in.
    """

    mission: Mission
    now: float  # the steps made so far, or the time
    open_tasks: tuple[int, ...]  # known, not done and not being served
    places: tuple[Place, ...]  # where each robot is once it is free; no meaning for lost robots
    teams: tuple[tuple[int, ...], ...]  # who is with whom; a robot in no team is lost
    free_at: tuple[float, ...]  # when each robot is free: `now`, or the end of its service
    under_way: tuple[tuple[int, float], ...] = ()  # tasks being served, and their expected ends
    unseen_needs: frozenset[int] = frozenset()  # tasks whose needs are not all known
    unseen_places: frozenset[int] = frozenset()  # tasks whose place is not known
    news: tuple[str, ...] = ("start",)  # what has happened since the latest plan, out of `NEWS`
    came_from: tuple[Place, ...] = ()  # where each robot last did something: who forms with whom
    started: Mapping[int, float] = field(default_factory=dict)  # tasks that have begun, and when
    over: frozenset[int] = frozenset()  # tasks that are done or called off
    left: tuple[float, ...] = ()  # what each has in its battery once it is free
    charging: tuple[tuple[int, float], ...] = ()  # chargers where robots charge, and until when
    loading: Mapping[int, float] = field(default_factory=dict)  # loads taken up, and until when
    unloading: frozenset[int] = frozenset()  # loads where they are brought to, or put off there

    @property
    def step(self) -> int:
        """Return how many steps, or whole units of time, have passed."""
        return int(self.now)

    @cached_property
    def robots(self) -> tuple[int, ...]:
        """Return the numbers of the robots that are not lost, ascending."""
        return tuple(sorted(robot for team in self.teams for robot in team))

    @cached_property
    def possible_tasks(self) -> tuple[int, ...]:
        """Return the open tasks that the present robots can do; others wait for a lost robot.

        A task is not possible either if it comes after such a task, or after one that has not
        appeared. Tasks whose starts are linked are possible together or not at all: those that are
        linked directly take different robots.
        """
        tasks = self.mission.tasks
        under_way = {task for task, _ in self.under_way}
        able = {k for k in self.open_tasks if covers(self._brought_to(k), tasks[k].needs)}
        before = {task: set(others) for task, others in tasks_before(tasks).items()}
        able -= self._lacking_for_links(able)
        while waiting := {task for task in able & before.keys() if before[task] - able - under_way}:
            able -= waiting
            able -= self._lacking_for_links(able)
        return tuple(k for k in self.open_tasks if k in able)

    def _brought_to(self, task: int) -> Counts:
        """Return what the robots that are there can bring to a task together."""
        able = who_is_able(self.mission, self.robots, task)
        if len(able) == len(self.robots):
            return self._brought(self.mission.tasks[task].at)
        robots = [self._stands(robot) for robot in able]
        return totals_there(self.mission.world, robots)(self.mission.tasks[task].at)

    @cached_property
    def _brought(self) -> Callable[[Place], Counts]:
        return totals_there(self.mission.world, [self._stands(robot) for robot in self.robots])

    def _stands(self, robot: int) -> Robot:
        """Return a robot as one that starts where it is now; on roads not all ways lead back."""
        there = self.mission.robots[robot]
        is_road = isinstance(self.mission.world, Roads)
        return replace(there, at=self.places[robot]) if is_road else there

    def _lacking_for_links(self, able: set[int]) -> set[int]:
        """Return tasks that the present robots can do, but not with all that they are linked with.

        Those that have begun, and those that are over, are waited for no more.
        """
        tasks = self.mission.tasks
        if not any(task.starts for task in tasks):
            return set()
        begun, lacking, linked = self.over | self.started.keys(), set[int](), linked_with(tasks)
        can = [self.mission.robots[robot].can for robot in self.robots]
        for group in groups_of(tasks):
            left = [task for task in group if task not in begun]
            pairs = ((a, b) for a in left for b in linked[a] if b in left)
            needs = [total([tasks[a].needs, tasks[b].needs]) for a, b in pairs]
            is_short = not all(covers(total(can), need) for need in needs)
            if not able.issuperset(left) or is_short:
                lacking |= able.intersection(left)
        return lacking


def known_at_start(mission: Mission) -> Known:
    """Return what is known before anything has happened; tasks that will appear count as known."""
    places = tuple(robot.at for robot in mission.robots)
    return Known(
        mission=mission,
        now=0,
        open_tasks=tuple(range(len(mission.tasks))),
        places=places,
        teams=mission.starting_teams,
        free_at=(0,) * len(places),
        came_from=places,
        left=tuple(
            math.inf if robot.battery is None else robot.battery.starts * robot.battery.lasts
            for robot in mission.robots
        ),
    )


@dataclass(frozen=True)
class Plan:
    """Which robots do which task together, and in what order.

    A robot's next task is the first task in `order` that is not done and has the robot in its
    coalition. The robots of a coalition go to their task, wait for one another and join. Robots of
    one team that have different next tasks part. A task that comes after others is moved behind
    them in `order`, so that nobody waits for what waits for them.
    """

    order: tuple[int, ...] = ()  # open tasks
    coalitions: tuple[tuple[int, ...], ...] = ()  # the robots of each, in the same order
    ends: tuple[float, ...] = ()  # when each is done if nothing happens, or empty
    scouts: tuple[tuple[int, int], ...] = ()  # pairs of a robot and the task it looks at first
    why: tuple[str, ...] = ()  # the news after which the plan was made, or `TAKEN_OVER`
    made_from: str = ""  # what the search began with: crews, coalitions, arcs, old plan; or kept

    @property
    def makespan(self) -> float:
        """Return when the last task is done if nothing happens."""
        return max(self.ends, default=0)


class Coordinator(Protocol):
    """Decides which robots do which task together, and when that changes.

    It is asked for a plan at the start and after every news that is in its attribute `heeds`. A
    coordinator without this attribute is asked after all news except that a task is done
    (`UNFORESEEN`). One coordinator may serve many missions at once, so it must not store anything
    about a mission between calls. Each call gets the old plan instead.
    """

    def update(self, known: Known, plan: Plan | None) -> Plan:
        """Return the plan from now on, or `plan` itself if nothing should change.

        `plan` is what is left of the latest plan, None at the start. Every coalition of the new
        plan must be able to do its task. An open task that is left out, or has an empty coalition,
        waits for a later plan.
        """
        ...


def heeded_by(coordinator: Coordinator) -> tuple[str, ...]:
    """Return the news after which a coordinator is asked."""
    heeds: tuple[str, ...] = getattr(coordinator, "heeds", UNFORESEEN)
    return heeds


def times_of(coordinator: Coordinator) -> tuple[str, ...]:
    """Return of which times missions are that a coordinator can plan: of all, if it does not say.

    One whose plans count in steps says so in its attribute `times`.
    """
    times: tuple[str, ...] = getattr(coordinator, "times", TIMES)
    return times
