"""`teamformer generate`: a random scenario in a file."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from teamformer.commands.console import prepare_file, print_json, say
from teamformer.errors import TeamformerError
from teamformer.model import Grid
from teamformer.scenarios.files import write_scenario
from teamformer.scenarios.generate import Spec
from teamformer.scenarios.generate import generate as generate_scenario
from teamformer.scenarios.maps import read_map


def generate(
    spec: Spec,
    grid: str | None,
    map_path: Path | None,
    cell: float | None,
    seed: int,
    path: Path,
    as_json: bool,
) -> int:
    """Write a random scenario; return the exit status."""
    prepare_file(path)
    world = _world(grid, map_path, cell)
    name = f"{spec.robots} robots, {spec.tasks} tasks, seed {seed}"
    spec = Spec(**{**vars(spec), "world": world})
    scenario = generate_scenario(spec, np.random.default_rng(seed), name)
    write_scenario(scenario, path)
    if as_json:
        print_json({"file": str(path), "robots": spec.robots, "tasks": len(scenario.tasks)})
    else:
        say(f"scenario: {path}")
    return 0


def _world(grid: str | None, map_path: Path | None, cell: float | None) -> Grid:
    if map_path is not None:
        if grid is not None:
            raise TeamformerError("--grid and --map exclude each other; give one")
        return read_map(map_path, cell)
    size = re.fullmatch(r"(\d{1,4})x(\d{1,4})", grid or "10x10")
    if size is None or "0" in size.groups():
        raise TeamformerError(
            f"--grid {grid} is no size", "write it as WIDTHxHEIGHT, such as 20x10"
        )
    return Grid(int(size.group(1)), int(size.group(2)))
