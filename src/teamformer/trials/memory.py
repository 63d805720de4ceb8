"""Whether the memory that is left is enough for a mission: told before it is begun."""

from __future__ import annotations

import math
import os
import sys
from collections.abc import Iterator
from pathlib import Path

from teamformer.base.errors import TeamformerError
from teamformer.methods.by_name import Method
from teamformer.methods.coordinators.shared_plan import SharedPlan
from teamformer.methods.listings import STAND_IN
from teamformer.methods.seam.protocol import Planner
from teamformer.mission.model import Mission
from teamformer.mission.parts.grid import Grid
from teamformer.planning.problem.ways import are_ways_straight

PLANNED, TABLED, PLAYED = 24, 10, 3
"""Bytes for the square of how many robots and tasks there are: with a shared plan; without one, but
with a table of ways, as there are walls, loads or a plane; and without both.

Measured as what a process grew by, with eight capabilities of which a task needs three. With a plan
93 MB for 1,000 robots and 1,000 tasks, 370 MB for 2,000 and 2,000 and for 3,000 and 1,000. With a
table by crews 303 MB for 3,000 and 3,000. Without both 450 MB for 10,000 and 10,000.
"""

FIELD = 8
"""Bytes for each cell of a map with walls and each task: distances, at the start and now."""

MEGABYTE = 2**20

UNUSED = 100 * MEGABYTE
"""Addresses that threads keep for themselves and never use: a limit counts them, too."""


def refuse_too_large(mission: Mission, method: Method) -> None:
    """Raise `TeamformerError` with what would fit if a mission needs more memory than is left."""
    robots, tasks = len(mission.robots), len(mission.tasks)
    has_plan = plans_for_all(method)
    needed, left = bytes_needed(mission, has_plan), bytes_left()
    if left is None or needed <= left:
        return
    share = share_that_fits(needed, _bytes_of_fields(mission), left)
    hint = f"about {int(robots * share)} robots and {int(tasks * share)} tasks would fit"
    if has_plan and bytes_needed(mission, has_plan=False) <= left:
        hint += f", or `teamformer run MISSION --method {STAND_IN}`"
    raise TeamformerError(
        f"{mission.name}: {robots} robots and {tasks} tasks need about {_shown(needed)} of memory "
        f"by method {method.name}, and {_shown(left)} are left",
        hint,
    )


def plans_for_all(method: Method) -> bool:
    """Say whether a method makes plans of all tasks and robots, as `plan` and `central` do."""
    return isinstance(method.coordinator, SharedPlan) or isinstance(method.policy, Planner)


def bytes_needed(mission: Mission, has_plan: bool) -> int:
    """Return how many bytes a mission takes, beside what the process has already."""
    untabled = PLAYED if are_ways_straight(mission.world, mission.tasks) else TABLED
    square = (len(mission.robots) + len(mission.tasks)) ** 2
    return (PLANNED if has_plan else untabled) * square + _bytes_of_fields(mission)


def _bytes_of_fields(mission: Mission) -> int:
    """Return how many bytes the distances to all tasks take where there are walls."""
    world = mission.world
    if not isinstance(world, Grid) or not world.rows:
        return 0
    return FIELD * world.width * world.height * len(mission.tasks)


def share_that_fits(needed: int, fields: int, left: int) -> float:
    """Return the part of a mission that fits; fields grow with its size, the rest with its square.

    It is the positive root of square x share^2 + fields x share = left.
    """
    square = needed - fields
    return (math.sqrt(fields**2 + 4.0 * square * left) - fields) / (2 * square)


def bytes_left() -> int | None:
    """Return how many bytes this process may still take; None if that cannot be known here."""
    return min(_limits(), default=None)


def _limits() -> Iterator[int]:
    """Yield what the process's own limit leaves, and what the machine has free."""
    if sys.platform != "win32":
        import resource

        limit, _ = resource.getrlimit(resource.RLIMIT_AS)
        if limit != resource.RLIM_INFINITY:
            yield max(0, limit - _taken() - UNUSED)
    free = [line.split() for line in _lines(Path("/proc/meminfo")) if "MemAvailable" in line]
    if free:
        yield int(free[0][1]) * 1024


def _taken() -> int:
    """Return how many bytes of addresses this process has; 0 if that cannot be known here."""
    pages = _lines(Path("/proc/self/statm"))
    return int(pages[0].split()[0]) * os.sysconf("SC_PAGE_SIZE") if pages else 0


def _lines(path: Path) -> list[str]:
    """Return the lines of a file of the system; none if there is no such file."""
    try:
        return path.read_text(encoding="ascii").splitlines()
    except OSError:
        return []


def _shown(size: int) -> str:
    return f"{size / MEGABYTE:,.0f} MB"
