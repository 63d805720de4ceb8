"""A record as a mission file again."""

from __future__ import annotations

from pathlib import Path

from teamformer.files.mission_files import write_scenario
from teamformer.record.record import Replay


def write_mission(replay: Replay, path: Path) -> None:
    """Write the mission with all that happened to it."""
    write_scenario(replay.scenario, path)
