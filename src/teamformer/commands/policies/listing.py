"""`teamformer methods`: what can be named with --method."""

from __future__ import annotations

from rich.table import Table

from teamformer.commands.console import out
from teamformer.trials.methods import METHODS


def methods() -> int:
    """List the methods; return the exit status."""
    table = Table(box=None, header_style="dim")
    table.add_column("name", no_wrap=True)
    for header in ("what it does", "tasks by", "trained on"):
        table.add_column(header, overflow="fold")
    for listing in METHODS:
        table.add_row(listing.name, listing.summary, listing.tasks_by, listing.trained_on)
    out.print(table)
    out.print("your own: --method module:Class (docs/reference/methods.md)")
    return 0
