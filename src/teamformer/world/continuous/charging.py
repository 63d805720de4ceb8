"""Batteries that run down and are charged; robots that queue at chargers, and that run dry."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Iterator

from teamformer.mission.model import Mission
from teamformer.mission.parts.charging import ROUNDING, Battery
from teamformer.mission.parts.grid import Place
from teamformer.world.continuous.body import FORMING, RealRobot
from teamformer.world.continuous.moving import FULL
from teamformer.world.continuous.working import WorkingWorld
from teamformer.world.rules.charging.stops import ChargeRules
from teamformer.world.rules.constants import NOBODY

DRY = 2 * ROUNDING
"""A robot runs dry that lacks such a share of a full battery: sums are rounded."""


class ChargingWorld(WorkingWorld):
    """What robots have left; between two moments each spends as it does since the former one."""

    def __init__(self, mission: Mission, truth: Mission, is_all_known: bool) -> None:
        super().__init__(mission, truth, is_all_known)
        self.rooms = [charger.room for charger in mission.chargers]
        self.charge_rules = ChargeRules(
            [robot.battery for robot in mission.robots],
            [charger.at for charger in mission.chargers],
            self.rooms,
            self._time_of_way,
        )
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
        due = self.next_due
        for _, body, battery in self._batteries():
            if (rate := self._rate(body, battery)) > 0:
                lasts = (body.left + DRY * battery.lasts) / rate
                due = min(due, max(self.now, body.left_at + lasts))
        return due

    @property
    def is_busy(self) -> bool:
        """Say whether somebody is on the way, charges, forms or is at work."""
        return super().is_busy or any(body.is_charging for body in self.bodies)

    def be_at(self, moment: float) -> None:
        """Let time pass until a moment at which nothing is due before it."""
        self.now = moment
        for _, body, battery in self._batteries():
            spent = self._rate(body, battery) * (moment - body.left_at)
            body.left, body.left_at = min(battery.lasts, body.left - spent), moment

    def _rate(self, body: RealRobot, battery: Battery) -> float:
        """Return what a robot spends in a unit of time as it stands; less than 0 if it charges."""
        if body.is_lost:
            return 0.0
        if body.work != NOBODY:
            is_forming = self.works[body.work].part == FORMING
            return battery.waiting if is_forming else battery.serving
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
        return max(0.0, body.left - self._rate(body, battery) * (moment - body.left_at))

    def charging_now(self) -> tuple[tuple[int, float], ...]:
        """Return where somebody charges, and until when."""
        return tuple(
            (body.charger, self.events[body.since].until or self.now)
            for body in self.bodies
            if body.is_charging
        )

    def stop_for(self, robot: int, task: int, goal: Place) -> int:
        """Return the charger that a robot goes to before a task or home; NOBODY if to none."""
        battery, wanted = self.mission.robots[robot].battery, self.mission.tasks
        if battery is None:
            return NOBODY
        at, here = self.next_place(robot)
        spent = None if task == NOBODY else battery.spent_on(wanted[task])
        return self.charge_rules.stop(robot, here, self.left_then(robot, at), goal, spent)

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
        body.is_charging, body.at_charger = False, math.inf

    def arrive(self, robot: int) -> None:
        """Let a robot be where it was going; at a charger it queues."""
        super().arrive(robot)
        self._queue(self.bodies[robot])

    def _queue(self, body: RealRobot) -> None:
        if body.charger != NOBODY and not body.is_walking and math.isinf(body.at_charger):
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

    def _charge(self, robot: int) -> None:
        body, battery = self.bodies[robot], self.truth.robots[robot].battery
        assert battery is not None
        end = self.now + battery.time_to_full(body.left)
        body.is_charging = True
        cause = self.cause_among([body.since, *self._freed(body.charger)])
        place = body.way[0].place
        body.since = self.tell("charge", (robot,), NOBODY, cause, place=place, until=end)
        self.put(end, FULL, robot, body.since)

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
        place = body.way[0].place
        self.leave_charger(robot)
        body.left = battery.lasts
        body.since = self.tell("charged", (robot,), NOBODY, body.since, place=place)
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
