"""What a vehicle does at a task: an action where it is, or an order if the task has a load."""

from __future__ import annotations

import math
from typing import NamedTuple

from teamformer.fleet.bodies.vda5050.orders import Action, OrderStop, action_of
from teamformer.fleet.messages import TaskFact
from teamformer.mission.parts.grid import Place

SERVE = "serve"
"""The action that a vehicle must know; its parameters are `task`, `team` and `duration`."""

PICK, DROP, SET_DOWN = "pick", "drop", "set-down"
"""The standard's actions for loads, whose parameters are `task`, `team` and `duration` too, and how
the names of orders end that have a load dropped on its way."""

NEAR = 0.3
"""Metres from its goal at which a vehicle that has nothing more to drive is there."""


class ServiceTry(NamedTuple):
    """One try of a task, under names that no other try has.

    `name` is that of its action, or of its order; `drop` and `set_down` are the newest actions that
    are to rid the vehicle of the load, where that is to be brought or where the vehicle is.
    """

    name: str
    task: TaskFact | None  # None: an operator's
    key: int
    team: int
    drop: str
    set_down: str

    @property
    def load(self) -> TaskFact | None:
        """Return the task if it has a load."""
        return None if self.task is None or self.task.to is None else self.task

    @property
    def begins(self) -> str:
        """Return the name of its first action."""
        return self.name if self.load is None else f"{self.name}-{PICK}"

    @property
    def words(self) -> str:
        """Return what is to be done first, for people."""
        return f"{SERVE if self.load is None else PICK} {self._task}"

    @property
    def drop_words(self) -> str:
        """Return what is to be done where the load is to be brought, for people."""
        return f"{DROP} {self._task}"

    @property
    def set_down_words(self) -> str:
        """Return what is to be done with the load on the way, for people."""
        return f"set down {self._task}"

    @property
    def has_kept_it(self) -> bool:
        """Say whether the drop of its order has failed."""
        return self.drop != f"{self.name}-{DROP}"

    @property
    def _task(self) -> str:
        return str(self.key) if self.task is None else self.task.name

    def serve(self, blocking: str) -> Action:
        """Return the action to serve a task without a load."""
        lasts = 0.0 if self.task is None else self.task.duration
        return self._action(SERVE, self.name, lasts, blocking)

    def bring(self, at: Place) -> list[OrderStop]:
        """Return an order to pick the load where the vehicle is, and to drop it at its goal."""
        load, goal = self._load_and_goal()
        pick = self._action(PICK, self.begins, load.duration)
        return [
            OrderStop(at, [pick]),
            OrderStop(goal, [self._action(DROP, self.drop, load.unload)]),
        ]

    def bring_on(self, at: Place) -> list[OrderStop]:
        """Return an order to drop what the vehicle has failed to drop."""
        load, goal = self._load_and_goal()
        drop = self._action(DROP, self.drop, load.unload)
        is_there = math.dist(at, goal) <= NEAR
        return [OrderStop(at, [drop])] if is_there else [OrderStop(at), OrderStop(goal, [drop])]

    def put_down(self, at: Place) -> list[OrderStop]:
        """Return an order to drop the load where the vehicle is."""
        return [OrderStop(at, [self._action(DROP, self.set_down, 0.0)])]

    def _load_and_goal(self) -> tuple[TaskFact, Place]:
        assert self.task is not None
        assert self.task.to is not None
        return self.task, self.task.to

    def _action(self, kind: str, name: str, lasts: float, blocking: str = "HARD") -> Action:
        parameters = {"task": self._task, "team": self.team, "duration": lasts}
        return action_of(kind, name, parameters, blocking)


def begin(name: str, task: TaskFact | None, key: int, team: int) -> ServiceTry:
    """Return a new try of a task."""
    return ServiceTry(name, task, key, team, f"{name}-{DROP}", f"{name}-{SET_DOWN}")
