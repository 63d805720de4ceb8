"""Rows of trials whose makespans are written down by hand."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from teamformer.bench.jobs import Job, known_row
from teamformer.bench.rows import Row
from teamformer.files.drawn.named_settings import world_of


def rows_of(
    setting: str, policy: str, makespans: Sequence[int | None], limit: int = 100
) -> list[Row]:
    """Trials on worlds 0, 1, ...; None is a failure at the step limit."""
    job = Job("hand", setting, policy, (), 1.0, "abc")
    mission = world_of("4N4T-C4", 0)
    return [
        replace(known_row(job, seed, mission, makespan), steps=makespan or limit)
        for seed, makespan in enumerate(makespans)
    ]
