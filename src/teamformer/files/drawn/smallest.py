"""A mission to compile with."""

from __future__ import annotations

from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Grid


def smallest_mission() -> Mission:
    """Return a mission of three robots and two tasks for which everything is called once."""
    robots = tuple(Robot(f"r{r}", (0, 0), {cap: 1}) for r, cap in enumerate("aab"))
    tasks = tuple(Task(f"t{k}", (k, 0), {"a": 1, "b": 1}) for k in range(2))
    return Mission("smallest", Grid(2, 1), ("a", "b"), robots, tasks)
