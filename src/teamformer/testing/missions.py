"""The missions that methods are checked on, unless others are given."""

from __future__ import annotations

from teamformer.files.drawn.named_settings import world_of
from teamformer.mission.model import Mission

SETTINGS = ("4N4T-C4", "4N9T-C4", "warehouse-lost", "sparse-needs", "sparse-places")
"""Few tasks and many, walls, lost robots, and needs and places that nobody knows."""


def usual_missions() -> list[Mission]:
    """Return a mission of each kind that a method may meet."""
    return [world_of(setting, 0) for setting in SETTINGS]
