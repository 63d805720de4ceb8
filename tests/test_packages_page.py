"""The package of the documents: installed without a network, listed, checked and run."""

from __future__ import annotations

import os
import subprocess
import sys
import tomllib
from pathlib import Path

from packages import add_package

ROOT = Path(__file__).parents[1]


def test_the_package_of_the_documents_is_listed_checked_and_run(tmp_path: Path) -> None:
    page = (ROOT / "docs" / "how-to" / "packages.md").read_text(encoding="utf-8")
    files = {
        part.split('"')[0]: part.partition("\n")[2].split("```")[0]
        for part in page.split(' title="')[1:]
    }
    code = files["nearest_robots.py"]
    assert len((files["pyproject.toml"] + code).splitlines()) <= 50
    project = tomllib.loads(files["pyproject.toml"])["project"]
    brings = {
        group.removeprefix("teamformer."): names for group, names in project["entry-points"].items()
    }
    add_package(tmp_path, project["name"], brings, "nearest_robots", code)
    (tmp_path / "test_nearest.py").write_text(files["test_nearest.py"])
    path = os.pathsep.join(filter(None, (str(tmp_path), os.environ.get("PYTHONPATH"))))

    def run(*words: str) -> str:
        done = subprocess.run(
            [sys.executable, *words],
            env=os.environ | {"PYTHONPATH": path, "COLUMNS": "200"},
            cwd=tmp_path,
            capture_output=True,
            text=True,
        )
        assert done.returncode == 0, done.stderr
        return done.stdout

    listed = run("-m", "teamformer.cli", "methods")
    [row] = [line for line in listed.splitlines() if line.startswith(" nearest ")]
    assert "Sends the nearest robots" in row
    assert "(package nearest-robots)" in row
    mission = str(ROOT / "examples" / "warehouse.yaml")
    told = run("-m", "teamformer.cli", "run", mission, "--method", "nearest", "--json")
    assert '"method": "nearest"' in told
    assert '"status": "completed"' in told
    run("-c", "import test_nearest; test_nearest.test_it_keeps_what_a_coordinator_keeps()")
