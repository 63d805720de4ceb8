"""What verbs write of a trial, and what they say of it."""

from __future__ import annotations

from pathlib import Path

from teamformer.cli.terminal.console import say
from teamformer.record.record import Record
from teamformer.trials.outputs import write_record


def write_and_say(record: Record, folder: Path) -> None:
    """Write a record and its page into a folder, and say where they are."""
    kept, page = write_record(record, folder)
    say(f"record: {kept}")
    say(f"page:   {page}")
