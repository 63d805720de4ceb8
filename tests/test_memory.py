"""A mission that is too large for the memory is refused before it is begun."""

from __future__ import annotations

import resource
import subprocess
import sys
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from teamformer.cli import main
from teamformer.files.drawn.generate import Spec, generate
from teamformer.methods.by_name import load_method
from teamformer.mission.parts.grid import Grid
from teamformer.trials import memory
from teamformer.trials.memory import bytes_left, bytes_needed, plans_for_all

pytestmark = pytest.mark.skipif(not Path("/proc/meminfo").exists(), reason="needs Linux")

LIMIT = 1_100_000 * 1024  # bytes of addresses
COMMAND = (sys.executable, "-m", "teamformer.cli")


def limited(*words: str, limit: int = LIMIT) -> subprocess.CompletedProcess[str]:
    """Run the command line with so many bytes of addresses."""
    return subprocess.run(
        [*COMMAND, *words],
        capture_output=True,
        text=True,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)),
    )


def write_large(path: Path, count: int) -> None:
    """Write a mission of as many robots and tasks."""
    size = ("--robots", str(count), "--tasks", str(count), "--grid", "200x200")
    words = ("--capabilities", "8", "--requirements", "3", "-o", str(path))
    subprocess.run([*COMMAND, "generate", *size, *words], check=True, capture_output=True)


@pytest.mark.thorough
def test_a_mission_too_large_is_told_with_what_would_fit(tmp_path: Path) -> None:
    write_large(tmp_path / "m.yaml", 4000)
    ended = limited("run", str(tmp_path / "m.yaml"), "--method", "plan")
    error, hint = ended.stderr.splitlines()
    assert ended.returncode == 2
    assert "4000 robots and 4000 tasks need about" in error
    assert "MB of memory by method plan" in error
    fits = int(hint.split()[2])  # hint: about N robots and N tasks would fit
    assert 1000 < fits < 4000
    assert hint.endswith(f"{fits} tasks would fit, or `teamformer run MISSION --method crews`")
    assert ended.stdout == ""


@pytest.mark.thorough
def test_what_is_left_is_the_least_of_limit_and_machine() -> None:
    left = "from teamformer.trials.memory import bytes_left; print(bytes_left())"
    for limit in (LIMIT, LIMIT // 2):
        shown = subprocess.run(
            [sys.executable, "-c", left],
            capture_output=True,
            text=True,
            check=True,
            preexec_fn=partial(resource.setrlimit, resource.RLIMIT_AS, (limit, limit)),
        ).stdout
        assert 0 < int(shown) < limit
    free = next(x for x in Path("/proc/meminfo").read_text().splitlines() if "MemAvailable" in x)
    assert bytes_left() == pytest.approx(int(free.split()[1]) * 1024, rel=0.2)


def test_what_is_needed_grows_with_the_square() -> None:
    spec = Spec(9, 10, 3, world=Grid(20, 30))
    mission = generate(spec, np.random.default_rng(0), "m")
    assert bytes_needed(mission, has_plan=True) == memory.PLANNED * 361
    assert bytes_needed(mission, has_plan=False) == memory.PLAYED * 361
    walled = replace(mission, world=Grid(20, 30, ("." * 20,) * 30))
    assert bytes_needed(walled, has_plan=False) == memory.TABLED * 361 + memory.FIELD * 600 * 10


def test_what_fits_is_what_is_left() -> None:
    """Half of a mission takes a quarter of what grows with the square, half of the fields."""
    assert memory.share_that_fits(needed=400 + 100, fields=100, left=100 + 50) == 0.5
    assert memory.share_that_fits(needed=400, fields=0, left=100) == 0.5


@pytest.mark.parametrize(
    ("name", "is_so"), [("plan", True), ("central", True), ("crews", False), ("join-all", False)]
)
def test_these_methods_plan_for_all(name: str, is_so: bool) -> None:
    assert plans_for_all(load_method(name)) is is_so


def test_memory_that_runs_out_is_one_line(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", ["teamformer", "methods"])

    def exhaust() -> int:
        return len(bytearray(2**62))

    monkeypatch.setattr("teamformer.cli.verbs.policies.listing.methods", exhaust)
    with pytest.raises(SystemExit) as ended:
        main()
    told = capsys.readouterr().err.splitlines()
    assert ended.value.code == 1
    assert told[0] == "error: the memory ran out"
    assert told[1].startswith("hint: ")
    assert len(told) == 2
