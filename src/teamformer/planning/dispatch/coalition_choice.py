"""Picking a coalition for a task in its turn: who is there first, nobody earlier than needed."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import numpy.typing as npt

from teamformer.base.array_types import Int32s
from teamformer.base.kernels.jit import kernel
from teamformer.planning.problem.coalition_problem import NOBODY
from teamformer.planning.problem.rotas import walked
from teamformer.world.rules.chance import draw_below

if TYPE_CHECKING:
    from teamformer.planning.problem.coalition_problem import CoalitionProblem
    from teamformer.planning.problem.schedule import Schedule

BLINK = 16
"""Every so many robots one is overlooked, so that the search does not always see the same."""


class Workspace(NamedTuple):
    """A coalition at hand, and room to choose it in."""

    pick: Int32s  # (robots,) its robots
    picks: Int32s  # (1,) how many these are
    short: Int32s  # (caps,) what it still lacks
    random: npt.NDArray[np.uint64]  # (1,) state of the random numbers


def empty_workspace(problem: CoalitionProblem, seed: int) -> Workspace:
    """Return room to work in, with the random numbers seeded."""
    robots, caps = problem.counts.shape
    return Workspace(
        pick=np.zeros(robots, np.int32),
        picks=np.zeros(1, np.int32),
        short=np.zeros(caps, np.int32),
        random=np.array([seed * 2654435761 + 88172645463325252], np.uint64),
    )


@kernel
def arrival(
    problem: CoalitionProblem, schedule: Schedule, robot: int, task: int, position: int
) -> int:
    """Return when a robot can be at a task that is done at a position of the order."""
    place = schedule.last[position, robot]
    way = problem.ways[problem.pace[robot], place, task]
    return walked(problem.rotas, problem.kind[robot], schedule.end[place], way)


@kernel
def is_picked(workspace: Workspace, robot: int) -> bool:
    """Say whether a robot is in the coalition at hand."""
    for seat in range(workspace.picks[0]):
        if workspace.pick[seat] == robot:
            return True
    return False


@kernel
def count_short(problem: CoalitionProblem, workspace: Workspace, task: int) -> int:
    """Work out what the coalition at hand lacks; say whether it is anything."""
    is_short = False
    for cap in range(problem.needs.shape[1]):
        lacking = problem.needs[task, cap]
        if lacking > 0:
            for seat in range(workspace.picks[0]):
                lacking -= problem.counts[workspace.pick[seat], cap]
        workspace.short[cap] = lacking
        is_short |= lacking > 0
    return is_short


@kernel
def give_way(
    problem: CoalitionProblem, schedule: Schedule, workspace: Workspace, task: int, position: int
) -> None:
    """Let members give their place to the like robot that comes last of those still in time."""
    start = 0
    for seat in range(workspace.picks[0]):
        start = max(start, arrival(problem, schedule, workspace.pick[seat], task, position))
    for seat in range(workspace.picks[0]):
        robot = workspace.pick[seat]
        latest = arrival(problem, schedule, robot, task, position)
        for other in problem.like[problem.kind[robot]]:
            if other == NOBODY:
                break
            comes = arrival(problem, schedule, other, task, position)
            if latest < comes <= start and not is_picked(workspace, other):
                workspace.pick[seat], latest = other, comes


@kernel
def cover(
    problem: CoalitionProblem, schedule: Schedule, workspace: Workspace, task: int, position: int
) -> bool:
    """Add the robots that come first for what the coalition at hand lacks; say if it is enough.

    Who carries a load more slowly counts as coming so much later.
    """
    while count_short(problem, workspace, task):
        best, earliest = NOBODY, 0
        for robot in problem.able[draw_short(problem, workspace)]:
            if robot == NOBODY:
                break
            if is_picked(workspace, robot):
                continue
            comes = arrival(problem, schedule, robot, task, position)
            comes += problem.slower[problem.pace[robot], task]
            if best == NOBODY or (comes < earliest and draw_below(workspace.random, BLINK) > 0):
                best, earliest = robot, comes
        if best == NOBODY:
            return False
        workspace.pick[workspace.picks[0]] = best
        workspace.picks[0] += 1
    drop_spare(problem, workspace, task)
    return True


@kernel
def draw_short(problem: CoalitionProblem, workspace: Workspace) -> int:
    """Draw a capability that the coalition at hand lacks."""
    caps = problem.needs.shape[1]
    cap = draw_below(workspace.random, caps)
    while workspace.short[cap] <= 0:
        cap = (cap + 1) % caps
    return cap


@kernel
def drop_spare(problem: CoalitionProblem, workspace: Workspace, task: int) -> None:
    """Drop members that the coalition at hand does not need, earlier picks first."""
    seat = 0
    while seat < workspace.picks[0]:
        if _is_spare(problem, workspace, task, seat):
            workspace.picks[0] -= 1
            for later in range(seat, workspace.picks[0]):
                workspace.pick[later] = workspace.pick[later + 1]
        else:
            seat += 1


@kernel
def _is_spare(problem: CoalitionProblem, workspace: Workspace, task: int, seat: int) -> bool:
    robot = workspace.pick[seat]
    for cap in range(problem.needs.shape[1]):
        if problem.needs[task, cap] > 0 and problem.counts[robot, cap] > 0:
            has = 0
            for other in range(workspace.picks[0]):
                has += problem.counts[workspace.pick[other], cap]
            if has - problem.counts[robot, cap] < problem.needs[task, cap]:
                return False
    return True
