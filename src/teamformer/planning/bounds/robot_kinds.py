"""Robots of one kind: what they bring to which tasks, and how long they take at least.

Times are counted so that no robot under the rules is faster. At a whole speed that is in steps,
from stop to stop. At others a robot may do a task in passing and keep what it has saved, less than
a cell: a leg takes its cells over the speed, not rounded up, and what is ready at a step may be
left up to a cell's time earlier. Where a cell takes whole steps that is still counted in steps,
else in the time of a cell, services rounded down.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from teamformer.base.array_types import Array
from teamformer.mission.model import Mission
from teamformer.planning.bounds.forming import steps_of_forming
from teamformer.planning.bounds.prize_routes import Stops, make_stops
from teamformer.planning.problem.relaxed_problem import Relaxed
from teamformer.world.rules.constants import FAR, ROUNDING


class Kind(NamedTuple):
    """Robots with the same capabilities, speed and loss, and where they can be of use."""

    sizes: Array  # (groups,) how many robots start alike
    place: Array  # (stops,) number of its place
    stops: Stops  # times in units
    first: Array  # (groups, stops) units that each takes to a stop if it is the first
    brings: Array  # (stops, needs) what one of them brings to each need by stopping
    units: float  # in a step
    last: int  # the last step that it is there in

    def with_memory(self, memory: int) -> Kind:
        """Return the kind with stops that remember so many places."""
        legs, ready, stay, home, *_ = self.stops
        return self._replace(stops=make_stops(legs, ready, stay, home, self.place, memory))

    def deadline(self, makespan: int) -> int:
        """Return by which time such a robot has to end a plan that takes so many steps."""
        return int(np.floor(self.units * min(makespan, self.last) + ROUNDING))


def robot_kinds(mission: Mission, problem: Relaxed, start: Array, needs: Array) -> list[Kind]:
    """Return all kinds of robots that some need has use for.

    `needs` (needs, 2) are pairs of task and capability; a stop at a task brings something to all
    needs in the same place whose service is no longer. No task starts before `start` (tasks,).
    """
    joining = joining_steps(mission, problem)
    kinds = (_kind(problem, start, joining, robots, needs) for robots in _alike(problem))
    return [kind for kind in kinds if kind is not None]


def size_of_kinds(problem: Relaxed) -> tuple[int, int]:
    """Return how many kinds of robots there are, and how many legs for all of them together."""
    first = [int(robots[0]) for robots in _alike(problem)]
    stops = ((problem.counts[first] > 0) @ (problem.needs > 0).T).sum(axis=1)  # (kinds,)
    return len(first), int((stops.astype(np.int64) ** 2).sum())


def joining_steps(mission: Mission, problem: Relaxed) -> Array:
    """Return the steps that robots form in before a task if it is their first, (tasks, robots).

    Who starts in a team that has less than a task needs joins at least once before it can start,
    in a step in which it does not walk. On planes, and where forming is free, that costs nothing.
    """
    steps = np.zeros((len(problem.appears), len(problem.pace)), np.int64)
    for team in map(list, mission.starting_teams):
        lacks = (problem.counts[team].sum(axis=0) < problem.needs).any(axis=1)  # (tasks,)
        steps[:, team] = steps_of_forming(mission) * lacks[:, None]
    return steps


def _alike(problem: Relaxed) -> list[Array]:
    """Return the robots of each kind."""
    kinds: dict[tuple[Any, ...], list[int]] = {}
    for robot, counts in enumerate(problem.counts):
        traits = (int(problem.pace[robot]), int(problem.lost[robot]), counts.tobytes())
        kinds.setdefault(traits, []).append(robot)
    return [np.array(robots) for robots in kinds.values()]


def _kind(
    problem: Relaxed, start: Array, joining: Array, robots: Array, needs: Array
) -> Kind | None:
    one, (task_of, cap_of) = int(robots[0]), needs.T
    tasks = np.unique(task_of[problem.counts[one, cap_of] > 0])  # (stops,)
    if len(tasks) == 0:
        return None
    units, credit, ways = _ways(problem, one, np.concatenate([tasks, len(start) + robots]), tasks)
    legs, first = ways[: len(tasks)], ways[len(tasks) :]
    first = first + _whole_units(units, joining[np.ix_(tasks, robots)]).T
    ready = np.maximum(_whole_units(units, start[tasks]) - credit, 0)
    stay = _whole_units(units, problem.duration[tasks])
    is_same = problem.cells[np.ix_(tasks, tasks)] == 0  # (stops, stops)
    place = is_same.argmax(axis=1)  # (stops,) the first of those in the same place
    brings = _brought(problem, one, tasks, is_same, needs)
    legs, home = np.where(is_same, FAR, legs), np.zeros(len(tasks), np.int64)
    stops = make_stops(legs, ready, stay, home, place, memory=0)
    first, sizes = np.unique(first, axis=0, return_counts=True)
    return Kind(sizes, place, stops, first, brings, units, int(problem.lost[one]) - 1)


def _ways(problem: Relaxed, robot: int, places: Array, tasks: Array) -> tuple[float, int, Array]:
    """Return units in a step, those a robot may have saved, and its ways, (places, tasks)."""
    speed, cells = float(problem.speed[robot]), problem.cells[np.ix_(tasks, places)].T
    steps = problem.steps[problem.pace[robot], cells].astype(np.int64)  # (places, tasks)
    if speed % 1 == 0:
        return 1.0, 0, steps
    if (1 / speed) % 1 == 0:
        return 1.0, round(1 / speed), steps
    speeds = len(problem.steps) // len(problem.lengths)
    lengths = problem.lengths[int(problem.pace[robot]) // speeds]
    return speed, 1, np.where(steps < FAR, lengths[cells], FAR)


def _whole_units(units: float, steps: Array) -> Array:
    """Return no more units than steps have."""
    whole: Array = np.floor(units * steps + ROUNDING).astype(np.int64)
    return whole


def _brought(problem: Relaxed, robot: int, tasks: Array, is_same: Array, needs: Array) -> Array:
    """Return what a robot brings to each need by a stop at each task, as (stops, needs)."""
    task_of, cap_of = needs.T
    brought = np.minimum(problem.counts[robot, cap_of], problem.needs[task_of, cap_of])  # (needs,)
    of_use = np.flatnonzero(brought)
    at = np.searchsorted(tasks, task_of[of_use])  # (of_use,) the stop of its task
    is_over = problem.duration[task_of[of_use]] <= problem.duration[tasks][:, None]
    brings = np.zeros((len(tasks), len(needs)), np.int64)
    brings[:, of_use] = np.where(is_same[:, at] & is_over, brought[of_use], 0)
    return brings
