"""Who may begin what in continuous time, by the plan in force.

A task begins when its whole coalition stands there with nothing else to do first, has formed, and
release, precedence, links and the room of its zones allow it.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

from teamformer.mission.checks.windows import release_of
from teamformer.mission.model import Mission
from teamformer.mission.parts.zones import ZoneRoom, lets_in, may_enter, may_unload, rooms_of
from teamformer.mission.precedence import tasks_before
from teamformer.world.continuous.following import PlanFollower
from teamformer.world.continuous.hopeless import misses
from teamformer.world.continuous.links import GapKeeper
from teamformer.world.continuous.world import PhysicalWorld
from teamformer.world.rules.constants import NOBODY


class TaskStarts:
    """What is so and what is planned, and by both which tasks begin."""

    def __init__(self, mission: Mission, truth: Mission, is_told_all: bool) -> None:
        self.mission = mission
        self.world = PhysicalWorld(mission, truth, is_told_all)
        self.follower = PlanFollower(mission)
        self.links = GapKeeper(mission)
        self.before = tasks_before(mission.tasks)
        self.has_rooms = bool(rooms_of(mission))

    @property
    def rooms(self) -> list[ZoneRoom]:
        """Return the room of zones, with loads in it where they lie."""
        return rooms_of(self.mission, self.world.lies) if self.has_rooms else []

    def let_unload(self) -> list[int]:
        """Let loads be unloaded that wait for room where there is some; return these.

        Of who goes on waiting it is told.
        """
        world, unloaded = self.world, list[int]()
        for task in world.at_work.queue if world.may_queue else ():
            if not may_unload(self.rooms, world.at_work, task):
                world.queue_with_load(task)
                continue
            own = world.works[task].event
            is_told = world.events[own].kind == "queue"
            cause = world.cause_among(self._let_in(task, is_load=True)) if is_told else own
            world.unload(task, cause)
            unloaded.append(task)
        return unloaded

    def let_begin(self, tasks: Iterable[int]) -> list[int]:
        """Let those of some tasks form or begin that may; return those that have begun."""
        complete = [task for task in sorted(tasks) if self.is_complete(task)]
        complete = [task for task in complete if not misses(self.world, task, self.team(task))]
        ready = [task for task in complete if not self._forms(task) and self.is_released(task)]
        began = self.links.free(self.world, ready)
        while set(began) != set(entered := self._entering(began)):
            began = self.links.free(self.world, entered)
        for task in entered:
            self.serve(task)
        return entered

    def _entering(self, tasks: list[int]) -> list[int]:
        """Return those of some tasks that may begin by their zones, in the order of the plan."""
        if not tasks or not (rooms := self.rooms):
            return tasks
        waiting = [task for task in self.follower.order if self._is_awaited(task)]
        work, entered = self.world.at_work, list[int]()
        for task in sorted(tasks, key=waiting.index):
            if may_enter(rooms, waiting, work._replace(served=[*work.served, *entered]), task):
                entered.append(task)
                waiting.remove(task)
        return entered

    def _is_awaited(self, task: int) -> bool:
        """Say whether a task is to begin that has robots left."""
        is_over = task in self.world.over or task in self.world.under_way
        return not is_over and bool(self.team(task))

    def team(self, task: int) -> tuple[int, ...]:
        """Return the robots of a task's coalition that are not lost."""
        robots = self.follower.robots_of.get(task, ())
        return tuple(robot for robot in robots if not self.world.bodies[robot].is_lost)

    def is_complete(self, task: int) -> bool:
        """Say whether a task is open, and its team stands there and brings what it really needs."""
        world = self.world
        if task in world.over or task in world.works or task not in world.appeared:
            return False
        team, place = self.team(task), world.place_of(task)
        if task in world.maybe:
            return False
        is_there = all(
            world.is_at(robot, place) and self.follower.next_task(world, robot) == task
            for robot in team
        )
        is_able = world.covers(team, task) and world.can_carry(team, task)
        return bool(team) and is_there and is_able

    def has_to_form(self, task: int) -> bool:
        """Say whether the team of a task comes from several places and has not formed yet."""
        came_from = {self.world.bodies[robot].came_from for robot in self.team(task)}
        return self.mission.forming > 0 and len(came_from) > 1

    def _forms(self, task: int) -> bool:
        """Let a team form that has not, if that fits into its shifts; say whether it had to."""
        if not self.has_to_form(task):
            return False
        world, team = self.world, self.team(task)
        since = [world.bodies[robot].since for robot in team]
        if world.when_forms(team) == world.now:
            world.form(task, team, world.cause_among([*since, self.plan_now()]))
        return True

    def is_released(self, task: int) -> bool:
        """Say whether a task may begin, but for links of its start."""
        world = self.world
        is_open = release_of(world.truth.tasks[task]) <= world.now
        is_ready = is_open and world.over.keys() >= set(self.before.get(task, ()))
        return is_ready and world.when_fits(task, self.team(task)) == world.now

    def serve(self, task: int, is_held: bool = True) -> None:
        """Have a task served by its team; what it has waited for last is the cause.

        If that is none of what is physically so, it `is_held` by a link of its start.
        """
        world, team = self.world, self.team(task)
        causes = [world.bodies[robot].since for robot in team]
        causes += [world.over[other] for other in self.before.get(task, ())]
        causes += [*self._opened(task), *self._let_in(task), self.plan_now()]
        is_held = is_held and task in self.links.linked
        if is_held and world.events[max(causes)].at < world.now:
            cause = self.links.cause(world, task, self.follower.robots_of)
            cause = self.follower.event if cause == NOBODY else cause  # the plan has foreseen it
            causes.append(world.tell("opens", (), task, cause))
        world.serve(task, team, world.cause_among(causes))

    def _opened(self, task: int) -> Iterable[int]:
        """Return the events of this moment that let a task begin or be known."""
        for number, kind, other in self._moment():
            if other == task and kind in ("opens", "appear"):
                yield number

    def _let_in(self, task: int, is_load: bool = False) -> Iterable[int]:
        """Return the events of this moment that let a task into its zones, or unload there."""
        return lets_in(self.rooms, [*self._moment()], self.world.at_work, task, is_load)

    def _moment(self) -> Iterator[tuple[int, str, int]]:
        """Yield the events of this moment: the number, the kind and the task of each."""
        events = self.world.events
        number = len(events) - 1
        while number >= 0 and events[number].at == self.world.now:
            yield number, events[number].kind, events[number].task
            number -= 1

    def plan_now(self) -> int:
        """Return the event of the plan if it has come into force at this moment."""
        event = self.follower.event
        is_now = event != NOBODY and self.world.events[event].at == self.world.now
        return event if is_now else NOBODY

    def waits_for_a_time(self) -> bool:
        """Say whether a team that is complete waits for a time that will come."""
        now = self.world.now
        return any(
            release_of(self.world.truth.tasks[task]) > now
            or self.links.holds.get(task, now) > now
            or now < self._when_fits(task) < math.inf
            for task in self.follower.order
            if self.is_complete(task)
        )

    def _when_fits(self, task: int) -> float:
        """Return when forming, or the task, fits into the shifts of its team, which is there."""
        team = self.team(task)
        is_forming = self.has_to_form(task)
        return self.world.when_forms(team) if is_forming else self.world.when_fits(task, team)
