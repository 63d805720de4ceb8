"""What is written of a trial: its record, and the page of that."""

from __future__ import annotations

from pathlib import Path

from teamformer.record.record import Replay
from teamformer.record.writing import replay_to_tree, write_replay
from teamformer.viewer.html import write_page


def write_record(replay: Replay, folder: Path) -> tuple[Path, Path]:
    """Write `replay.json` and its page `replay.html` into a folder; return both paths."""
    record, page = folder / "replay.json", folder / "replay.html"
    write_replay(replay, record)
    write_page(replay_to_tree(replay), page)
    return record, page
