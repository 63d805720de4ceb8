"""The physical world in continuous time: robots walk, form, serve and carry; things befall them.

It knows what is physically so, and the truth; who may begin what is for those who command.
Whatever happens is an event with its cause. Nothing happens between the entries of its agenda, and
these are data, so a world is forked by copying it.
"""

from __future__ import annotations

import copy
import heapq
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from teamformer.mission.checks.windows import release_of
from teamformer.mission.model import Mission
from teamformer.mission.parts.capabilities import covers, total
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.plane import Plane
from teamformer.world.continuous.body import (
    CARRYING,
    FORMING,
    SERVING,
    UNLOADING,
    RealRobot,
    TeamWork,
    turning,
)
from teamformer.world.continuous.delays import StandingStill
from teamformer.world.continuous.events import Event, Passed
from teamformer.world.continuous.ways import Ways
from teamformer.world.rules.constants import NOBODY

LOSE, BRING_BACK, CALL_OFF, APPEAR, OPEN, ARRIVE, FINISH, EXPECT, WAKE = range(9)
"""What can be on the agenda; of what is due at one moment, what comes from outside is first."""

SHORTEST_HOPE = 10
"""A service that is overdue is expected to take a tenth more of the longest at least."""

Entry = tuple[float, int, int, int]
"""When something is due, what, whom or which task it is about, and the event that it belongs to."""


@dataclass
class Happened:
    """What a moment has brought: news, and what robots and tasks have to be looked at."""

    news: dict[str, None] = field(default_factory=dict)  # in the order in which they came
    robots: set[int] = field(default_factory=set)
    tasks: set[int] = field(default_factory=set)


class PhysicalWorld:
    """All robots, tasks and loads; `advance` goes to the next moment at which something is due."""

    def __init__(self, mission: Mission, truth: Mission, is_all_known: bool = False) -> None:
        self.mission, self.truth = mission, truth
        self.now = 0.0
        self.events: list[Event] = []
        self.bodies = [RealRobot((Passed(0.0, r.at),), r.at) for r in truth.robots]
        self.works: dict[int, TeamWork] = {}  # by task
        self.over: dict[int, int] = {}  # tasks that are done or called off, with the event
        self.done: set[int] = set()
        self.started: dict[int, float] = {}  # when the latest service of each began
        self.served_by: dict[int, int] = {}  # the event with which it did
        self.appeared = {
            number for number, task in enumerate(truth.tasks) if task.appears == 0 or is_all_known
        }
        self.unseen = {k for k, task in enumerate(mission.tasks) if task.may_need}
        self.lies: dict[int, Place] = {}  # where loads were set down, by task
        self.travel = 0.0  # time that robots have spent on their ways
        self.ways, self._still = Ways(truth.world), StandingStill(truth.robots)
        self._is_plane = isinstance(truth.world, Plane)
        self._happened = Happened()
        self._agenda: list[Entry] = []
        self._put_what_is_to_come()

    def fork(self) -> PhysicalWorld:
        """Return a world in which the same has happened, and which goes its own way."""
        twin = copy.copy(self)
        twin.events, twin._agenda = list(self.events), list(self._agenda)
        twin.bodies = [copy.copy(body) for body in self.bodies]
        twin.works = {task: copy.copy(work) for task, work in self.works.items()}
        for part in ("over", "done", "started", "served_by", "appeared", "unseen", "lies"):
            setattr(twin, part, copy.copy(getattr(self, part)))
        twin._happened = copy.deepcopy(self._happened)
        return twin

    @property
    def next_time(self) -> float:
        """Return when something is due next; infinite if nothing ever is."""
        while self._agenda and not self._is_due(self._agenda[0]):
            heapq.heappop(self._agenda)
        return self._agenda[0][0] if self._agenda else math.inf

    @property
    def is_busy(self) -> bool:
        """Say whether somebody is on the way, forms or is at work."""
        return bool(self.works) or any(b.is_walking and not b.is_lost for b in self.bodies)

    def advance(self) -> Happened:
        """Go to the next moment and let all happen that is due then."""
        self.now = self.next_time
        while self.next_time <= self.now:
            _, what, which, stamp = heapq.heappop(self._agenda)
            self._let_happen(what, which, stamp)
        return self.take_happened()

    def take_happened(self) -> Happened:
        """Return what has happened since this was last asked."""
        happened, self._happened = self._happened, Happened()
        return happened

    def place_of(self, task: int) -> Place:
        """Return where a task is, or its load lies."""
        return self.lies.get(task, self.truth.tasks[task].at)

    def is_at(self, robot: int, place: Place) -> bool:
        """Say whether a robot stands at a place, and is neither lost nor at work."""
        body = self.bodies[robot]
        is_free = not body.is_lost and body.work == NOBODY
        return is_free and not body.is_walking and body.way[0].place == place

    def next_place(self, robot: int) -> Passed:
        """Return where a robot can turn next, and when; where it is if it stands."""
        return turning(self.bodies[robot].way, self.now, self._is_plane)[-1]

    def covers(self, robots: Iterable[int], task: int) -> bool:
        """Say whether robots bring what a task really needs."""
        have = total(self.truth.robots[robot].can for robot in robots)
        return covers(have, self.truth.tasks[task].needs)

    def set_out(self, robot: int, goal: Place | None, task: int, cause: int) -> None:
        """Have a robot go to a task, home or, without a goal, to where it can stop next.

        It stays if it is there already, or if no way leads there.
        """
        body, real = self.bodies[robot], self.truth.robots[robot]
        body.task = task
        stub = turning(body.way, self.now, self._is_plane)
        start = stub[-1]
        goal = start.place if goal is None else goal
        if body.is_walking and body.way[-1].place == goal and self._heads_for(body) == task:
            return
        if not math.isfinite(self.ways.length(start.place, goal, real.moves)):
            goal = start.place
        stages = self.ways.stages(start.place, goal, real.moves)
        way = (*stub, *self._passing((robot,), start.at, [(p, d / real.speed) for p, d in stages]))
        if len(way) == 1:
            stops = body.is_walking
            self._stop_walking(body)
            body.way = way
            if task != NOBODY or stops:
                body.since = self.tell("arrive", (robot,), task, cause, place=goal)
                self.sense(robot)
            return
        self._stop_walking(body)
        body.way = way
        number = self.tell("walk", (robot,), task, cause, until=way[-1].at, way=way)
        body.since = body.set_out = number
        self._put(way[-1].at, ARRIVE, robot, number)

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
        carried = self._carried(task, robots)
        end = self.now + (real.duration + carried + real.unload)
        expected = self.now + (wanted.duration + carried + wanted.unload)
        place = self.place_of(task)
        number = self.tell("serve", robots, task, cause, place=place, until=expected)
        first = end if real.to is None else self.now + real.duration
        self.started[task], self.served_by[task] = self.now, number
        self._begin(task, TeamWork(robots, SERVING, self.now, first, end, expected, number))
        if wanted.duration < real.duration:
            self._put(self.now + wanted.duration, EXPECT, task, number)
        self._happened.tasks.add(task)

    def tell(self, kind: str, robots: Sequence[int], task: int, cause: int, **said: object) -> int:
        """Write down an event of this moment, and return its number."""
        event = Event(self.now, kind, tuple(robots), task, cause=cause)
        self.events.append(event._replace(**said))  # type: ignore[arg-type]
        return len(self.events) - 1

    def wake(self, at: float, task: int) -> None:
        """Have a task looked at again at a moment."""
        self._put(at, WAKE, task, NOBODY)

    def cause_among(self, candidates: Iterable[int]) -> int:
        """Return on which of some events something hangs that begins now: on the latest one.

        If none of them is of this moment, it hangs on what has happened last.
        """
        latest = max(candidates, default=NOBODY)
        is_now = latest != NOBODY and self.events[latest].at == self.now
        return latest if is_now or not self.events else len(self.events) - 1

    def _put_what_is_to_come(self) -> None:
        for number, robot in enumerate(self.truth.robots):
            for away in robot.absences:
                self._put(away.lost, LOSE, number, NOBODY)
                if away.back is not None:
                    self._put(away.back, BRING_BACK, number, NOBODY)
        for number, task in enumerate(self.truth.tasks):
            if task.appears > 0:
                self._put(task.appears, APPEAR, number, NOBODY)
            if task.cancelled is not None:
                self._put(task.cancelled, CALL_OFF, number, NOBODY)
            if release_of(task) > task.appears:
                self._put(release_of(task), OPEN, number, NOBODY)

    def _put(self, at: float, what: int, which: int, stamp: int) -> None:
        heapq.heappush(self._agenda, (at, what, which, stamp))

    def _is_due(self, entry: Entry) -> bool:
        """Say whether an entry of the agenda still holds."""
        _, what, which, stamp = entry
        if what == ARRIVE:
            body = self.bodies[which]
            return body.is_walking and body.set_out == stamp and not body.is_lost
        if what in (FINISH, EXPECT):
            return which in self.works and self.works[which].event == stamp
        return which not in self.over if what in (CALL_OFF, OPEN, WAKE) else True

    def _let_happen(self, what: int, which: int, stamp: int) -> None:
        if what == LOSE:
            self._lose(which)
        elif what == BRING_BACK:
            self._bring_back(which)
        elif what == CALL_OFF:
            self._call_off(which)
        elif what == APPEAR:
            self.appeared.add(which)
            self.tell("appear", (), which, NOBODY)
            self._note("task appeared", tasks=(which,))
            for robot in range(len(self.bodies)):
                self.sense(robot)
        elif what == OPEN:
            self.tell("opens", (), which, NOBODY)
            self._note(tasks=(which,))
        elif what == ARRIVE:
            self._arrive(which)
        elif what == FINISH:
            self._finish_part(which)
        elif what == EXPECT:
            self._expect_anew(which)
        else:
            self._note(tasks=(which,))

    def _note(self, news: str = "", robots: Iterable[int] = (), tasks: Iterable[int] = ()) -> None:
        if news:
            self._happened.news[news] = None
        self._happened.robots.update(robots)
        self._happened.tasks.update(tasks)

    def _passing(
        self, who: Sequence[int], begin: float, stages: Iterable[tuple[Place, float]]
    ) -> tuple[Passed, ...]:
        """Return when robots that go together pass places, each with the time on the way to it."""
        after = self._still.after
        return tuple(Passed(after(who, begin, spent), place) for place, spent in stages)

    def _heads_for(self, body: RealRobot) -> int:
        """Return the task that a robot has set out for."""
        return self.events[body.set_out].task

    def _stop_walking(self, body: RealRobot) -> None:
        if body.is_walking:
            self.travel += self.now - self.events[body.set_out].at

    def _arrive(self, robot: int) -> None:
        body = self.bodies[robot]
        self._stop_walking(body)
        body.way = (body.way[-1],)
        place, cause = body.way[0].place, body.set_out
        body.since = self.tell("arrive", (robot,), body.task, cause, place=place)
        self._note(robots=(robot,))
        self.sense(robot)

    def sense(self, robot: int) -> None:
        """Let it be known what tasks need at which a robot stands."""
        body = self.bodies[robot]
        if not self.unseen or body.is_walking or body.is_lost:
            return
        place = body.way[0].place
        for task in sorted(self.unseen & self.appeared - self.over.keys()):
            if self.place_of(task) == place:
                self.unseen.discard(task)
                needs = self.truth.tasks[task].needs
                self.tell("know", (robot,), task, self.cause_among([body.since]), needs=needs)
                self._note("needs known", tasks=(task,))

    def _begin(self, task: int, work: TeamWork) -> None:
        self.works[task] = work
        for robot in work.robots:
            body = self.bodies[robot]
            body.work, body.since = task, work.event
        self._put(work.end, FINISH, task, work.event)

    def _finish_part(self, task: int) -> None:
        work, real = self.works[task], self.truth.tasks[task]
        if work.part == FORMING:
            del self.works[task]
            place = self.place_of(task)
            number = self.tell("formed", work.robots, task, work.event, place=place)
            self._free(work.robots, place, number, task)
        elif work.part == SERVING and real.to is not None:
            self._lift(task)
        elif work.part == CARRYING:
            self._unload(task)
        else:
            del self.works[task]
            place = self.place_of(task) if real.to is None else real.to
            number = self.tell("done", work.robots, task, work.event, place=place)
            self.over[task] = number
            self.done.add(task)
            self._free(work.robots, place, number)
            self._note("task done", tasks=(task,))

    def _free(self, robots: Iterable[int], place: Place, event: int, task: int = NOBODY) -> None:
        """Let robots be free where they are; whoever formed waits at its task."""
        for robot in robots:
            body = self.bodies[robot]
            body.work, body.task, body.since = NOBODY, task, event
            body.came_from, body.way = place, (Passed(self.now, place),)
        self._note(robots=robots)

    def _carried(self, task: int, robots: Sequence[int]) -> float:
        """Return how long a load is carried from where it lies, by the slowest of some robots."""
        goal, here = self.truth.tasks[task].to, self.place_of(task)
        if goal is None or goal == here:
            return 0.0
        return max(self._times(robot, here, goal)[-1][1] for robot in robots)

    def _times(self, robot: int, here: Place, goal: Place) -> list[tuple[Place, float]]:
        """Return the places on a robot's way, each with the time it takes there."""
        real = self.truth.robots[robot]
        stages = self.ways.stages(here, goal, real.moves)
        return [(place, length / real.speed) for place, length in stages]

    def _lift(self, task: int) -> None:
        """Let a team that has taken up its load set out with it."""
        work = self.works[task]
        all_done, cause = work.all_done, work.event
        self._carry(task, (Passed(self.now, self.place_of(task)),), cause)
        if not any(self.truth.robots[robot].delays for robot in work.robots):
            work.all_done = work.expected = all_done  # the same sum as plans have

    def _carry(self, task: int, stub: tuple[Passed, ...], cause: int) -> None:
        """Let a team go on with a load, from the next place of a way."""
        work, goal, start = self.works[task], self.truth.tasks[task].to, stub[-1]
        assert goal is not None, "it is a load"
        ways = [self._times(robot, start.place, goal) for robot in work.robots]
        slowest = max(ways, key=lambda way: way[-1][1] if way else 0.0)
        work.way = (*stub, *self._passing(work.robots, start.at, slowest))
        work.part, work.end = CARRYING, work.way[-1].at
        work.all_done = work.expected = work.end + self.truth.tasks[task].unload
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
        self._put(work.end, FINISH, task, work.event)

    def _unload(self, task: int) -> None:
        work, place = self.works[task], self.truth.tasks[task].to
        assert place is not None, "it is a load"
        work.part, work.end = UNLOADING, work.all_done
        work.event = self.tell("unload", work.robots, task, work.event, place=place, until=work.end)
        self.lies[task] = place
        for robot in work.robots:
            body = self.bodies[robot]
            body.way, body.since = (Passed(self.now, place),), work.event
        self._put(work.end, FINISH, task, work.event)

    def _expect_anew(self, task: int) -> None:
        """Let a service be expected to end later, in the middle of the time that is left to it."""
        work, wanted = self.works[task], self.mission.tasks[task]
        latest = work.begun + wanted.longest
        more = max((latest - self.now) / 2, wanted.longest / SHORTEST_HOPE)
        ends = min(latest, self.now + more)
        work.expected = ends + self._carried(task, work.robots) + wanted.unload
        self.tell("overdue", (), task, work.event, until=work.expected)
        if ends < work.begun + self.truth.tasks[task].duration:
            self._put(ends, EXPECT, task, work.event)
        self._note("service overdue", tasks=(task,))

    def _lose(self, robot: int) -> None:
        body = self.bodies[robot]
        if body.is_lost:
            return
        stub = turning(body.way, self.now, self._is_plane)
        if body.work == NOBODY:
            self._stop_walking(body)
        body.way, body.rest = stub, stub[-1].at - self.now
        body.is_lost, body.task = True, NOBODY
        number = self.tell("lost", (robot,), NOBODY, NOBODY, place=stub[-1].place)
        body.since = number
        self._note("robot lost", robots=(robot,))
        task, body.work = body.work, NOBODY
        if task != NOBODY:
            self._leave_work(task, robot, number)

    def _leave_work(self, task: int, robot: int, cause: int) -> None:
        """Let a team go on with its work without a robot, or break off."""
        work = self.works[task]
        work.robots = tuple(other for other in work.robots if other != robot)
        if work.part == FORMING or not self.covers(work.robots, task):
            self._break_off(task, cause)
        elif work.part == CARRYING:
            self._carry(task, turning(work.way, self.now, self._is_plane), work.event)

    def _break_off(self, task: int, cause: int) -> None:
        """Let a team leave its work; a load lies where it was passing last."""
        work = self.works.pop(task)
        stub = turning(work.way, self.now, self._is_plane) if work.way else ()
        if work.part == CARRYING:
            self.lies[task] = stub[0].place
        place = self.place_of(task) if work.part in (CARRYING, UNLOADING) else None
        number = self.tell("broken", work.robots, task, cause, place=place)
        for robot in work.robots:
            body = self.bodies[robot]
            body.work, body.task, body.since = NOBODY, NOBODY, number
            if work.part == CARRYING:
                self._stand(robot, stub, number)
        if work.part != FORMING:
            self.started.pop(task, None)
            self._note("service broken off")
        self._note(robots=work.robots, tasks=(task,))

    def _stand(self, robot: int, stub: tuple[Passed, ...], cause: int) -> None:
        """Let a robot stop that has carried something: at the next place of the way."""
        body = self.bodies[robot]
        body.way = stub
        if len(stub) > 1:
            number = self.tell("walk", (robot,), NOBODY, cause, until=stub[-1].at, way=stub)
            body.since = body.set_out = number
            self._put(stub[-1].at, ARRIVE, robot, number)

    def _bring_back(self, robot: int) -> None:
        body = self.bodies[robot]
        body.is_lost = False
        place = body.way[-1].place
        number = body.since = self.tell("back", (robot,), NOBODY, NOBODY, place=place)
        if body.is_walking:
            shift = self.now + body.rest - body.way[-1].at
            self._stand(robot, tuple(p._replace(at=p.at + shift) for p in body.way), number)
        self._note("robot back", robots=(robot,))

    def _call_off(self, task: int) -> None:
        number = self.over[task] = self.tell("cancel", (), task, NOBODY)
        if task in self.works:
            self._break_off(task, number)
        self._note("task cancelled", tasks=(task,))
