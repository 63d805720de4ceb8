"""What becomes known while a mission runs: what tasks need, and that a service is overdue.

`world.needs` holds what is believed; `world.true_needs` is looked at by nobody before it shows.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from teamformer.base.kernels.jit import kernel
from teamformer.world.phases.motion import is_way
from teamformer.world.rules.constants import NOBODY
from teamformer.world.state.arrays import OVERDUE, SHOWN
from teamformer.world.state.spatial_index import find_tasks_here

if TYPE_CHECKING:
    from teamformer.world.state.arrays import World


@kernel
def show_needs(world: World, step: int) -> bool:
    """Make known what the open tasks need that teams stand at; say whether any was not known."""
    if not world.rules.hides_needs:
        return False
    any_shown = False
    for team in range(world.rules.robots):
        if world.teams[team].size == 0:
            continue
        for i in range(find_tasks_here(world, team)):
            task = world.here[i]
            if world.tasks[task].is_open and world.tasks[task].hides_needs:
                world.tasks[task].hides_needs = False
                world.tasks[task].shown_at = step
                world.count.news |= SHOWN
                for cap in range(world.needs.shape[1]):
                    _believe(world, task, cap, world.true_needs[task, cap])
                any_shown = True
    return any_shown


@kernel
def expect_needs(world: World) -> None:
    """Believe of every task what is expected, as far as the robots that are left can bring it.

    Call it when robots are lost or back; of the rest one can only hope that it is not needed.
    """
    if not world.rules.hides_needs:
        return
    for task in range(world.rules.tasks):
        if not world.tasks[task].hides_needs:
            continue
        for cap in range(world.needs.shape[1]):
            sure, expected = world.sure_needs[task, cap], world.expected_needs[task, cap]
            is_hopeless = expected > sure and _count_near(world, task, cap) < expected
            _believe(world, task, cap, sure if is_hopeless else expected)


@kernel
def _count_near(world: World, task: int, cap: int) -> int:
    """Return how often the robots that are left and can get to a task bring a capability."""
    count = 0
    for robot in range(world.rules.robots):
        is_there = is_way(world.robots[robot].region, world.tasks[task].region)
        if is_there and world.robots[robot].team != NOBODY:
            count += world.brings[robot, cap]
    return count


@kernel
def _believe(world: World, task: int, cap: int, count: int) -> None:
    if world.tasks[task].is_open:
        world.demand[cap] += (count > 0) - (world.needs[task, cap] > 0)
    world.needs[task, cap] = count


@kernel
def expect_end(world: World, task: int) -> None:
    """Expect the end of a service anew where it is due and not over: amid what is left of it."""
    if world.tasks[task].served >= world.tasks[task].expected:
        longest, served = world.tasks[task].longest, world.tasks[task].served
        world.tasks[task].expected = (served + 1 + longest + 1) // 2
        world.count.news |= OVERDUE


@kernel
def expected_rest(world: World, team: int) -> int:
    """Return for how many steps a team is expected to serve; 0 if it serves nothing."""
    rest = 0
    if world.teams[team].serves > 0:
        for position in range(world.count.open):
            task = world.order[position]
            if world.tasks[task].server == team:
                rest = max(rest, expected_left(world, task))
    return rest


@kernel
def expected_left(world: World, task: int) -> int:
    """Return for how many steps more a task that is being served is expected to be."""
    left = world.tasks[task].ahead
    if not world.tasks[task].is_carried:
        left += world.tasks[task].expected - world.tasks[task].served
    return left
