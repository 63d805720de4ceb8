"""HeteroMRTA's instances (IEEE RA-L 2025): robots with skills, tasks that need several, ways home.

A task starts when its last robot is there; all stay until it ends and are back in the end. Ways
are straight, at a speed of 0.2 in the unit square.
"""

from __future__ import annotations

from pathlib import Path

from teamformer.files.imports.trees import TreePart, read_json
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.plane import Plane

SPEED = 0.2


def read(path: Path) -> list[Mission]:
    """Return the mission of an instance, a JSON file."""
    tree = read_json(path)
    robots = tuple(
        Robot(f"r{key}", _place(part["pose"]), _skills(part), SPEED)
        for key, part in tree["robots"].parts()
    )
    tasks = tuple(
        Task(f"t{key}", _place(part["pos"]), _skills(part), part["duration"].number(0))
        for key, part in tree["tasks"].parts()
    )
    _compare_sizes(tree, len(robots), len(tasks))
    skills = {name for can in (*(r.can for r in robots), *(t.needs for t in tasks)) for name in can}
    spots = [*(robot.at for robot in robots), *(task.at for task in tasks)]
    corner = [max(1.0, *(spot[axis] for spot in spots)) for axis in (0, 1)]
    return [
        Mission(
            name=path.stem,
            world=Plane(*corner),
            capabilities=tuple(sorted(skills)),
            robots=robots,
            tasks=tasks,
            time="continuous",
            ends="home",
        )
    ]


def _compare_sizes(tree: TreePart, robots: int, tasks: int) -> None:
    """Refuse a file whose setup names other numbers than it holds: it was cut or put together."""
    setup = tree["setup"]
    for key, count in (("robots", robots), ("tasks", tasks)):
        if setup[key].whole(1) != count:
            setup[key].refuse(f"is {setup[key].value}, but the file holds {count}")


def _place(part: TreePart) -> Place:
    return part["x"].number(0), part["y"].number(0)


def _skills(part: TreePart) -> dict[str, int]:
    """Return the skills that are not 0, as `skill-0`, `skill-1`, ..."""
    counts = {f"skill-{key}": count.whole(0) for key, count in part["skillset"].parts()}
    return {name: count for name, count in counts.items() if count}
