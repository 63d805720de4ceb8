"""The plans of a batch of worlds as arrays; few imports, as compiled code is kept by this."""

from __future__ import annotations

from typing import NamedTuple

from teamformer.base.array_types import Array
from teamformer.base.kernels.rows import row_taker


class Parts(NamedTuple):
    """The plans that a batch of worlds goes by, and what they want of every team."""

    first: Array  # (worlds, robots + 1) int32, where the tasks of each part of the plan begin
    task: Array  # (worlds, entries) int32, the tasks of all parts, in the plan's order each
    part: Array  # (worlds, robots) int32, the part that each robot plays; at first its own
    scouts: Array  # (worlds, robots) int32, the task that a robot looks at first, or NOBODY
    took: Array  # (worlds, robots) int32, the robot whose part one has just taken, or NOBODY
    kind: Array  # (worlds, robots) int32, the lowest robot that brings the same and is as fast
    is_parting: Array  # (worlds, robots) bool, the robots of the team have different next tasks
    waiting: Array  # (worlds, tasks) int32, a team that waits there for others, or NOBODY
    wanted: Array  # (worlds, robots, caps) int32, the counts that each team is to have, by slot


parts_at = row_taker(Parts)
"""Return the plan of one world of a batch; writing to it writes to the batch."""
