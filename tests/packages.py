"""Packages of others that bring something by entry points: as an installer would leave them."""

from __future__ import annotations

import importlib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

import pytest

from teamformer.base.entry_points import brought


def add_package(
    folder: Path, package: str, brings: Mapping[str, Mapping[str, str]], module: str, code: str
) -> None:
    """Write what an installed package leaves in a folder: its module and its entry points."""
    info = folder / f"{package.replace('-', '_')}-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {package}\nVersion: 1.0\n")
    lines = []
    for group, names in brings.items():
        lines += [f"[teamformer.{group}]", *(f"{name} = {at}" for name, at in names.items()), ""]
    (info / "entry_points.txt").write_text("\n".join(lines))
    (folder / f"{module}.py").write_text(code)


@contextmanager
def packages_in(folder: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Have packages found that lie in a folder, as if a process had started with them."""
    monkeypatch.syspath_prepend(str(folder))
    importlib.invalidate_caches()
    brought.cache_clear()
    try:
        yield
    finally:
        monkeypatch.undo()
        brought.cache_clear()
