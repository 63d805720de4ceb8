"""Batteries that run down and are charged; robots that queue at chargers, and that run dry."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Iterator

from teamformer.mission.model import Mission
from teamformer.mission.parts.charging import ROUNDING, Battery, longest_carry
from teamformer.mission.parts.grid import Place
from teamformer.world.continuous.body import (
    CARRYING,
    FORMING,
    QUEUEING,
    SERVING,
    RealRobot,
)
from teamformer.world.continuous.moving import FULL
from teamformer.world.continuous.working import WorkingWorld
from teamformer.world.rules.charging.standing import charge_rules
from teamformer.world.rules.constants import NOBODY

DRY = 2 * ROUNDING
"""A robot runs dry that lacks such a share of a full battery: sums are rounded."""


class ChargingWorld(WorkingWorld):
    """What robots have left; between two moments each spends as it does since the former one."""

    def __init__(self, mission: Mission, truth: Mission, is_all_known: bool) -> None:
        super().__init__(mission, truth, is_all_known)
        self.rooms = [charger.room for charger in mission.chargers]
        self.charge_rules = charge_rules(mission, self._time_of_way)
        self._with_battery = [n for n, robot in enumerate(truth.robots) if robot.battery]
        for number, body, battery in self._batteries():
            self.bodies[number].left = battery.starts * battery.lasts
            body.left_at = self.now

    def _time_of_way(self, robot: int, here: object, there: object) -> float:
        assert isinstance(here, tuple), "places are pairs"
        assert isinstance(there, tuple), "places are pairs"
        real = self.truth.robots[robot]
        return self.ways.length(here, there, real.moves) / real.speed

    def _batteries(self) -> Iterator[tuple[int, RealRobot, Battery]]:
        for number in self._with_battery:
            battery = self.truth.robots[number].battery
            assert battery is not None
            yield number, self.bodies[number], battery

    @property
    def next_time(self) -> float:
        """Return when something happens next, or somebody runs dry; infinite if neither ever is."""
        return min(self.next_due, self._next_dry)

    @property
    def next_but_shifts(self) -> float:
        """Return the same, but for the ends and beginnings of shifts."""
        return min(super().next_but_shifts, self._next_dry)

    @property
    def _next_dry(self) -> float:
        """Return when somebody runs dry if nothing happens; infinite if nobody does."""
        spending = ((n, own) for n, body, own in self._batteries() if self._rate(body, own) > 0)
        due = (max(self.now, self._dry_at(number, battery)) for number, battery in spending)
        return min(due, default=math.inf)

    @property
    def is_busy(self) -> bool:
        """Say whether somebody is on the way, charges, forms or is at work."""
        return super().is_busy or any(body.is_charging for body in self.bodies)

    def be_at(self, moment: float) -> None:
        """Let time pass until a moment at which nothing is due before it."""
        self.now = moment
        for number, body, battery in self._batteries():
            spent = self._spent(number, battery, moment)
            body.left, body.left_at = min(battery.lasts, body.left - spent), moment

    def _spent(self, robot: int, battery: Battery, moment: float) -> float:
        """Return what a robot spends up to a moment, if nothing happens; less than 0 if it charges.

        Outside its shifts, and held up on its way, it spends nothing; it charges outside them, too.
        """
        body = self.bodies[robot]
        rate, begin = self._rate(body, battery), body.left_at
        if rate <= 0:
            return rate * (moment - begin)
        if (walkers := self._walkers(robot)) is not None:
            return self.still.walked(walkers, begin, moment)
        return rate * self.truth.robots[robot].rota.worked(begin, moment)

    def _dry_at(self, robot: int, battery: Battery) -> float:
        """Return when a robot that spends something has nothing left, if nothing happens."""
        body = self.bodies[robot]
        left, begin = body.left + DRY * battery.lasts, body.left_at
        if (walkers := self._walkers(robot)) is not None:
            return self.still.after(walkers, begin, left)
        return self.truth.robots[robot].rota.walked(begin, left / self._rate(body, battery))

    def _walkers(self, robot: int) -> tuple[int, ...] | None:
        """Return those who are on their way together with a robot; None if it is not."""
        body = self.bodies[robot]
        if body.work == NOBODY:
            return (robot,) if body.is_walking else None
        work = self.works[body.work]
        return work.robots if work.part == CARRYING else None

    def _rate(self, body: RealRobot, battery: Battery) -> float:
        """Return what a robot spends in a unit of time as it stands; less than 0 if it charges."""
        if body.is_lost:
            return 0.0
        if body.work != NOBODY and self.works[body.work].part != CARRYING:
            is_waiting = self.works[body.work].part in (FORMING, QUEUEING)
            return battery.waiting if is_waiting else battery.serving
        if body.is_walking:
            return 1.0
        if body.is_charging:
            return -battery.lasts / battery.fills if battery.fills else 0.0
        return 0.0 if body.task == NOBODY else battery.waiting

    def left_then(self, robot: int, moment: float) -> float:
        """Return what a robot has left at a moment if it goes on as it does until then."""
        body, battery = self.bodies[robot], self.truth.robots[robot].battery
        if battery is None:
            return math.inf
        if body.is_charging:
            return battery.lasts
        if body.work != NOBODY and self.truth.tasks[body.work].to is not None:
            return max(0.0, body.left - self._left_to_spend(body, battery))
        return max(0.0, body.left - self._spent(robot, battery, moment))

    def _left_to_spend(self, body: RealRobot, battery: Battery) -> float:
        """Return what the rest of a task with a load is believed to take a robot at work on it."""
        work, wanted = self.works[body.work], self.mission.tasks[body.work]
        begin, unload = body.left_at, wanted.unload
        if work.part == FORMING:
            return battery.waiting * (work.end - begin)
        if work.part == SERVING:
            carried = self.carried(body.work, work.robots)
            serves = work.expected - carried - unload - begin
            return battery.serving * (serves + unload) + carried
        if work.part == CARRYING:
            return work.expected - unload - begin + battery.serving * unload
        if work.part == QUEUEING:
            return battery.serving * unload
        return battery.serving * (work.expected - begin)

    def charging_now(self) -> tuple[tuple[int, float], ...]:
        """Return where somebody charges, and until when."""
        return tuple(
            (body.charger, self.events[body.charge].until or self.now)
            for body in self.bodies
            if body.is_charging
        )

    def stop_for(self, robot: int, task: int, goal: Place) -> int:
        """Return the charger that a robot goes to before a task or home; NOBODY if to none."""
        battery, wanted = self.mission.robots[robot].battery, self.mission.tasks
        if battery is None:
            return NOBODY
        at, here = self.next_place(robot)
        left = self.left_then(robot, at)
        if task == NOBODY:
            return self.charge_rules.stop(robot, here, left, goal)
        carried = longest_carry(self.mission, wanted[task], goal, self._time_of_way)
        spent, end = battery.spent_on(wanted[task], carried), wanted[task].to or goal
        return self.charge_rules.stop(
            robot, here, left, goal, self.charge_rules.wanted(robot, spent, end)
        )

    def charges_first(self, robot: int, task: int, goal: Place | None, cause: int) -> bool:
        """Say whether a robot goes to a charger before it goes on, and have it go there.

        Who is on its way, or queues, goes on with that for as long as it has the same task.
        """
        body = self.bodies[robot]
        if body.charger != NOBODY and body.charges_for == task and goal is not None:
            return True
        is_on_its_way = body.charger == NOBODY and body.task == task
        if goal is None or (is_on_its_way and body.way[-1].place == goal):
            charger = NOBODY
        else:
            charger = self.stop_for(robot, task, goal)
        if charger == NOBODY:
            self.leave_charger(robot)
            return False
        self.go_to_charger(robot, charger, task, cause)
        return True

    def go_to_charger(self, robot: int, charger: int, task: int, cause: int) -> None:
        """Have a robot go to a charger before it goes on to a task, or home."""
        body, place = self.bodies[robot], self.mission.chargers[charger].at
        if body.charger != charger:
            body.charger, body.at_charger = charger, math.inf
            self.set_out(robot, place, NOBODY, cause)
        body.task, body.charges_for = NOBODY, task
        self._queue(body)

    def leave_charger(self, robot: int) -> None:
        """Have a robot go to no charger, or charge no more."""
        body = self.bodies[robot]
        body.charger = body.charges_for = NOBODY
        body.charge = body.queue = NOBODY
        body.at_charger = math.inf

    def arrive(self, robot: int) -> None:
        """Let a robot be where it was going; at a charger it queues."""
        super().arrive(robot)
        self._queue(self.bodies[robot])

    def _queue(self, body: RealRobot) -> None:
        if body.charger == NOBODY or body.is_walking or math.isfinite(body.at_charger):
            return
        if body.way[0].place == self.mission.chargers[body.charger].at:
            body.at_charger = self.now

    def fill_chargers(self) -> None:
        """Let those charge that have waited longest, as far as there is room."""
        if not self._with_battery:
            return
        queue = [
            (body.at_charger, number)
            for number, body, _ in self._batteries()
            if math.isfinite(body.at_charger) and not body.is_charging
        ]
        taken = [body.charger for body in self.bodies if body.is_charging]
        for _, robot in sorted(queue):
            charger = self.bodies[robot].charger
            if taken.count(charger) < self.rooms[charger]:
                taken.append(charger)
                self._charge(robot)
            elif self.bodies[robot].queue == NOBODY:
                self._wait_for_room(robot)

    def _wait_for_room(self, robot: int) -> None:
        body = self.bodies[robot]
        cause = self.cause_among([body.since])
        body.since = body.queue = self.tell(
            "queue", (robot,), NOBODY, cause, place=body.way[0].place
        )

    def _charge(self, robot: int) -> None:
        body, battery = self.bodies[robot], self.truth.robots[robot].battery
        assert battery is not None
        end = self.now + battery.time_to_full(body.left)
        cause = self.cause_among([body.since, *self._freed(body.charger)])
        place = body.way[0].place
        number = self.tell("charge", (robot,), NOBODY, cause, place=place, until=end)
        body.since = body.charge = number
        self.put(end, FULL, robot, number)

    def _freed(self, charger: int) -> Iterator[int]:
        """Return the events of this moment with which a charger has room again."""
        place, number = self.mission.chargers[charger].at, len(self.events) - 1
        while number >= 0 and self.events[number].at == self.now:
            event = self.events[number]
            if event.kind in ("charged", "lost", "empty") and event.place == place:
                yield number
            number -= 1

    def be_full(self, robot: int) -> None:
        """Let a robot be done with charging."""
        body, battery = self.bodies[robot], self.truth.robots[robot].battery
        assert battery is not None
        place, begun = body.way[0].place, body.charge
        self.leave_charger(robot)
        body.left = battery.lasts
        body.since = self.tell("charged", (robot,), NOBODY, begun, place=place)
        self.note(robots=(robot,))

    def run_dry(self) -> None:
        """Let those stand still for good that have nothing left and would spend something."""
        for number, body, battery in self._batteries():
            if self.is_dry(number) and self._rate(body, battery) > 0:
                self.stand_still(number, "empty")

    def is_dry(self, robot: int) -> bool:
        """Say whether a robot has nothing left."""
        battery = self.truth.robots[robot].battery
        return battery is not None and self.bodies[robot].left < -ROUNDING * battery.lasts

    @abstractmethod
    def stand_still(self, robot: int, kind: str) -> None:
        """Let a robot be lost, or have run dry, as a kind of event says."""
