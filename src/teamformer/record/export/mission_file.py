"""A record as a mission file again."""

from __future__ import annotations

from pathlib import Path

from teamformer.files.mission_files import write_mission
from teamformer.record.record import Record


def export_mission(record: Record, path: Path) -> None:
    """Write the mission with all that happened to it."""
    write_mission(record.mission, path)
