"""When a rehearsed mission is over: what is left to do, and what of it nobody can do any more."""

from __future__ import annotations

from collections.abc import Sequence, Set

from teamformer.fleet.bodies.world import FleetWorld
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.messages import TaskFact
from teamformer.fleet.operator import Operator
from teamformer.fleet.rehearsal.faults import Faults


class EndingWatch:
    """Looks at what is true, which no robot knows: who is lost for good, what is done."""

    def __init__(
        self,
        mission: FleetMission,
        faults: Faults,
        world: FleetWorld,
        operators: Sequence[Operator],
    ) -> None:
        self._mission, self._faults, self._world = mission, faults, world
        self._operators = operators
        self._stuck = {spell.robot for spell in faults.stuck if spell.end is None}

    def left(self, now: float, held: Set[int]) -> list[TaskFact] | None:
        """Return what cannot be done any more if all else is done; None while it is not.

        `held` are the operators' tasks that somebody knows still.
        """
        able = self._able()
        waiting = [operator for operator in self._operators if not operator.is_accepted]
        if any(len(able) >= operator.needed for operator in waiting):
            return None
        unheard = {operator.task.key for operator in waiting}
        impossible = self.impossible(now, held)
        excused = unheard | {task.key for task in impossible}
        is_over = all(key in excused for key in self._world.tasks if key not in self._world.done)
        return impossible if is_over else None

    def impossible(self, now: float, held: Set[int]) -> list[TaskFact]:
        """Return the tasks that are not done, and that the robots left cannot do or know."""
        able, lost = self._able(), self._lost_orders(now, held)
        return [
            task
            for key, task in self._world.tasks.items()
            if key not in self._world.done and (key in lost or not self._mission.can_do(able, task))
        ]

    def _able(self) -> list[int]:
        """Return the robots that are, or will be, able to work."""
        robots = enumerate(self._world.robots)
        return [r for r, body in robots if not body.is_dead and r not in self._stuck]

    def _lost_orders(self, now: float, held: Set[int]) -> set[int]:
        """Return the accepted tasks that all who held them have lost with their memory.

        Where somebody was told since, such a task has to be done all the same.
        """
        forgetful = {
            crash.robot: crash.at
            for crash in self._faults.crashes
            if crash.at <= now and (crash.back is None or not crash.keeps_facts)
        }
        return {
            operator.task.key
            for operator, order in zip(self._operators, self._faults.orders, strict=True)
            if operator.is_accepted
            and operator.task.key not in held
            and all(forgetful.get(robot, -1.0) >= order.at for robot in operator.holders)
        }
