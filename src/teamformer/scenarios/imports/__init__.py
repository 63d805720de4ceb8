"""Other people's instances as scenarios."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from teamformer.errors import ScenarioError, TeamformerError
from teamformer.model import Scenario
from teamformer.scenarios.imports import dcmrta, hetero_mrta, hhcrsp, sadcher

FORMATS: dict[str, Callable[[Path], list[Scenario]]] = {
    "hetero-mrta": hetero_mrta.read,
    "dcmrta": dcmrta.read,
    "sadcher": sadcher.read,
    "hhcrsp": hhcrsp.read,
}
"""Readers by the format's name; each returns the missions in a file or folder."""


def import_missions(form: str, path: Path) -> list[Scenario]:
    """Return the missions in a file of others; raises `TeamformerError` with file and place."""
    if form not in FORMATS:
        raise TeamformerError(f"format '{form}' is unknown", f"use {', '.join(FORMATS)}")
    try:
        return FORMATS[form](path)
    except ScenarioError as error:
        lines = [f"{path}: {problem.message}" for problem in error.problems]
        raise TeamformerError("\n".join(lines), "mend the file, or take its original") from None
