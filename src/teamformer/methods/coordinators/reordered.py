"""Another search for a plan: that of a coordinator, with robots and tasks in another order."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

from teamformer.mission.coordination import Coordinator, Known, Plan, heeded_by
from teamformer.mission.orders import WritingOrder, draw_order, in_order


@dataclass(frozen=True)
class Reordered:
    """Asks a coordinator about the same mission, written in another order.

    So it tells how much plans differ by luck of the search alone.
    """

    coordinator: Coordinator
    order: int

    @property
    def heeds(self) -> tuple[str, ...]:
        """Return what the coordinator heeds."""
        return heeded_by(self.coordinator)

    def update(self, known: Known, plan: Plan | None) -> Plan:
        """Return a plan of the coordinator in the numbers of the mission."""
        there = draw_order(known.mission, self.order)
        back = WritingOrder(_inverse(there.robots), _inverse(there.tasks))
        old = None if plan is None else _renumbered(plan, back)
        return _renumbered(self.coordinator.update(_reordered(known, self.order), old), there)


def _reordered(known: Known, number: int) -> Known:
    """Return the same knowledge of a mission that is written in another order."""
    order = draw_order(known.mission, number)
    robot, task = _inverse(order.robots), _inverse(order.tasks)
    return replace(
        known,
        mission=in_order(known.mission, number),
        open_tasks=tuple(sorted(task[k] for k in known.open_tasks)),
        places=tuple(known.places[r] for r in order.robots),
        teams=tuple(sorted(tuple(sorted(robot[r] for r in team)) for team in known.teams)),
        free_at=tuple(known.free_at[r] for r in order.robots),
        came_from=tuple(known.came_from[r] for r in order.robots if known.came_from),
        started={task[k]: start for k, start in known.started.items()},
        over=frozenset(task[k] for k in known.over),
        under_way=tuple(sorted((task[k], end) for k, end in known.under_way)),
        unseen_needs=frozenset(task[k] for k in known.unseen_needs),
        unseen_places=frozenset(task[k] for k in known.unseen_places),
        left=tuple(known.left[r] for r in order.robots if known.left),
        loading={task[k]: until for k, until in known.loading.items()},
        unloading=frozenset(task[k] for k in known.unloading),
    )


def _renumbered(plan: Plan, numbers: WritingOrder) -> Plan:
    """Return a plan with other numbers for its robots and tasks."""
    robot, task = numbers

    def renamed(robots: Iterable[int]) -> tuple[int, ...]:
        return tuple(sorted(robot[r] for r in robots))

    return replace(
        plan,
        order=tuple(task[k] for k in plan.order),
        coalitions=tuple(renamed(robots) for robots in plan.coalitions),
        scouts=tuple((robot[r], task[k]) for r, k in plan.scouts),
    )


def _inverse(numbers: list[int]) -> list[int]:
    """Return at which place each number stands."""
    places = [0] * len(numbers)
    for place, number in enumerate(numbers):
        places[number] = place
    return places
