"""What a first run compiles beside itself, and that a later one is silent."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from teamformer.cli.terminal import compiling
from teamformer.methods.by_name import load_method

EXAMPLE = Path(__file__).parents[1] / "examples" / "four-robots.yaml"


def test_what_is_compiled_is_neither_announced_nor_compiled_again(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", ["compiling", "crews"])
    compiling.main()
    monkeypatch.setattr(subprocess, "Popen", None)  # calling it would fail
    compiling.compile_ahead([load_method("crews")])
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("what", ["--planner", "--simulator"])
def test_kernels_are_compiled_without_what_is_installed_last(what: str) -> None:
    """`make run` begins to compile before ortools, onnxruntime and the package itself are there."""
    code = (
        "import sys, importlib.metadata as installed\n"
        "sys.modules.update(dict.fromkeys(('ortools', 'onnxruntime', 'pandas')))\n"
        "installed.entry_points = lambda **_: installed.EntryPoints()\n"
        "from teamformer.cli.terminal import compiling\n"
        f"sys.argv = ['compiling', {what!r}]\n"
        "compiling.main()"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


@pytest.mark.slow
def test_a_first_run_leaves_everything_compiled(tmp_path: Path) -> None:
    """With a cache of its own a first run says what it compiles, and the next one says nothing."""
    told = []
    for _ in range(2):
        done = subprocess.run(
            [sys.executable, "-m", "teamformer.cli", "run", str(EXAMPLE)],
            capture_output=True,
            text=True,
            env={**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)},
        )
        assert done.returncode == 0
        told.append(done.stderr.count("compiling"))
    assert told[0] >= 1
    assert told[1] == 0
