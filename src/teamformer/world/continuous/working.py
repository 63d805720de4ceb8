"""Teams at work: they form, serve, carry loads, and break off."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from teamformer.mission.parts.capabilities import covers, total
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.shifts import SAME, fits_all
from teamformer.world.continuous.body import (
    CARRYING,
    FORMING,
    QUEUEING,
    SERVING,
    UNLOADING,
    TeamWork,
    turning,
)
from teamformer.world.continuous.events import Passed
from teamformer.world.continuous.moving import ARRIVE, EXPECT, FINISH
from teamformer.world.continuous.seeking import SeekingWorld
from teamformer.world.continuous.ways import way_together
from teamformer.world.rules.constants import NOBODY

SHORTEST_HOPE = 10
"""A service that is overdue is expected to take a tenth more of the longest at least."""


class WorkingWorld(SeekingWorld):
    """What teams do together, each part of it with its end."""

    def form(self, task: int, robots: tuple[int, ...], cause: int) -> None:
        """Have robots that stand at a task form a team."""
        end = self.now + self.mission.forming
        place = self.place_of(task)
        number = self.tell("form", robots, task, cause, place=place, until=end)
        self._begin(task, TeamWork(robots, FORMING, self.now, end, end, end, number))

    def serve(self, task: int, robots: tuple[int, ...], cause: int) -> None:
        """Have robots that stand at a task, and bring what it needs, serve it."""
        assert self.covers(robots, task), "who commands has looked"
        real, wanted = self.truth.tasks[task], self.mission.tasks[task]
        carried = self.carried(task, robots)
        end = self.now + (real.duration + carried + real.unload)
        expected = self.now + self.believed_time(task, robots)
        place = self.place_of(task)
        number = self.tell("serve", robots, task, cause, place=place, until=expected)
        first = end if real.to is None else self.now + real.duration
        self.started[task], self.served_by[task] = self.now, number
        self._begin(task, TeamWork(robots, SERVING, self.now, first, end, expected, number))
        if wanted.duration < real.duration:
            self.put(self.now + wanted.duration, EXPECT, task, number)
        self.happened.tasks.add(task)

    def believed_time(self, task: int, robots: Sequence[int]) -> float:
        """Return how long some robots are believed to take for all of a task."""
        wanted = self.mission.tasks[task]
        return wanted.duration + self.carried(task, robots) + wanted.unload

    def when_fits(self, task: int, robots: Sequence[int]) -> float:
        """Return the first moment from which a task fits into a shift of each of some robots."""
        if not self.rotas:
            return self.now
        rotas = [self.rotas[robot] for robot in robots]
        return fits_all(rotas, self.now, self.believed_time(task, robots))

    def when_forms(self, robots: Sequence[int]) -> float:
        """Return the first moment from which forming fits into a shift of each of some robots."""
        rotas = [self.rotas[robot] for robot in robots] if self.rotas else []
        return fits_all(rotas, self.now, self.mission.forming)

    def covers(self, robots: Iterable[int], task: int) -> bool:
        """Say whether robots bring what a task really needs."""
        have = total(self.truth.robots[robot].can for robot in robots)
        return covers(have, self.truth.tasks[task].needs)

    def can_carry(self, robots: Iterable[int], task: int) -> bool:
        """Say whether robots have a way on with the load of a task, if it has one."""
        goal, here = self.truth.tasks[task].to, self.place_of(task)
        movers = {self.truth.robots[robot].moves for robot in robots}
        return goal is None or all(
            math.isfinite(self.ways.length(here, goal, moves)) for moves in movers
        )

    def _begin(self, task: int, work: TeamWork) -> None:
        self.works[task] = work
        for robot in work.robots:
            body = self.bodies[robot]
            body.work, body.since = task, work.event
        self.put(work.end, FINISH, task, work.event)

    def finish_part(self, task: int) -> None:
        """Let a part of a team's work be over, and what follows begin."""
        work, real = self.works[task], self.truth.tasks[task]
        if work.part == FORMING:
            del self.works[task]
            place = self.place_of(task)
            number = self.tell("formed", work.robots, task, work.event, place=place)
            self._free(work.robots, place, number, task)
        elif work.part == SERVING and real.to is not None:
            self._lift(task)
        elif work.part == CARRYING:
            self._bring(task)
        else:
            del self.works[task]
            place = self.place_of(task) if real.to is None else real.to
            number = self.tell("done", work.robots, task, work.event, place=place)
            self.over[task] = number
            self.done.add(task)
            self._free(work.robots, place, number)
            self.note("task done", tasks=(task,))

    def _free(self, robots: Iterable[int], place: Place, event: int, task: int = NOBODY) -> None:
        """Let robots be free where they are; whoever formed waits at its task."""
        for robot in robots:
            body = self.bodies[robot]
            body.work, body.task, body.since = NOBODY, task, event
            body.came_from, body.way = place, (Passed(self.now, place),)
        self.note(robots=robots)

    def carried(self, task: int, robots: Sequence[int]) -> float:
        """Return how long a load is carried from where it lies, by the slowest of some robots."""
        goal, here = self.truth.tasks[task].to, self.place_of(task)
        if goal is None or goal == here:
            return 0.0
        return max(self.times(robot, here, goal)[-1][1] for robot in robots)

    def _lift(self, task: int) -> None:
        """Let a team that has taken up its load set out with it."""
        work = self.works[task]
        is_delayed = any(self.truth.robots[robot].delays for robot in work.robots)
        all_done = None if is_delayed else work.all_done  # the same sum as plans have
        self.carry(task, (Passed(self.now, self.place_of(task)),), work.event, all_done)

    def carry(
        self, task: int, stub: tuple[Passed, ...], cause: int, all_done: float | None = None
    ) -> None:
        """Let a team go on with a load, from the next place of a way; `all_done` if it is known."""
        work, unload = self.works[task], self.truth.tasks[task].unload
        goal, start = self.truth.tasks[task].to, stub[-1]
        assert goal is not None, "it is a load"
        ahead = self._way_together(work.robots, start.place, goal)
        work.way = (*stub, *self.passing(work.robots, start.at, ahead))
        end = work.way[-1].at
        if all_done is not None:
            end = min(end, all_done) if unload else all_done
            work.way = (*work.way[:-1], work.way[-1]._replace(at=end))
        work.part, work.end = CARRYING, end
        work.all_done = work.expected = end + unload if all_done is None else all_done
        work.event = self.tell(
            "lift",
            work.robots,
            task,
            cause,
            place=stub[0].place,
            until=work.end,
            way=work.way,
        )
        for robot in work.robots:
            body = self.bodies[robot]
            body.way, body.since = work.way, work.event
        self.put(work.end, FINISH, task, work.event)
        if self.mission.zones:
            self.note(tasks=(task,))  # it leaves room where it was taken up

    def _way_together(
        self, robots: Sequence[int], here: Place, goal: Place
    ) -> list[tuple[Place, float]]:
        """Return the places on the way of a load, each with the time there, by the slowest."""
        real = [self.truth.robots[robot] for robot in robots]
        return way_together(self.ways, [(it.moves, it.speed) for it in real], here, goal)

    def _bring(self, task: int) -> None:
        """Let a load be where it is brought to: it is unloaded, or waits for room in a zone."""
        work, place = self.works[task], self.truth.tasks[task].to
        assert place is not None, "it is a load"
        self.lies[task], work.way = place, (Passed(self.now, place),)
        for robot in work.robots:
            self.bodies[robot].way = work.way
        if task not in self.may_queue:
            self.unload(task, work.event)
            return
        work.part, work.end, work.all_done = QUEUEING, math.inf, math.inf
        self.note(tasks=(task,))

    def has_just_come(self, task: int) -> bool:
        """Say whether a load that is to be unloaded has come at this moment."""
        return self.works[task].way[0].at == self.now

    def unload(self, task: int, cause: int) -> None:
        """Let a load be unloaded that is where it is brought to."""
        work, place = self.works[task], self.place_of(task)
        if not self.has_just_come(task):  # else it is done when it was believed to be
            work.expected = self.now + self.truth.tasks[task].unload
        work.part, work.end, work.all_done = UNLOADING, work.expected, work.expected
        work.event = self.tell("unload", work.robots, task, cause, place=place, until=work.end)
        for robot in work.robots:
            self.bodies[robot].since = work.event
        self.put(work.end, FINISH, task, work.event)

    def queue_with_load(self, task: int) -> None:
        """Tell that a team waits for room to unload, unless it has been told."""
        work = self.works[task]
        if self.events[work.event].kind == "queue":
            return
        work.event = self.tell("queue", work.robots, task, work.event, place=self.place_of(task))
        for robot in work.robots:
            self.bodies[robot].since = work.event

    def expected_end(self, task: int) -> float:
        """Return when a task is believed to be done that is under way; not in the past."""
        work = self.works[task]
        least = self.now + self.mission.tasks[task].unload * (work.part == QUEUEING)
        return max(work.expected, least)

    def expect_anew(self, task: int) -> None:
        """Let a service be expected to end later, in the middle of the time that is left to it."""
        work, wanted = self.works[task], self.mission.tasks[task]
        latest = work.begun + wanted.longest
        more = max((latest - self.now) / 2, wanted.longest / SHORTEST_HOPE)
        ends = min(latest, self.now + more)
        work.expected = ends + self.carried(task, work.robots) + wanted.unload
        self.tell("overdue", (), task, work.event, until=work.expected)
        if ends < work.begun + self.truth.tasks[task].duration:
            self.put(ends, EXPECT, task, work.event)
        self.note("service overdue", tasks=(task,))

    def leave_work(self, task: int, robot: int, cause: int) -> None:
        """Let a team go on with its work without a robot, or break off."""
        work = self.works[task]
        work.robots = tuple(other for other in work.robots if other != robot)
        if work.part == FORMING or not self.covers(work.robots, task):
            self.break_off(task, cause)
        elif work.part == CARRYING:
            self.carry(task, turning(work.way, self.now, self.is_plane), work.event)

    def knock_off(self, robot: int) -> None:
        """Let a shift of a robot end; whatever it is at work on breaks off if it is not done."""
        number = self.bodies[robot].since = self.tell("rests", (robot,), NOBODY, NOBODY)
        task = self.bodies[robot].work
        if task != NOBODY and self.works[task].all_done > self.now + SAME * max(1.0, self.now):
            self.break_off(task, number)
        self.note(robots=(robot,))

    def begin_shift(self, robot: int) -> None:
        """Let a shift of a robot begin."""
        self.bodies[robot].since = self.tell("works", (robot,), NOBODY, NOBODY)
        self.note(robots=(robot,))

    def break_off(self, task: int, cause: int) -> None:
        """Let a team leave its work; a load lies where it was passing last."""
        work = self.works.pop(task)
        stub = turning(work.way, self.now, self.is_plane) if work.way else ()
        if work.part == CARRYING:
            self.lies[task] = self._set_down(task, work.way)
        has_load = work.part in (CARRYING, UNLOADING, QUEUEING)
        place = self.place_of(task) if has_load else None
        number = self.tell("broken", work.robots, task, cause, place=place)
        for robot in work.robots:
            body = self.bodies[robot]
            body.work, body.task, body.since = NOBODY, NOBODY, number
            if work.part == CARRYING:
                self.stand(robot, stub, number)
        if work.part != FORMING:
            self.started.pop(task, None)
            self.note("service broken off")
        self.note(robots=work.robots, tasks=(task,))

    def _set_down(self, task: int, way: tuple[Passed, ...]) -> Place:
        """Return where a load is set down: where it passed last, not over an obstacle."""
        world, origin = self.truth.world, self.place_of(task)
        latest = self.now + SAME * max(1.0, self.now)  # sums of times are rounded
        passed = [one.place for one in way if one.at <= latest]
        where = [
            at for at in passed if world.is_free(at) and world.region(at) == world.region(origin)
        ]
        if self.is_plane:
            return turning(way, self.now, self.is_plane)[0].place
        return where[-1] if where else origin

    def stand(self, robot: int, stub: tuple[Passed, ...], cause: int) -> None:
        """Let a robot stop that has carried something: at the next place of the way."""
        body = self.bodies[robot]
        body.way = stub
        if len(stub) > 1:
            number = self.tell("walk", (robot,), NOBODY, cause, until=stub[-1].at, way=stub)
            body.since = body.set_out = number
            self.put(stub[-1].at, ARRIVE, robot, number)
