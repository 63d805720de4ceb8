"""How time and memory grow with a mission: run by a method, written down and judged."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from teamformer.files.drawn.generate import Spec, generate
from teamformer.files.mission_files import write_mission
from teamformer.mission.parts.grid import Grid

SIDES = {20: 14, 100: 30, 300: 52, 1000: 95, 3000: 164, 10_000: 300}
"""How many robots and as many tasks, and the side of their grid: nine cells for each task."""

MOST_PLANNED = 1000
"""Of larger missions no shared plan is measured: it is made for these when asked for only."""


@dataclass(frozen=True)
class SizeRow:
    """What one mission took: processor seconds and the most memory of each command."""

    method: str
    count: int  # robots, and as many tasks
    makespan: int
    run_seconds: float
    run_megabytes: float
    check_seconds: float
    check_megabytes: float


def measure_size(sides: dict[int, int] = SIDES) -> Iterator[SizeRow]:
    """Yield a row for each method and size: tasks that need three of eight capabilities."""
    for count, side in sides.items():
        spec = Spec(count, count, 8, requirements=3, world=Grid(side, side))
        mission = generate(spec, np.random.default_rng(1), f"{count} robots and tasks")
        for method in ("plan", "crews") if count <= MOST_PLANNED else ("crews",):
            with TemporaryDirectory() as folder:
                path, record = Path(folder) / "mission.yaml", Path(folder) / "record"
                write_mission(mission, path)
                run = ["run", str(path), "--method", method, "--out", str(record), "--json"]
                told, *ran = _measured(run)
                _, *judged = _measured(["check", str(record / "record.json")])
                yield SizeRow(method, count, json.loads(told)["makespan"], *ran, *judged)


WATCH = """
import json, os, sys
command = [sys.executable, "-m", "teamformer.cli", *sys.argv[1:]]
_, status, usage = os.wait4(os.spawnv(os.P_NOWAIT, sys.executable, command), 0)
used = usage.ru_utime + usage.ru_stime, usage.ru_maxrss
print(json.dumps([os.waitstatus_to_exitcode(status), *used]), file=sys.stderr)
"""
"""Runs a command and tells what it used, in a small process: a child begins as a copy of its
parent, and the memory of that copy counts as the child's."""


def _measured(words: Sequence[str]) -> tuple[str, float, float]:
    """Return what a command prints, its processor seconds and the most megabytes it took."""
    command = [sys.executable, "-c", WATCH, *words]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    status, seconds, peak = json.loads(done.stderr.splitlines()[-1])
    if status != 0:
        raise subprocess.CalledProcessError(status, words)
    return done.stdout, seconds, peak / (1e6 if sys.platform == "darwin" else 1e3)
