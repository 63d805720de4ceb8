"""How every process of the suite runs: one thread each, stopped by Ctrl-C, one browser for all.

There are three levels: what `make test` runs, what `make check` runs beside that, and what takes
minutes and is run with `make test-all`.
"""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

# Two processes with two threads each on two cores wait for one another: ten times as long. Said
# before any of these libraries is loaded, and for the processes that tests start, too.
for library in ("OMP", "OPENBLAS", "MKL"):
    os.environ.setdefault(f"{library}_NUM_THREADS", "1")

# A job of the background ignores Ctrl-C, as some CI does, and so would what its tests start.
if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


THOROUGH = ("bench", "fuzz", "learning", "robotarium", "viewer")
"""Folders whose tests are all thorough: browsers, benchmarks, training, random missions."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark the tests of these folders; elsewhere the mark stands beside a test that takes long."""
    folders = [Path(__file__).parent / name for name in THOROUGH]
    for item in items:
        if any(folder in item.path.parents for folder in folders):
            item.add_marker(pytest.mark.thorough)


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    """Return the one browser of this process: a second Playwright cannot start beside the first."""
    from browsers import chromium

    with chromium() as found:
        yield found


@pytest.fixture
def own_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder that a user works in. What was imported from it is forgotten at the end."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    yield tmp_path
    for name, module in list(sys.modules.items()):
        if str(getattr(module, "__file__", "")).startswith(str(tmp_path)):
            del sys.modules[name]
