"""When one robot goes to a charger, queues there, charges and goes on."""

from __future__ import annotations

import math
from collections.abc import Iterable

from teamformer.fleet.charging import next_place
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.messages import LONGEST, TaskFact, Terms, Word
from teamformer.mission.parts.grid import Place
from teamformer.world.rules.constants import NOBODY

LESS = 0.05
"""The share of a full battery by which one has to have less than believed to make news."""

NEVER = math.inf


class Recharge:
    """How full one robot's battery is, and at which charger it means to fill it."""

    def __init__(self, mission: FleetMission, me: int) -> None:
        self._mission, self._me = mission, me
        self._rules = mission.charging
        battery = None if self._rules is None else self._rules.batteries[me]
        self._battery = battery
        self.charge = 1.0 if self._rules is None else self._rules.starts(me)
        self.charger = NOBODY  # that it goes to, or is at
        self.since = NEVER  # the mission's age at which it was there
        self._target: tuple[int, Place] | None = None  # the task, or NOBODY, and where it is
        self._believed = (0.0, self.charge)  # what it has at least, since when it is believed

    def note(
        self, charge: float | None, age: float, moves: bool, is_at_task: bool, is_serving: bool
    ) -> bool:
        """Take in what a body tells of its battery; say whether that is less than believed.

        It has spent no more since it last told than one does that moves, waits or serves. With less
        it looks again, on its way too, whether it has to go to a charger.
        """
        if self._battery is None or charge is None:
            return False
        battery, (before, share) = self._battery, self._believed
        rates = moves * 1.0, is_at_task * battery.waiting, is_serving * battery.serving
        units = max(0.0, age - before) / self._mission.step
        share -= max(rates) * units / battery.lasts
        self.charge = charge
        is_less = charge < share - LESS
        if is_less and not self.is_away:
            self._target = None
        self._believed = age, charge if is_less else max(share, charge)
        return is_less

    @property
    def is_away(self) -> bool:
        """Say whether it is at a charger, or on its way there."""
        return self.charger != NOBODY

    def by_way_of(
        self, here: Place, goal: Place, task: TaskFact | None, is_last: bool, looks_again: bool
    ) -> Place:
        """Return where to go first to get to a goal, for a task or for none: a charger, if need be.

        Who goes to one for the same goal goes on with that until it is full. It `looks_again` at a
        task where it waits. `is_last` says that it goes nowhere after that.
        """
        if self._battery is None or self._rules is None:
            return goal
        target = (NOBODY if task is None else task.key, goal)
        is_same, is_full = target == self._target, self.charge >= 1.0
        if is_same and (not looks_again if self.charger == NOBODY else not is_full):
            return goal if self.charger == NOBODY else self._rules.chargers[self.charger]
        place, away = next_place(self._mission.source.world, here, self._mission.step)
        wanted = 0.0 if is_last else self._rules.onward(self._me, goal)
        if task is not None:
            wanted = self._rules.wanted(self._me, task, self._mission.step)
        left = self.charge - away / self._battery.lasts
        before, self._target = self.charger, target
        self.charger = self._rules.stop(self._me, place, left, goal, wanted)
        if self.charger != before or is_full:
            self.since = NEVER
        return goal if self.charger == NOBODY else self._rules.chargers[self.charger]

    def forget(self) -> None:
        """Go to no charger, as who is at work does, or has nowhere to go."""
        self.charger, self.since, self._target = NOBODY, NEVER, None

    def may_charge(self, here: Place, others: Iterable[Word], age: float) -> bool:
        """Say whether this robot is at its charger, and it is its turn: who came first is first."""
        if self._rules is None or self.charger == NOBODY:
            return False
        if not self._mission.is_same_place(*here, *self._rules.chargers[self.charger]):
            return False
        self.since = min(self.since, age)
        ahead = (
            terms
            for word in others
            if (terms := word.terms) is not None
            and terms.charger == self.charger
            and (terms.since, word.robot) < (self.since, self._me)
        )
        return sum(1 for _ in ahead) < self._rules.rooms[self.charger]

    def terms(self, plan: int) -> Terms:
        """Return what others have to know of it; `plan` is the digest of its plan."""
        return Terms(plan, self.charge, self.charger, min(self.since, LONGEST))
