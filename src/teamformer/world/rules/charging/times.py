"""When tasks start where robots queue: a plan carried out, moment by moment.

Robots with batteries queue at chargers, and teams with loads before zones where they unload. So who
has room when hangs on all that others do: tasks cannot be timed one after the other.
"""

from __future__ import annotations

import heapq
import math
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

from teamformer.world.rules.charging.stops import ChargeRules
from teamformer.world.rules.constants import NOBODY
from teamformer.world.rules.entering import RoomsTaken
from teamformer.world.rules.starts import FIRST, Gap, StartRules, Timed, Visit

AT_CHARGER, FULL, DONE, LEAVE, READY, FREED, LIFTED, BROUGHT = range(8)
"""What happens at a moment."""

SAME = 1e-9
"""By such a share starts may be too near for a link, as times are rounded."""

ROUNDS_EACH = 3
"""For each task a plan with linked starts is carried out so many times at most."""

HOMEWARD = -2
"""What stands for the task of a robot that goes home."""


class ChargeStart(NamedTuple):
    """How all stands when a plan begins: where robots are, what they have left, who charges."""

    places: Sequence[Hashable]  # by robot, once it is free
    left: Sequence[float]  # by robot, then
    taken: Sequence[tuple[int, float]]  # chargers where somebody charges, and until when
    task_places: Mapping[int, Hashable]
    task_ends: Mapping[int, Hashable]  # the same but for loads
    homes: Sequence[Hashable | None]  # by robot; None: it may stay where it is
    spends: Sequence[Sequence[float]]  # by robot and task: what it may take, carried by the slowest
    serves: Sequence[Sequence[float]]  # the same without the way of the load
    services: Sequence[float]  # by task: how long it takes but for that


@dataclass
class ChargedTimes:
    """Tasks with their times, and when each robot is home; infinite for who never is."""

    timed: Timed
    back: list[float]
    charges: list[tuple[int, int, float, float]] = field(default_factory=list)
    """Each robot that charges, at which charger, from when and until when."""
    walked: list[float] = field(default_factory=list)
    """How long each robot is on its way in all."""


def time_charged(
    rules: StartRules,
    charging: ChargeRules,
    standing: ChargeStart,
    order: Sequence[int],
    robots_of: Mapping[int, Sequence[int]],
) -> ChargedTimes:
    """Return when tasks start that are done in an order, each by its robots, if these charge.

    Where starts are linked the plan is carried out again and again, with tasks held that began too
    soon, until all links are kept.
    """
    holds = dict[int, float]()
    for _ in range(ROUNDS_EACH * len(order) + 1 if rules.gaps else 1):
        told = _CarriedOut(rules, charging, standing, order, robots_of, holds).play()
        if not (later := _held_longer(rules.gaps, told.timed)):
            return told
        holds |= later
    told.timed.start.update(dict.fromkeys(order, math.inf))
    return replace(told, back=[math.inf] * len(told.back))


def _held_longer(gaps: Sequence[Gap], timed: Timed) -> dict[int, float]:
    """Return the tasks that have to start later for their links, and when."""
    later: dict[int, float] = {}
    for task, other, least, most in gaps:
        for held, at in ((task, timed.start[other] + least), (other, timed.start[task] - most)):
            if timed.start[held] + SAME * max(1.0, at) < at < math.inf:
                later[held] = max(at, later.get(held, 0.0))
    return later


class _CarriedOut:
    """A plan that is carried out."""

    def __init__(
        self,
        rules: StartRules,
        charging: ChargeRules,
        standing: ChargeStart,
        order: Sequence[int],
        robots_of: Mapping[int, Sequence[int]],
        holds: Mapping[int, float],
    ) -> None:
        self.rules, self.charging, self.standing = rules, charging, standing
        self.holds = holds
        self.robots_of, count = robots_of, len(standing.places)
        never = dict.fromkeys(order, math.inf)
        takes = {task: rules.takes(task, robots_of[task]) for task in order}
        self.timed = Timed(never, takes, {task: [] for task in order})
        self.told = ChargedTimes(self.timed, [math.inf] * count, walked=[0.0] * count)
        self.routes: list[list[int]] = [[] for _ in range(count)]
        for task in reversed(order):
            for robot in robots_of[task]:
                self.routes[robot].append(task)
        self.before = [FIRST] * count  # the latest task of each robot
        self.left = list(standing.left)
        self.left_at_task: dict[tuple[int, int], float] = {}
        self.ended: set[int] = set()
        self.rooms = RoomsTaken(rules.rooms, order)
        self.agenda: list[tuple[float, int, int, int]] = []
        self.busy = [0] * len(charging.chargers)
        self.queues: list[list[tuple[float, int]]] = [[] for _ in charging.chargers]

    def play(self) -> ChargedTimes:
        """Carry the plan out."""
        for charger, until in self.standing.taken:
            self.busy[charger] += 1
            heapq.heappush(self.agenda, (until, FULL, NOBODY, charger))
        for zone, room in enumerate(self.rules.rooms):
            for until in room.taken:
                heapq.heappush(self.agenda, (until, FREED, zone, NOBODY))
        for robot, free in enumerate(self.rules.free):
            heapq.heappush(self.agenda, (free, LEAVE, robot, NOBODY))
        while self.agenda:
            now = self.agenda[0][0]
            while self.agenda and self.agenda[0][0] <= now:
                self._happen(*heapq.heappop(self.agenda))
            for charger in range(len(self.queues)):
                self._fill(charger, now)
            if self.rules.rooms:
                self._fill_zones(now)
        return self.told

    def _happen(self, now: float, what: int, which: int, charger: int) -> None:
        if what == AT_CHARGER:
            self.queues[charger].append((now, which))
        elif what == FULL:
            self.busy[charger] -= 1
            if which != NOBODY:
                battery = self.charging.batteries[which]
                assert battery is not None
                self.left[which] = battery.lasts
                self._leave(which, now, self.charging.chargers[charger])
        elif what == DONE:
            self._done(which, now)
        elif what == READY:
            self.rooms.ready.add(which)
        elif what == FREED:
            self.rooms.free(which)
        elif what == LIFTED:
            self.rooms.leave(which)
        elif what == BROUGHT:
            self.rooms.queue.append((now, which))
        else:
            self._leave(which, now, self.standing.places[which])

    def _fill(self, charger: int, now: float) -> None:
        """Let those charge that have waited longest, as far as there is room."""
        queue = self.queues[charger]
        queue.sort()
        while queue and self.busy[charger] < self.charging.rooms[charger]:
            _, robot = queue.pop(0)
            battery = self.charging.batteries[robot]
            assert battery is not None
            until = now + battery.time_to_full(self.left[robot])
            self.busy[charger] += 1
            self.told.charges.append((robot, charger, now, until))
            heapq.heappush(self.agenda, (until, FULL, robot, charger))

    def _leave(self, robot: int, now: float, here: Hashable) -> None:
        """Let a robot go to its next task, home, or to a charger first."""
        charging, route = self.charging, self.routes[robot]
        battery, task = charging.batteries[robot], route[-1] if route else HOMEWARD
        goal = self.standing.task_places[task] if route else self.standing.homes[robot]
        if goal is None:
            self.told.back[robot] = now
            return
        wanted = 0.0
        if route and battery is not None:
            spent, end = self.standing.spends[robot][task], self.standing.task_ends[task]
            wanted = charging.wanted(robot, spent, end)
        charger = charging.stop(robot, here, self.left[robot], goal, wanted)
        if charger != NOBODY:
            goal = charging.chargers[charger]
        way = charging.way(robot, here, goal)
        if battery is not None:
            if not battery.suffices(self.left[robot], way):
                return  # it runs dry
            self.left[robot] = max(0.0, self.left[robot] - way)
        comes = self.rules.arrival(robot, now, way)
        if math.isinf(comes):
            return  # its shifts are over before
        self.told.walked[robot] += way
        if charger != NOBODY:
            heapq.heappush(self.agenda, (comes, AT_CHARGER, robot, charger))
        elif route:
            self._arrive(robot, route.pop(), comes)
        else:
            self.told.back[robot] = comes

    def _arrive(self, robot: int, task: int, at: float) -> None:
        self.timed.visits[task].append(Visit(robot, self.before[robot], at))
        self.left_at_task[robot, task] = self.left[robot]
        self._start(task)

    def _fill_zones(self, now: float) -> None:
        """Let loads be unloaded, and then tasks begin in zones, as far as there is room."""
        for load in self.rooms.next_unloaded():
            self._unload(load, now)
        for task in self.rooms.next_begun():
            fits = self.rules.fitted(self.robots_of[task], now, self.timed.takes[task])
            if fits > now:
                self.rooms.ready.discard(task)
                self._put(fits, READY, task)
            else:
                self.rooms.begin(task)
                self._begin(task, now)

    def _put(self, at: float, what: int, which: int) -> None:
        if math.isfinite(at):
            heapq.heappush(self.agenda, (at, what, which, NOBODY))

    def _start(self, task: int) -> None:
        """Let a task start if all come and what it is after has ended; in zones, if it may."""
        visits, before = self.timed.visits[task], self.rules.before.get(task, ())
        if len(visits) < len(self.robots_of[task]) or not self.ended.issuperset(before):
            return
        rules, robots = self.rules, self.robots_of[task]
        there = max(visit.arrive for visit in visits)
        if rules.forming and len({rules.site(visit.robot, visit.before) for visit in visits}) > 1:
            there = rules.fitted(robots, there, rules.forming) + rules.forming
        ends = (self.timed.end(other) for other in before)
        start = max([rules.release[task], self.holds.get(task, 0.0), there, *ends])
        start = rules.fitted(robots, start, self.timed.takes[task])
        if task in self.rooms.entered:
            self._put(start, READY, task)
        elif math.isfinite(start):
            self._begin(task, start)

    def _begin(self, task: int, start: float) -> None:
        """Let a task start at a time, unless somebody runs dry."""
        if not all(self._spend(visit, task, start) for visit in self.timed.visits[task]):
            return
        self.timed.start[task] = start
        end, loads = self.timed.end(task), self.rules.loads
        if loads is not None and task in loads.lifting:
            lifted = start + loads.lifting[task]
            self._put(lifted, LIFTED, task)
            if task in self.rooms.unloaded_in:
                there = lifted + loads.carried(task, self.robots_of[task])
                self._put(min(there, end) if loads.unloading[task] else end, BROUGHT, task)
                return
        self._put(end, DONE, task)

    def _unload(self, task: int, now: float) -> None:
        """Let a load be unloaded that has come before; nobody may run dry, nor his shift end."""
        assert self.rules.loads is not None, "it is a load"
        came, start = self.rooms.unload(task), self.timed.start[task]
        if came < now:
            self.timed.takes[task] = now + self.rules.loads.unloading[task] - start
        robots, takes = self.robots_of[task], self.timed.takes[task]
        is_charged = all(self._wait(robot, came, now) for robot in robots)
        if is_charged and self.rules.fitted(robots, start, takes) == start:
            self._put(self.timed.end(task), DONE, task)
        else:
            self.timed.start[task] = math.inf

    def _wait(self, robot: int, begin: float, end: float) -> bool:
        """Let a robot wait with a load; say whether it does not run dry."""
        battery = self.charging.batteries[robot]
        if battery is None:
            return True
        left, spent = self.left[robot], battery.waiting * self.rules.worked(robot, begin, end)
        self.left[robot] = max(0.0, left - spent)
        return battery.suffices(left, spent)

    def _spend(self, visit: Visit, task: int, start: float) -> bool:
        """Let a robot wait and serve; say whether it does not run dry."""
        battery = self.charging.batteries[visit.robot]
        if battery is None:
            return True
        spent = battery.waiting * self.rules.worked(visit.robot, visit.arrive, start)
        spent += self.standing.serves[visit.robot][task]
        spent += max(0.0, self.timed.takes[task] - self.standing.services[task])
        left = self.left_at_task[visit.robot, task]
        self.left[visit.robot] = max(0.0, left - spent)
        return battery.suffices(left, spent)

    def _done(self, task: int, now: float) -> None:
        self.ended.add(task)
        self.rooms.leave(task)
        for robot in sorted(self.robots_of[task]):
            self.before[robot] = task
            self._leave(robot, now, self.standing.task_ends[task])
        for other, before in self.rules.before.items():
            is_waiting = math.isinf(self.timed.start.get(other, 0.0))
            if task in before and is_waiting:
                self._start(other)
