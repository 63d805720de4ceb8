"""One step of one world, phase by phase, and the loop over a batch of worlds."""

from __future__ import annotations

from typing import TYPE_CHECKING

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import allocating_kernel, entry, kernel
from teamformer.world.phases.assignment import allocate_tasks
from teamformer.world.phases.beliefs import expect_needs, show_needs
from teamformer.world.phases.carrying import place_loads
from teamformer.world.phases.charging import charge_teams
from teamformer.world.phases.completion import (
    cancel_tasks,
    complete_tasks,
    drop_assignments,
    miss_tasks,
)
from teamformer.world.phases.ending import judge_status
from teamformer.world.phases.energy import spend_standing
from teamformer.world.phases.finding import find_tasks
from teamformer.world.phases.formation import form_joins, read_decisions, split_teams
from teamformer.world.phases.losses import lose_robots, return_robots
from teamformer.world.phases.motion import move_teams, place_teams
from teamformer.world.phases.task_order import release_tasks
from teamformer.world.reward import reward_teams
from teamformer.world.rules.constants import NEVER
from teamformer.world.state.arrays import RUNNING, world_at
from teamformer.world.state.spatial_index import forget_cells, list_teams_by_cell

if TYPE_CHECKING:
    from teamformer.world.state.arrays import World, Worlds


@entry
def step_worlds(
    worlds: Worlds,
    wanted: Array,
    named: Array,
    first_row: Array,
    weights: tuple[float, float, float],
    rewards: Array,
    begin: int,
    end: int,
) -> None:
    """Step the running worlds from `begin` to `end` of a batch.

    `wanted` is (teams, caps) and `named` (teams,): one row for each team of each running world, in
    world and slot order; `first_row` (worlds + 1,) is where each world's rows begin.
    """
    for w in range(begin, end):
        if worlds.count[w].status == RUNNING:
            world = world_at(worlds, w)
            form_teams(world, wanted, named, first_row[w])
            if world.rules.has_batteries:
                charge_teams(world)
            move_teams(world)
            _end_step(world, weights, rewards[w])
        else:
            rewards[w, :] = 0.0


@entry
def form_worlds(worlds: Worlds, wanted: Array, named: Array, first_row: Array) -> None:
    """Make the phases before motion in all running worlds, of a step that others move in."""
    for w in range(len(worlds.rules)):
        if worlds.count[w].status == RUNNING:
            form_teams(world_at(worlds, w), wanted, named, first_row[w])


@entry
def finish_worlds(
    worlds: Worlds, places: Array, weights: tuple[float, float, float], rewards: Array
) -> None:
    """Put all teams where they have got to, (worlds, robots, 2) by slot, and end the step."""
    for w in range(len(worlds.rules)):
        if worlds.count[w].status == RUNNING:
            world = world_at(worlds, w)
            place_teams(world, places[w])
            _end_step(world, weights, rewards[w])
        else:
            rewards[w, :] = 0.0


@kernel
def form_teams(world: World, wanted: Array, named: Array, first_row: int) -> None:
    """Phases 1 to 4; the order of the phases alone decides that nothing blocks for ever."""
    list_teams_by_cell(world)
    read_decisions(world, wanted, named, first_row)
    forget_cells(world)
    split_teams(world, wanted)
    form_joins(world)
    list_teams_by_cell(world)
    allocate_tasks(world, named)
    forget_cells(world)


@allocating_kernel
def _end_step(world: World, weights: tuple[float, float, float], reward: Array) -> None:
    """Make the phases after motion."""
    if world.rules.has_batteries:
        spend_standing(world)
    is_news = let_things_happen(world)
    if world.rules.hides_places:
        is_news |= find_tasks(world)
    finish_step(world, is_news, weights, reward)
    if world.rules.has_loads:
        place_loads(world, world.count.steps)


@kernel
def let_things_happen(world: World) -> bool:
    """Let robots be lost and come back, and tasks be called off (phase 6); say whether any is."""
    step = world.count.steps + 1
    any_cancelled = cancel_tasks(world, step)
    any_lost = lose_robots(world, step)
    any_back = return_robots(world, step)
    if any_lost or any_back:
        expect_needs(world)
    return any_lost or any_back or any_cancelled


@kernel
def finish_step(
    world: World, is_news: bool, weights: tuple[float, float, float], rewards: Array
) -> None:
    """What becomes known of needs, phase 7, rewards, and the tasks that appear.

    `is_news` says that robots were lost or are back, that a task was called off or found elsewhere.
    """
    step = world.count.steps + 1
    any_shown = show_needs(world, step)
    complete_tasks(world, step)
    if world.rules.until < NEVER:
        miss_tasks(world, step)
    world.count.steps = step
    reward_teams(world, weights, rewards)
    any_released = release_tasks(world, step)
    if is_news or any_shown or any_released:
        drop_assignments(world)
    judge_status(world, is_news)
