"""What a plan tells people: where each robot goes, and when, in the mission's own unit of time."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

from teamformer.mission.precedence import keep_precedence


@dataclass(frozen=True)
class Stop:
    """A task that a robot takes part in: when it is there, when work begins and when it ends."""

    task: int
    arrive: float
    start: float
    end: float


@dataclass(frozen=True)
class Route:
    """Where a robot goes, and when it is back: 0 if it stays, its last end if it need not be."""

    robot: int
    stops: tuple[Stop, ...]
    back: float


@dataclass(frozen=True)
class MissionPlan:
    """A plan of a mission with its times.

    No plan is over before `bound`, none costs less than `least_cost`; `is_proven` says that none
    is better than this one. `late` holds by how much tasks end too late.
    """

    makespan: float
    bound: float
    is_proven: bool
    routes: tuple[Route, ...]
    late: dict[int, float]
    curve: tuple[tuple[float, float], ...] = ()  # (seconds, makespan or cost) of each improvement
    cost: float | None = None  # of a mission that has one
    missed: tuple[int, ...] = ()  # tasks that are left out
    least_cost: float | None = None

    @property
    def order(self) -> tuple[int, ...]:
        """Return the tasks in the order in which they begin; see `order_of_starts`."""
        stops = [(route.robot, stop) for route in self.routes for stop in route.stops]
        begins = {stop.task: stop.start for _, stop in stops}
        instant = {stop.task for _, stop in stops if stop.end == stop.start}
        rows = [(robot, stop.task) for robot, stop in stops]
        return tuple(order_of_starts(rows, begins, instant=instant))

    @property
    def coalitions(self) -> tuple[tuple[int, ...], ...]:
        """Return the robots that do each task together, in the same order."""
        robots: dict[int, list[int]] = {}
        for route in self.routes:
            for stop in route.stops:
                robots.setdefault(stop.task, []).append(route.robot)
        return tuple(tuple(sorted(robots[task])) for task in self.order)


def order_of_starts(
    stops: Sequence[tuple[int, int]],
    start: Mapping[int, float],
    before: Mapping[int, Sequence[int]] | None = None,
    instant: Collection[int] = (),
) -> list[int]:
    """Return tasks in the order of their starts; what starts at one moment is as in the routes.

    `stops` has each robot's tasks, as pairs of robot and task, in the order of its route. Routes
    that contradict one another, or the tasks that come `before` each, do not count. Those that are
    `instant` take no time: they come before others that start then, as they leave zones at once.
    """
    order = sorted(start, key=lambda task: (start[task], task not in instant, task))
    before = before or {}
    as_routes = {task: list(before.get(task, ())) for task in order}
    for (robot, task), (other_robot, next_one) in pairwise(stops):
        if robot == other_robot and start[task] == start[next_one] and task != next_one:
            as_routes[next_one].append(task)
    kept = keep_precedence(order, as_routes)
    return kept if len(kept) == len(order) else keep_precedence(order, before)
