"""`teamformer view`: the page of a recorded trial."""

from __future__ import annotations

from pathlib import Path

from teamformer.commands.console import prepare_file, say
from teamformer.sim.replay.reading import read_replay
from teamformer.sim.replay.writing import replay_to_tree
from teamformer.viewer.html import write_page


def view(path: Path, page: Path | None) -> int:
    """Write the page of a record beside it, or where asked; return the exit status."""
    page = page or path.with_suffix(".html")
    prepare_file(page)
    write_page(replay_to_tree(read_replay(path)), page)
    say(f"page: {page}")
    return 0
