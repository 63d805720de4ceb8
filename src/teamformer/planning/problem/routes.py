"""What a plan tells people: where each robot goes, and when, in the mission's own unit of time."""

from __future__ import annotations

from dataclasses import dataclass


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
        """Return the tasks in the order in which they begin."""
        begins = {stop.task: stop.start for route in self.routes for stop in route.stops}
        return tuple(sorted(begins, key=lambda task: (begins[task], task)))

    @property
    def coalitions(self) -> tuple[tuple[int, ...], ...]:
        """Return the robots that do each task together, in the same order."""
        robots: dict[int, list[int]] = {}
        for route in self.routes:
            for stop in route.stops:
                robots.setdefault(stop.task, []).append(route.robot)
        return tuple(tuple(sorted(robots[task])) for task in self.order)
