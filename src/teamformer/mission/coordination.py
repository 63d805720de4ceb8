"""The seam to coordinators: what everybody knows of a mission, and the plan that follows."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

from teamformer.mission.model import Mission
from teamformer.mission.parts.capabilities import covers
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.reach import totals_by_region
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

TAKEN_OVER = "taken over"
"""The reason of a plan that the coordinator did not make, but an operator of a live mission."""

UNFORESEEN = NEWS[:-1]
"""All news except that a task is done, which plans foresee."""


@dataclass(frozen=True)
class Known:
    """What everybody knows of a mission at a moment. Robots and tasks are given by number.

    `mission` is the mission as it is believed to be: uncertain needs and places have their believed
    values, and the `after` of a task names only tasks that are not over. Places are in cells or
    metres, times in steps.
    """

    mission: Mission
    step: int  # the steps made so far
    open_tasks: tuple[int, ...]  # known, not done and not being served
    places: tuple[Place, ...]  # where each robot is once it is free; no meaning for lost robots
    teams: tuple[tuple[int, ...], ...]  # who is with whom; a robot in no team is lost
    free_at: tuple[int, ...]  # when each robot is free: `step`, or the end of its service
    under_way: tuple[tuple[int, int], ...] = ()  # tasks being served, and their expected ends
    unseen_needs: frozenset[int] = frozenset()  # tasks whose needs are not all known
    unseen_places: frozenset[int] = frozenset()  # tasks whose place is not known
    news: tuple[str, ...] = ("start",)  # what has happened since the latest plan, out of `NEWS`

    @cached_property
    def robots(self) -> tuple[int, ...]:
        """Return the numbers of the robots that are not lost, ascending."""
        return tuple(sorted(robot for team in self.teams for robot in team))

    @cached_property
    def possible_tasks(self) -> tuple[int, ...]:
        """Return the open tasks that the present robots can do; others wait for a lost robot.

        A task is not possible either if it comes after such a task, or after one that has not
        appeared.
        """
        world, tasks = self.mission.world, self.mission.tasks
        have = totals_by_region(world, (self.mission.robots[robot] for robot in self.robots))
        under_way = {task for task, _ in self.under_way}
        able = {
            k for k in self.open_tasks if covers(have[world.region(tasks[k].at)], tasks[k].needs)
        }
        before = {task: set(others) for task, others in tasks_before(tasks).items()}
        while waiting := {task for task in able & before.keys() if before[task] - able - under_way}:
            able -= waiting
        return tuple(k for k in self.open_tasks if k in able)


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
    ends: tuple[int, ...] = ()  # the step in which each is done if nothing happens, or empty
    scouts: tuple[tuple[int, int], ...] = ()  # pairs of a robot and the task it looks at first
    why: tuple[str, ...] = ()  # the news after which the plan was made, or `TAKEN_OVER`
    made_from: str = ""  # what the search began with: crews, coalitions, arcs, old plan; or kept

    @property
    def makespan(self) -> int:
        """Return the step in which the last task is done if nothing happens."""
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
