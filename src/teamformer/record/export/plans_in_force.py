"""Which plans hold as a record goes on: the order, the plan and its exchanges."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable
from collections.abc import Set as AbstractSet
from typing import TypeVar

from teamformer.record.record import Record, SharedPlanMade

Made = TypeVar("Made")


class PlansInForce:
    """Goes through a record once, step by step; it holds what teams go by in the step reached.

    `made` says after which step the latest plan of any kind was made, 0 at the start.
    """

    def __init__(self, record: Record) -> None:
        self.order: tuple[int, ...] = ()
        self.made = 0
        self.is_taken_over = False
        self.has_shared_plan = False
        self._steps = record.steps
        self._orders, self._plans = _by_step(record.orders), _by_step(record.plans)
        self._scouts = dict(record.scouts)
        self._coalitions: dict[int, tuple[int, ...]] = {}  # as the plan was made, by task
        self._played_by: dict[int, int] = {}  # who plays the part of a robot
        self._part_of: dict[int, int] = {}  # the other way round
        self._looks: dict[int, int] = {}  # which task a robot scouts

    def go_on(self, number: int) -> None:
        """Go on to a step, from the one before."""
        made = number - 1
        if made > 0:
            for pair in self._steps[made - 1].took:
                self._exchange(*pair)
        orders, plans = self._orders.get(made, ()), self._plans.get(made, ())
        if orders or plans:
            self.made = made
            self.is_taken_over = any("taken over" in plan.reasons for plan in plans)
        self.order = orders[-1] if orders else self.order
        if plans:
            self._begin(plans[-1], made)

    def coalition(self, task: int) -> tuple[int, ...]:
        """Return who does a task by the shared plan; nobody if it is not in it."""
        return tuple(self._played_by[robot] for robot in self._coalitions.get(task, ()))

    def tasks_shared_out(self) -> AbstractSet[int]:
        """Return the tasks that the shared plan was made for."""
        return self._coalitions.keys()

    def scouts_of(self, task: int) -> set[int]:
        """Return who is to look first, by the shared plan, what a task needs or where it is."""
        return {robot for robot, looked_at in self._looks.items() if looked_at == task}

    def _begin(self, plan: SharedPlanMade, made: int) -> None:
        self.has_shared_plan = True
        self._coalitions = dict(zip(self.order, plan.coalitions, strict=True))
        self._played_by = {robot: robot for part in plan.coalitions for robot in part}
        self._part_of = dict(self._played_by)
        self._looks = dict(self._scouts.get(made, ()))

    def _exchange(self, one: int, other: int) -> None:
        """Let two like robots exchange their parts of the plan."""
        parts, looks = self._part_of, self._looks
        parts[one], parts[other] = parts.get(other, other), parts.get(one, one)
        self._played_by[parts[one]], self._played_by[parts[other]] = one, other
        swapped = {one: looks.pop(other, None), other: looks.pop(one, None)}
        looks |= {robot: task for robot, task in swapped.items() if task is not None}


def _by_step(rows: Iterable[tuple[int, Made]]) -> dict[int, list[Made]]:
    found: defaultdict[int, list[Made]] = defaultdict(list)
    for made, row in rows:
        found[made].append(row)
    return found
