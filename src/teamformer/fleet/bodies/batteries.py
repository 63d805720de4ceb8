"""Batteries of simulated bodies: they run down as robots walk and serve, and are charged.

Between two moments each changes evenly. Who came first to a charger charges first there.
"""

from __future__ import annotations

import math
from abc import abstractmethod

from teamformer.fleet.bodies.walking import NEVER, WalkingWorld
from teamformer.fleet.fleet_mission import FleetMission, place_in
from teamformer.mission.model import Mission
from teamformer.mission.parts.charging import Battery
from teamformer.world.continuous.events import Event
from teamformer.world.rules.constants import NOBODY

SAME = 1e-9
"""By such a share of a full battery sums are off."""

UNPLUGGED = "unplugged"
"""Stands for the kind of what lets a robot charge no more that is not full."""


class BatteryWorld(WalkingWorld):
    """What robots have left, in the mission's units; `now` goes on by `pass_to` only."""

    def __init__(self, mission: FleetMission, truth: Mission | None) -> None:
        super().__init__(mission, truth)
        robots = enumerate(mission.source.robots)
        self._batteries = {n: robot.battery for n, robot in robots if robot.battery is not None}
        self.left = {n: it.starts * it.lasts for n, it in self._batteries.items()}
        self._plugged: dict[int, tuple[float, int]] = {}  # since when robots want to charge, where
        self._charging: dict[int, float] = {}  # robots that charge, and when they are full

    def charge(self, robot: int) -> float | None:
        """Return how full the battery of a robot is, 0 to 1, to three places; None without one."""
        battery = self._batteries.get(robot)
        if battery is None:
            return None
        share = self.left[robot] / battery.lasts
        return max(0.0, math.floor(1000 * (share + SAME)) / 1000)

    @property
    def next_of_batteries(self) -> float:
        """Return when somebody is full, or runs dry; infinite if nobody ever is or does."""
        if not self._batteries:
            return NEVER
        dry = (self._dry_at(robot) for robot in self._batteries)
        return min((*self._charging.values(), *dry), default=NEVER)

    def pass_to(self, now: float, touched: set[int]) -> None:
        """Let time pass in which nothing happens but to batteries."""
        while self._batteries and (due := self.next_of_batteries) <= now:
            full = [robot for robot, until in self._charging.items() if until <= due]
            dry = [robot for robot in self._batteries if self._dry_at(robot) <= due]
            self._spend(max(due, self.now))
            for robot in full:
                self._be_full(robot, touched)
            for robot in dry:
                self._run_dry(robot, touched)
        self._spend(now)

    def _spend(self, now: float) -> None:
        """Let robots spend what they do until a moment."""
        for robot, battery in self._batteries.items():
            self.left[robot] = max(0.0, self.left[robot] - self._spent(robot, battery, now))
        self.now = now

    def _spent(self, robot: int, battery: Battery, now: float) -> float:
        """Return what a robot spends from now to a moment; less than 0 if it charges."""
        step, begin = self.mission.step, self.now
        if robot in self._charging:
            return -battery.lasts / battery.fills * (now - begin) / step if battery.fills else 0.0
        if who := self._walkers(robot):
            still = self._still if self.robots[robot].carries == NOBODY else self._still_with_load
            return still.walked(who, begin / step, now / step)
        rota = self.mission.source.robots[robot].rota
        return self._rate(robot, battery) * rota.worked(begin / step, now / step)

    def _dry_at(self, robot: int) -> float:
        """Return when a robot has nothing left if it goes on as it does; infinite for never."""
        battery, step, body = self._batteries[robot], self.mission.step, self.robots[robot]
        left, begin = self.left[robot] + SAME * battery.lasts, self.now / step
        if body.is_dry or robot in self._charging:
            return NEVER
        if who := self._walkers(robot):
            still = self._still if body.carries == NOBODY else self._still_with_load
            at = step * still.after(who, begin, left)
            return at if at <= body.journey.end else NEVER
        rate = self._rate(robot, battery)
        rota = self.mission.source.robots[robot].rota
        return step * rota.walked(begin, left / rate) if rate else NEVER

    def _walkers(self, robot: int) -> tuple[int, ...]:
        """Return those who are on their way together with a robot; nobody if it is not."""
        body = self.robots[robot]
        is_on_way = body.journey.end < NEVER and self.now < body.journey.end
        if body.is_dead or body.is_stuck or not is_on_way:
            return ()
        return (robot,) if body.carries == NOBODY else tuple(self.at_carry(body.carries))

    def _rate(self, robot: int, battery: Battery) -> float:
        """Return what a robot that stands spends in a unit of time."""
        key = self.robots[robot].command.task
        if self.robots[robot].is_dead or not self.is_at_task(robot, key):
            return 0.0
        return battery.serving if self.is_in_team(robot, key) else battery.waiting

    def drain(self, robot: int, share: float) -> None:
        """Let the battery of a robot lose a share of what it has left; who charges goes on."""
        battery = self._batteries[robot]
        self.left[robot] *= 1 - share
        if robot in self._charging:
            until = battery.time_to_full(self.left[robot]) * self.mission.step
            self._charging[robot] = self.now + until

    def plug(self, touched: set[int]) -> None:
        """Let those charge that want to and came first, as far as there is room."""
        if not self._batteries:
            return
        for robot in self._batteries:
            charger = self._charger_of(robot)
            if charger == NOBODY:
                self._plugged.pop(robot, None)
                if self._charging.pop(robot, None) is not None:
                    self._tell_charge(UNPLUGGED, robot)
            elif robot not in self._plugged:
                self._plugged[robot] = self.now, charger
        for robot, (_, charger) in sorted(self._plugged.items(), key=lambda one: (one[1], one[0])):
            busy = sum(self._plugged[other][1] == charger for other in self._charging)
            if robot not in self._charging and busy < self.mission.source.chargers[charger].room:
                self._begin_to_charge(robot, touched)

    def _charger_of(self, robot: int) -> int:
        """Return the charger at which a robot is told to charge and stands; NOBODY for none."""
        body, chargers = self.robots[robot], self.mission.source.chargers
        is_on_way = body.journey.end < NEVER and self.now < body.journey.end
        if body.is_dead or body.is_dry or is_on_way or not body.command.charge:
            return NOBODY
        here = self.place(robot)
        near = (n for n, it in enumerate(chargers) if self.mission.is_same_place(*here, *it.at))
        return next(near, NOBODY)

    def _begin_to_charge(self, robot: int, touched: set[int]) -> None:
        battery = self._batteries[robot]
        until = self.now + battery.time_to_full(self.left[robot]) * self.mission.step
        self._charging[robot] = until
        self._tell_charge("charge", robot, until)
        touched.add(robot)

    def _be_full(self, robot: int, touched: set[int]) -> None:
        del self._charging[robot]
        self.left[robot] = self._batteries[robot].lasts
        self._tell_charge("charged", robot)
        self._plugged.pop(robot, None)
        body = self.robots[robot]
        body.command = body.command._replace(charge=False)
        touched.add(robot)
        self.plug(touched)

    def _run_dry(self, robot: int, touched: set[int]) -> None:
        """Let a robot that has nothing left stand still for good."""
        self.left[robot], self.robots[robot].is_dry = 0.0, True
        touched |= self.hold_fast(robot)
        self._tell_charge("empty", robot)
        touched.add(robot)

    def _tell_charge(self, kind: str, robot: int, until: float | None = None) -> None:
        place = place_in(self._map, self.place(robot))
        self.moves.append(Event(self.now, kind, (robot,), place=place, until=until))

    @abstractmethod
    def at_carry(self, key: int) -> list[int]:
        """Return those who carry a load."""

    @abstractmethod
    def is_at_task(self, robot: int, key: int) -> bool:
        """Say whether a robot stands at a task that is not over."""

    @abstractmethod
    def is_in_team(self, robot: int, key: int) -> bool:
        """Say whether a robot is of the team that is at work on a task."""

    @abstractmethod
    def hold_fast(self, robot: int) -> set[int]:
        """Let a robot be unable to move."""
