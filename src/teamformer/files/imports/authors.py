"""Worlds written by the paper authors' own environment (njayboehme/Teamformer), as JSON lines.

One object a line: `setting`, `seed`, `rows`, `cols`, `caps`, `robots` as [x, y, capability],
`tasks` as [x, y, [capabilities]], and `authors_heuristic`, the makespan of the authors' own
heuristic, null if it never finished.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

from teamformer.base.errors import TeamformerError
from teamformer.base.file_access import read_text
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Grid

LARGEST_FILE = 100_000_000  # bytes


@dataclass(frozen=True)
class AuthorsWorld:
    """A world of theirs, and what their heuristic took there; None if it never finished."""

    setting: str
    seed: int
    mission: Mission
    heuristic: int | None


@lru_cache(maxsize=16)
def read_worlds(path: Path) -> tuple[AuthorsWorld, ...]:
    """Read a file of worlds; raises `TeamformerError` with the line that is not one."""
    worlds = []
    for number, line in enumerate(read_text(path, LARGEST_FILE).splitlines(), start=1):
        try:
            worlds.append(_world(json.loads(line)))
        except (ValueError, KeyError, TypeError, IndexError) as error:
            what = f"{path}:{number}: this is no world of the authors' environment ({error!r})"
            raise TeamformerError(what, "see docs/how-to/bench.md for the format") from None
    if not worlds:
        raise TeamformerError(f"{path}: holds no world")
    return tuple(worlds)


def read_world(path: Path, seed: int) -> AuthorsWorld:
    """Return the world with a seed."""
    return next(world for world in read_worlds(path) if world.seed == seed)


def _world(tree: dict[str, Any]) -> AuthorsWorld:
    names = tuple(f"c{number}" for number in range(tree["caps"]))
    mission = Mission(
        name=f"{tree['setting']}-{tree['seed']}",
        world=Grid(tree["cols"], tree["rows"]),
        capabilities=names,
        robots=tuple(
            Robot(f"r{number}", (x, y), {names[cap]: 1})
            for number, (x, y, cap) in enumerate(tree["robots"])
        ),
        tasks=tuple(
            Task(f"t{number}", (x, y), {names[cap]: 1 for cap in needs})
            for number, (x, y, needs) in enumerate(tree["tasks"])
        ),
    )
    return AuthorsWorld(tree["setting"], tree["seed"], mission, tree["authors_heuristic"])
