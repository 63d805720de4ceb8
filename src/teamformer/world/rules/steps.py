"""One cell of a shortest way on a grid: of several, always the same one for everybody."""

from __future__ import annotations

from typing import Any

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import kernel


@kernel
def next_cell(
    fields: Array, has_walls: bool, goal: int, x: int, y: int, goal_x: int, goal_y: int
) -> Any:
    """Return the next cell on a shortest way from (x, y) to a goal that is not there.

    It first goes along the axis with more left to go, along x if they are equal. `fields`
    (goals, height, width) are the distances to each goal; without walls they are not looked at.
    """
    along_x = abs(goal_x - x) >= abs(goal_y - y)
    if has_walls:
        return downhill(fields[goal], x, y, along_x)
    if along_x:
        return (x + 1, y) if goal_x > x else (x - 1, y)
    return (x, y + 1) if goal_y > y else (x, y - 1)


@kernel
def downhill(field: Array, x: int, y: int, along_x: int) -> tuple[Any, Any]:
    """Return a neighbouring cell that is one nearer to the goal: along the axis given, if one is.

    Of two towards larger coordinates.
    """
    nearer = field[y, x] - 1
    best_x, best_y = x, y
    for side in range(4):
        to_x = x + (1 if side == 0 else -1 if side == 1 else 0)
        to_y = y + (1 if side == 2 else -1 if side == 3 else 0)
        is_inside = 0 <= to_y < field.shape[0] and 0 <= to_x < field.shape[1]
        if is_inside and field[to_y, to_x] == nearer:
            if (side < 2) == along_x:
                return to_x, to_y
            if best_x == x and best_y == y:
                best_x, best_y = to_x, to_y
    return best_x, best_y
