"""What the command line says, as rows: each command in an empty folder beside the examples."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from tempfile import TemporaryDirectory

from calls import short
from missions import ROOT

SHOWN = (
    "--help",
    "methods",
    "run examples/four-robots.yaml --out out",
    "run examples/storm.yaml --seed 3 --json",
    "run examples/breakdown.yaml --explain lifter-2",
    "run examples/missing.yaml",
    "compare examples/warehouse.yaml --methods heuristic,crews,plan",
    "check out/record.json",
    "export out/record.json out/tables",
    "plan examples/four-robots.yaml --time-limit 1",
    "generate --setting real --seed 3 --out out/real.yaml",
    "generate --setting nothing",
    "advise examples/four-robots.yaml --json",
    "view examples/warehouse.yaml",
    "fleet rehearse examples/four-robots.yaml --schedules 3",
    "fleet rehearse examples/late-tasks.yaml --schedules 2",
)
"""Some use what an earlier one wrote, which is made for them again."""

CLOCKS = re.compile(r"\d+(\.\d+)? m?s\b|\"\w*seconds\": [0-9.e-]+|\"curve\": \[.*?\]\]")


def terminal_row(line: str) -> str:
    """Return how a command ended, and a hash of what it said, without times of the clock."""
    with TemporaryDirectory() as folder:
        os.symlink(ROOT / "examples", os.path.join(folder, "examples"))
        if "out/record.json" in line:
            _call("run examples/four-robots.yaml --out out", folder)
        done = _call(line, folder)
        said = [CLOCKS.sub("~", text.replace(folder, "")) for text in (done.stdout, done.stderr)]
        return f"{done.returncode} {short(said)}"


def _call(line: str, folder: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "teamformer.cli", *line.split()]
    kept = {**os.environ, "COLUMNS": "120", "NO_COLOR": "1"}
    return subprocess.run(command, cwd=folder, env=kept, capture_output=True, text=True)
