"""`teamformer generate`: a random mission in a file."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from teamformer.base.errors import TeamformerError
from teamformer.cli.terminal.console import prepare_file, refuse_existing, say
from teamformer.files.drawn.generate import Spec
from teamformer.files.drawn.generate import generate as generate_mission
from teamformer.files.drawn.named_settings import world_of
from teamformer.files.maps.formats import read_coarse_map
from teamformer.files.mission_files import write_mission
from teamformer.mission.model import Mission, World
from teamformer.mission.parts.grid import LARGEST_MAP, Grid
from teamformer.mission.parts.plane import Plane

FOR_EDITORS = "# yaml-language-server: $schema=mission.schema.json"
"""The line by which editors find the schema, once `teamformer schema` has written it beside."""


def generate(
    spec: Spec,
    grid: str | None,
    plane: str | None,
    map_path: Path | None,
    seed: int,
    path: Path,
) -> int:
    """Write a random mission; return the exit status."""
    _prepare(path)
    world = _world(grid, plane, map_path)
    name = f"{spec.robots} robots, {spec.tasks} tasks, seed {seed}"
    spec = Spec(**{**vars(spec), "world": world})
    mission = generate_mission(spec, np.random.default_rng(seed), name)
    return _write(mission, path)


def generate_setting(setting: str, seed: int, path: Path) -> int:
    """Write a world that a benchmark runs on; return the exit status."""
    _prepare(path)
    return _write(world_of(setting, seed), path)


def _prepare(path: Path) -> None:
    refuse_existing(path)
    prepare_file(path)


def _write(mission: Mission, path: Path) -> int:
    write_mission(mission, path, FOR_EDITORS)
    say(f"mission: {path}")
    return 0


def _world(grid: str | None, plane: str | None, map_path: Path | None) -> World:
    if sum(given is not None for given in (grid, plane, map_path)) > 1:
        raise TeamformerError("--grid, --plane and --map exclude each other; give one")
    if map_path is not None:
        return read_coarse_map(map_path)
    if plane is not None:
        width, height = _size("--plane", plane, r"\d{1,5}(?:\.\d{1,3})?", "3.2x2.0")
        return Plane(width, height)
    width, height = _size("--grid", grid or "10x10", r"\d{1,9}", "20x10")
    if width * height > LARGEST_MAP:
        raise TeamformerError(
            f"--grid {grid} has {width * height:,.0f} cells",
            f"{LARGEST_MAP:,} are possible, such as 2048x2048",
        )
    return Grid(int(width), int(height))


def _size(flag: str, text: str, number: str, example: str) -> tuple[float, float]:
    """Return the width and the height in a text such as `20x10`."""
    size = re.fullmatch(f"({number})x({number})", text)
    sides = [float(side) for side in size.groups()] if size else []
    if not sides or min(sides) == 0:
        raise TeamformerError(
            f"{flag} {text} is no size", f"write it as WIDTHxHEIGHT, such as {example}"
        )
    width, height = sides
    return width, height
