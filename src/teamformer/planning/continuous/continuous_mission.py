"""A mission in continuous time as a coalition problem, and plans of it in the mission's unit."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from teamformer.errors import TeamformerError
from teamformer.grid import Grid, Place
from teamformer.mission.links import is_linked
from teamformer.mission.rules import HOME as ENDS_HOME
from teamformer.model import Scenario
from teamformer.planning.continuous.linked.problem import (
    COMPLETION,
    HOME,
    MAKESPAN,
    MAX_TARDINESS,
    PARTS,
    TARDINESS,
    TRAVEL,
    Link,
    LinkedProblem,
    link_problem,
)
from teamformer.planning.continuous.linked.solve import LinkedSolution
from teamformer.planning.continuous.problem import NEVER, CoalitionProblem, pose_problem
from teamformer.planning.continuous.routes import MissionPlan
from teamformer.planning.continuous.schedule import LATENESS, SPREAD, CoalitionPlan
from teamformer.planning.continuous.solve import Solution
from teamformer.planning.continuous.times import Clock, release_of, time_mission
from teamformer.planning.relaxation.problem import count_table
from teamformer.rules.distances import UNREACHABLE, straight_ways, travel_matrix

Times = npt.NDArray[np.float64]

MOST_TICKS = 2 * 10**9
"""About how many ticks everything takes at most, one task after the other."""

NO_WAY = 1000
"""Where no way is, it takes this many times longer than everything."""


@dataclass(frozen=True)
class ContinuousMission:
    """A mission's times as they are, and in ticks, of which there are `scale` in a unit."""

    scenario: Scenario
    ways: Times  # (paces, places, tasks) from places, which are tasks and starts, to tasks
    home: Times  # (robots, places)
    origin: npt.NDArray[np.int64]  # (robots,) the place where each starts
    pace: npt.NDArray[np.int64]  # (robots,) row of `ways`
    scale: float
    problem: CoalitionProblem | LinkedProblem

    def tell(self, solution: Solution | LinkedSolution) -> MissionPlan:
        """Return a solution in the mission's unit; its times are worked out from the true ways.

        In ticks every way and duration is rounded, by half a tick at most; the bound allows for it.
        """
        timed = self.time(solution.plan)
        if isinstance(solution, LinkedSolution):
            return replace(timed, curve=self._weighed(solution.curve))
        rounding = len(self.scenario.tasks) + 2  # ways and durations in a chain, half a tick each
        bound = max(0.0, (solution.bound - rounding) / self.scale)
        return replace(
            timed,
            bound=min(timed.makespan, bound),
            is_proven=solution.is_proven,
            curve=tuple((seconds, ticks / self.scale) for seconds, ticks in solution.curve),
        )

    def _weighed(self, curve: tuple[tuple[float, float], ...]) -> tuple[tuple[float, float], ...]:
        """Return the curve of a linked problem in units; without a cost it is none of times."""
        if self.scenario.cost is None:
            return ()
        return tuple((seconds, cost / self.scale) for seconds, cost in curve)

    def time(self, plan: CoalitionPlan) -> MissionPlan:
        """Return a plan with its times by the mission's rules."""
        problem = self.problem
        base = problem.base if isinstance(problem, LinkedProblem) else problem
        clock = Clock(self.scenario, self.ways, self.pace, self.origin, base.site)
        return time_mission(self.scenario, clock, self.home, plan)


def pose_mission(scenario: Scenario) -> ContinuousMission:
    """Return a mission in continuous time as a problem in ticks."""
    robots, tasks = scenario.robots, scenario.tasks
    starts = list(dict.fromkeys(robot.at for robot in robots))
    places = [*(task.at for task in tasks), *starts]
    kinds, pace = np.unique(
        [(robot.flies, robot.speed) for robot in robots], axis=0, return_inverse=True
    )
    pace = pace.ravel()
    movers = sorted({robot.flies for robot in robots})
    between = {flies: _distances(scenario, places, places, flies) for flies in movers}
    ways = np.stack([between[bool(flies)][:, : len(tasks)] / speed for flies, speed in kinds])
    home = _ways_home(scenario, places, between, starts)
    scale = _scale(scenario, ways, home)
    number_of = {task.name: number for number, task in enumerate(tasks)}
    origin = np.array([len(tasks) + starts.index(robot.at) for robot in robots])
    problem = pose_problem(
        ways=_ticks(ways, scale),
        home=_ticks(home, scale),
        pace=pace,
        origin=origin,
        counts=count_table([robot.can for robot in robots], scenario),
        needs=count_table([task.needs for task in tasks], scenario),
        duration=_ticks([task.duration for task in tasks], scale),
        release=_ticks([release_of(scenario, task) for task in range(len(tasks))], scale),
        due=[NEVER if task.between is None else round(task.between[1] * scale) for task in tasks],
        precedence=[
            (number_of[name], number) for number, task in enumerate(tasks) for name in task.after
        ],
        forming=round(scenario.forming * scale),
        site=np.unique(np.array(places, np.float64), axis=0, return_inverse=True)[1].ravel(),
    )
    linked = _link(scenario, problem, scale) if is_linked(scenario) else problem
    return ContinuousMission(scenario, ways, home, origin, pace, scale, linked)


def _link(scenario: Scenario, problem: CoalitionProblem, scale: float) -> LinkedProblem:
    """Return a mission's problem with its linked starts and the weights of its cost."""
    number_of = {task.name: number for number, task in enumerate(scenario.tasks)}
    links = [
        Link(number, number_of[name], round(least * scale), round(most * scale))
        for number, task in enumerate(scenario.tasks)
        for name, (least, most) in task.starts.items()
    ]
    weight = np.zeros(PARTS)
    if scenario.cost is None:
        spread = SPREAD * len(scenario.robots)
        weight[[MAKESPAN, HOME, TARDINESS]] = spread, 1, LATENESS * spread
    else:
        parts = {
            "makespan": MAKESPAN,
            "travel": TRAVEL,
            "tardiness": TARDINESS,
            "max_tardiness": MAX_TARDINESS,
            "completion": COMPLETION,
        }
        total = sum(scenario.cost.values())
        for name, value in scenario.cost.items():
            weight[parts[name]] = value / total
    by_task = [1.0 if scenario.cost is None else task.weight for task in scenario.tasks]
    return link_problem(problem, links, weight, by_task)


def refuse_no_way(mission: ContinuousMission, plan: MissionPlan) -> None:
    """Refuse a plan in which somebody goes where no way leads.

    That each task has robots who can get there was seen to before; but tasks that are linked may
    need the same ones.
    """
    if math.isinf(plan.makespan):
        raise TeamformerError(
            f"{mission.scenario.name}: no plan was found in which all can get to their tasks",
            "open the map, move robots or tasks, or drop a link between tasks",
        )


def _distances(scenario: Scenario, origins: list[Place], goals: list[Place], flies: bool) -> Times:
    """Return the lengths of ways, as (origins, goals); infinite where there is none."""
    world = scenario.world
    if not isinstance(world, Grid):
        return straight_ways(origins, goals)
    cells = travel_matrix(replace(world, rows=()) if flies else world, origins, goals)
    return np.where(cells < UNREACHABLE, cells.astype(np.float64), np.inf)


def _ways_home(
    scenario: Scenario, places: list[Place], between: Mapping[bool, Times], starts: list[Place]
) -> Times:
    """Return how long each robot takes home from each place, (robots, places).

    `between` has the ways between places on the ground and in the air.
    """
    robots, tasks = scenario.robots, len(scenario.tasks)
    if scenario.ends is None:
        return np.zeros((len(robots), len(places)))
    if scenario.ends == ENDS_HOME:
        homes = [between[robot.flies][:, tasks + starts.index(robot.at)] for robot in robots]
    else:
        assert not isinstance(scenario.ends, str)
        end = scenario.ends
        to_end = {flies: _distances(scenario, [end], places, flies)[0] for flies in between}
        homes = [to_end[robot.flies] for robot in robots]
    return np.stack([way / robot.speed for way, robot in zip(homes, robots, strict=True)])


def _scale(scenario: Scenario, ways: Times, home: Times) -> float:
    """Return a power of ten: ticks in a unit, so many that everything takes MOST_TICKS or less."""
    longest = max(part[np.isfinite(part)].max(initial=0.0) for part in (ways, home))
    total = sum(task.duration + scenario.forming for task in scenario.tasks)
    total += longest * (len(scenario.tasks) + 1) + 1e-6
    total += max(release_of(scenario, task) for task in range(len(scenario.tasks)))
    scale = 1e-6
    while 10 * scale * total <= MOST_TICKS:
        scale *= 10
    return scale


def _ticks(times: npt.ArrayLike, scale: float) -> npt.NDArray[np.int64]:
    known = np.where(np.isfinite(times), times, NO_WAY * MOST_TICKS / scale / 10)
    return np.rint(known * scale).astype(np.int64)
