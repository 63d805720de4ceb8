"""Room in zones as permits: robots without a body, which a task needs beside those that do it.

A zone with room for two has two permits. They come from one task to the next in no time, and are at
home where they are. So a search that knows nothing of zones plans with them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from teamformer.base.array_types import Floats, Int32s
from teamformer.base.kernels.jit import kernel
from teamformer.planning.problem.coalition_plan import CoalitionPlan
from teamformer.planning.problem.coalition_problem import CoalitionProblem
from teamformer.world.rules.starts import RoomLeft


class Permits(NamedTuple):
    """The permits of all zones, one after the other."""

    counts: Int32s  # (permits, zones) each is of one zone
    needs: Int32s  # (tasks, zones)
    free: Floats  # (permits,) when each can be used first

    @property
    def number(self) -> int:
        """Return how many there are."""
        return len(self.free)


def no_permits(tasks: int) -> Permits:
    """Return the permits of so many tasks where there are no zones."""
    return permits_of((), tasks, 0.0)


@kernel
def are_zoned(permits: Permits) -> bool:
    """Say whether there are any permits."""
    return len(permits.free) > 0


def that_bind(permits: Permits, now: float) -> Permits:
    """Return the permits of those zones that have less room than tasks, or where some is taken."""
    owner = permits.counts.argmax(axis=1) if permits.number else np.zeros(0, np.int64)
    is_taken = np.bincount(owner, permits.free > now, permits.counts.shape[1]) > 0
    kept = np.flatnonzero(is_taken | (permits.counts.sum(axis=0) < permits.needs.sum(axis=0)))
    rows = np.isin(owner, kept)
    counts, needs = permits.counts[rows][:, kept], permits.needs[:, kept]
    return Permits(counts, np.ascontiguousarray(needs), permits.free[rows])


def permits_of(rooms: Sequence[RoomLeft], tasks: int, now: float) -> Permits:
    """Return the permits of some rooms at a moment; what is taken there is free once that ends."""
    free = [_free_at(room, now) for room in rooms]
    counts = np.zeros((sum(map(len, free)), len(rooms)), np.int32)
    counts[np.arange(len(counts)), np.repeat(np.arange(len(rooms)), list(map(len, free)))] = 1
    needs = np.zeros((tasks, len(rooms)), np.int32)
    for zone, room in enumerate(rooms):
        needs[sorted(room.tasks), zone] = 1
    return Permits(counts, needs, np.array([at for own in free for at in own], np.float64))


def _free_at(room: RoomLeft, now: float) -> list[float]:
    """Return when each permit of a zone is free, of as many as its tasks can ever use."""
    taken = sorted(room.taken)[-room.room :]
    free = [*[now] * (room.room - len(taken)), *(max(now, until) for until in taken)]
    return free[: len(room.tasks)]


def block(robots: Int32s, permits: Int32s) -> Int32s:
    """Return two tables as one, (robots and permits, caps and zones)."""
    table = np.zeros(np.add(robots.shape, permits.shape), np.int32)
    table[: len(robots), : robots.shape[1]] = robots
    table[len(robots) :, robots.shape[1] :] = permits
    return table


def deal_permits(problem: CoalitionProblem, plan: CoalitionPlan, ends: Mapping[int, float]) -> None:
    """Add permits to the coalitions of a plan, in its order: those that are free first.

    `ends` says in ticks when its tasks end.
    """
    permits = range(problem.bodies, len(problem.counts))
    ready = problem.ready[problem.origin - len(problem.needs)].tolist()
    for task in plan.order.tolist() if permits else ():
        for cap in np.flatnonzero(problem.needs[task] * (plan.size[task] > 0)):
            own = [permit for permit in permits if problem.counts[permit, cap] > 0]
            if own:
                first = min(own, key=lambda permit: (ready[permit], permit))
                ready[first] = ends[task]
                plan.coalition[task, plan.size[task]] = first
                plan.size[task] += 1


def rooms_of_permits(problem: CoalitionProblem) -> list[RoomLeft]:
    """Return the rooms that the permits of a problem are, in its ticks."""
    permits = problem.counts[problem.bodies :]
    ready = problem.ready[problem.origin[problem.bodies :] - len(problem.needs)]
    return [
        RoomLeft(
            frozenset(np.flatnonzero(problem.needs[:, zone]).tolist()),
            int(permits[:, zone].sum()),
            tuple(ready[permits[:, zone] > 0].tolist()),
        )
        for zone in np.flatnonzero(permits.any(axis=0))
    ]


def of_robots(problem: CoalitionProblem) -> tuple[Int32s, Int32s]:
    """Return what robots bring, (robots, caps), and what tasks need of them, (tasks, caps)."""
    counts, needs = problem.counts[: problem.bodies], problem.needs
    is_brought = ~problem.counts[problem.bodies :].any(axis=0)
    return counts[:, is_brought], needs[:, is_brought]


def without_permits(problem: CoalitionProblem, plan: CoalitionPlan) -> CoalitionPlan:
    """Return a plan as it is for robots."""
    if problem.bodies == len(problem.counts):
        return plan
    bare = CoalitionPlan(plan.order, plan.coalition.copy(), plan.size.copy())
    for task, size in enumerate(plan.size.tolist()):
        crew = [r for r in plan.coalition[task, :size].tolist() if r < problem.bodies]
        bare.size[task], bare.coalition[task, : len(crew)] = len(crew), crew
    return bare
