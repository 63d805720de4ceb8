"""The seam to coordinators: what everybody knows of a mission, and the plan that follows."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

from teamformer.capabilities import covers
from teamformer.grid import Place
from teamformer.mission.reach import totals_by_region
from teamformer.model import Scenario

NEWS = (
    "start",
    "task appeared",
    "robot lost",
    "service broken off",
    "robot back",
    "needs known",
    "service overdue",
    "task found",
    "task done",
)
"""What may have happened that a coordinator is asked for a plan."""

TAKEN_OVER = "taken over"
"""Why a plan holds that somebody else has made, such as an operator of a live mission."""

UNFORESEEN = NEWS[:-1]
"""All news but that a task is done, which plans foresee."""


@dataclass(frozen=True)
class Known:
    """What everybody knows of a mission at a moment; robots and tasks are numbers.

    `mission` is as it is believed to be: with the needs and places that are believed, and without
    what is still to come. Places are in cells or metres, times are in steps.
    """

    mission: Scenario
    step: int  # steps made
    open_tasks: tuple[int, ...]  # known, not done and not being served
    places: tuple[Place, ...]  # of every robot, once it is free; of lost ones any
    teams: tuple[tuple[int, ...], ...]  # who is with whom; a robot in no team is lost
    free_at: tuple[int, ...]  # the step from which each robot is free: `step` or its service's end
    unseen_needs: frozenset[int] = frozenset()  # tasks of which nobody knows all needs
    unseen_places: frozenset[int] = frozenset()  # tasks of which nobody knows the place
    news: tuple[str, ...] = ("start",)  # of `NEWS`: what has happened since the latest plan

    @cached_property
    def robots(self) -> tuple[int, ...]:
        """Return the robots that are there, ascending."""
        return tuple(sorted(robot for team in self.teams for robot in team))

    @cached_property
    def possible_tasks(self) -> tuple[int, ...]:
        """Return the open tasks that the robots left can do; others wait for one to come back."""
        world = self.mission.world
        have = totals_by_region(world, (self.mission.robots[robot] for robot in self.robots))
        return tuple(
            number
            for number in self.open_tasks
            if covers(
                have[world.region(self.mission.tasks[number].at)],
                self.mission.tasks[number].needs,
            )
        )


@dataclass(frozen=True)
class Plan:
    """Who does what, in what order.

    Each robot's next task is the first one not done that has it in its coalition. The robots of a
    coalition go there, wait for one another and join; robots that have different next tasks part.
    """

    order: tuple[int, ...] = ()  # open tasks
    coalitions: tuple[tuple[int, ...], ...] = ()  # the robots of each, in the same order
    ends: tuple[int, ...] = ()  # the step in which each is done if nothing happens; or empty
    scouts: tuple[tuple[int, int], ...] = ()  # robots, and the task that each looks at first
    why: tuple[str, ...] = ()  # the news that it was made after, or `TAKEN_OVER`
    made_from: str = ""  # what the search began with: crews, coalitions, arcs, old plan; or kept

    @property
    def makespan(self) -> int:
        """Return the step in which the last task is done if nothing happens."""
        return max(self.ends, default=0)


class Coordinator(Protocol):
    """Decides which robots do which task together, and when that is to change.

    It is asked at the start and whenever there is news that it `heeds`; a coordinator without
    `heeds` hears of all but tasks that are done (`UNFORESEEN`). One coordinator may serve many
    missions at once, so it keeps nothing between calls: the old plan is given to it.
    """

    def update(self, known: Known, plan: Plan | None) -> Plan:
        """Return the plan from now on; `plan` itself where nothing is to change.

        `plan` is what is left of the latest one, None at the start. Every coalition of the new one
        can do its task. An open task that has none, or is left out, waits for a later plan.
        """
        ...


def heeded_by(coordinator: Coordinator) -> tuple[str, ...]:
    """Return the news after which a coordinator is asked."""
    heeds: tuple[str, ...] = getattr(coordinator, "heeds", UNFORESEEN)
    return heeds
