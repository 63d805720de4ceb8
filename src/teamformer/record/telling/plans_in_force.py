"""Which plans hold as a record goes on: the order, the plan and its exchanges."""

from __future__ import annotations

from bisect import bisect_left, insort
from collections import defaultdict
from collections.abc import Iterable, Sequence
from typing import TypeVar

from teamformer.record.record import Record, SharedPlanMade

Made = TypeVar("Made")


class PlansInForce:
    """What teams go by in the step reached.

    `made` says after which step the latest plan of any kind was made, 0 at the start.
    """

    def __init__(self) -> None:
        self.order: tuple[int, ...] = ()
        self.made = 0
        self.reasons: tuple[str, ...] = ()  # of the latest plan that is shared
        self.has_shared_plan = False
        self._places: dict[int, int] = {}  # of tasks in the order that are not over
        self._passed: list[int] = []  # the places of those that are over since, ascending
        self._coalitions: dict[int, tuple[int, ...]] = {}  # as the plan was made, by task
        self._tasks: defaultdict[int, list[int]] = defaultdict(list)  # the other way round
        self._played_by: dict[int, int] = {}  # who plays the part of a robot
        self._part_of: dict[int, int] = {}  # the other way round
        self._looks: dict[int, int] = {}  # which task a robot scouts

    def go_on(self, record: Record, made: int) -> bool:
        """Take in what was planned after a number of steps; say whether anything was."""
        orders, plans = _made_at(record.orders, made), _made_at(record.plans, made)
        if orders:
            self.order = orders[-1]
            self._places = {task: place for place, task in enumerate(self.order)}
            self._passed = []
        if orders or plans:
            self.made = made
        if plans:
            self.reasons = tuple(dict.fromkeys(why for plan in plans for why in plan.reasons))
            self._begin(plans[-1], dict(*_made_at(record.scouts, made)))
        return bool(orders or plans)

    def pass_over(self, tasks: Iterable[int]) -> None:
        """Take tasks that are over out of the order."""
        for task in self._places.keys() & tasks:
            insort(self._passed, self._places.pop(task))

    def rank(self, task: int) -> int | None:
        """Return how many open tasks come before one in the order; None if it is not in it."""
        place = self._places.get(task)
        return None if place is None else place - bisect_left(self._passed, place)

    def coalition(self, task: int) -> tuple[int, ...]:
        """Return who does a task by the shared plan; nobody if it is not in it."""
        return tuple(self._played_by[robot] for robot in self._coalitions.get(task, ()))

    def tasks_of(self, robot: int) -> Sequence[int]:
        """Return the tasks that the shared plan has for a robot, in the order when it was made."""
        return self._tasks.get(self._part_of.get(robot, robot), ())

    def scouts_of(self, task: int) -> set[int]:
        """Return who is to look first, by the shared plan, what a task needs or where it is."""
        return {robot for robot, looked_at in self._looks.items() if looked_at == task}

    def exchange(self, one: int, other: int) -> None:
        """Let two like robots exchange their parts of the plan."""
        parts, looks = self._part_of, self._looks
        parts[one], parts[other] = parts.get(other, other), parts.get(one, one)
        self._played_by[parts[one]], self._played_by[parts[other]] = one, other
        swapped = {one: looks.pop(other, None), other: looks.pop(one, None)}
        looks |= {robot: task for robot, task in swapped.items() if task is not None}

    def _begin(self, plan: SharedPlanMade, looks: dict[int, int]) -> None:
        self.has_shared_plan = True
        self._coalitions = dict(zip(self.order, plan.coalitions, strict=True))
        self._tasks = defaultdict(list)
        for task, coalition in self._coalitions.items():
            for robot in coalition:
                self._tasks[robot].append(task)
        self._played_by = {robot: robot for robot in self._tasks}
        self._part_of = dict(self._played_by)
        self._looks = looks


def _made_at(rows: Sequence[tuple[int, Made]], made: int) -> list[Made]:
    """Return what of some rows, which are in the order of time, was made after so many steps."""
    found = []
    for at, row in reversed(rows):
        if at < made:
            break
        if at == made:
            found.append(row)
    return found[::-1]
