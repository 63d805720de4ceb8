"""Where tasks are: the lists of the cells and the ways there, as a task comes to be elsewhere."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from teamformer.base.kernels.jit import allocating_kernel, kernel
from teamformer.world.rules.constants import NOBODY
from teamformer.world.rules.distances import UNREACHABLE, fill_field
from teamformer.world.state.spatial_index import cell_of

if TYPE_CHECKING:
    from teamformer.world.state.arrays import World


@allocating_kernel
def put_task(world: World, task: int, x: float, y: float) -> None:
    """Let a task be in a place from now on."""
    change_cell(world, task, x, y)
    if world.rules.has_walls:
        field = world.fields[task]
        for row in range(field.shape[0]):
            for column in range(field.shape[1]):
                field[row, column] = UNREACHABLE
        fill_field(world.blocked, int(x), int(y), field)


@kernel
def change_cell(world: World, task: int, x: float, y: float) -> None:
    """Let a task be in a place, whose ways there are written down by somebody else."""
    _leave_cell(world, task)
    world.tasks[task].x, world.tasks[task].y = x, y
    _enter_cell(world, task)


@kernel
def _leave_cell(world: World, task: int) -> None:
    cell = cell_of(world, world.tasks[task].x, world.tasks[task].y)
    if world.cells[cell].first_task == task:
        world.cells[cell].first_task = world.tasks[task].next_here
        return
    before = world.cells[cell].first_task
    while world.tasks[before].next_here != task:
        before = world.tasks[before].next_here
    world.tasks[before].next_here = world.tasks[task].next_here


@kernel
def _enter_cell(world: World, task: int) -> None:
    """Put a task into its cell's chain, which is in task order."""
    cell = cell_of(world, world.tasks[task].x, world.tasks[task].y)
    before, after = np.int64(NOBODY), np.int64(world.cells[cell].first_task)
    while after != NOBODY and after < task:
        before, after = after, np.int64(world.tasks[after].next_here)
    world.tasks[task].next_here = after
    if before == NOBODY:
        world.cells[cell].first_task = task
    else:
        world.tasks[before].next_here = task
