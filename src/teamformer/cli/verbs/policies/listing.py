"""`teamformer methods`: what can be named with --method."""

from __future__ import annotations

from rich.markup import escape
from rich.table import Table

from teamformer.base.entry_points import OURS
from teamformer.cli.terminal.console import out
from teamformer.methods.listings import method_listings


def methods() -> int:
    """List the methods, and which package brings them if not ours; return the exit status."""
    table = Table(box=None, header_style="dim")
    table.add_column("name", no_wrap=True)
    for header in ("what it does", "tasks by", "trained on"):
        table.add_column(header, overflow="fold")
    for listing in method_listings():
        of = "" if listing.package == OURS else f" (package {listing.package})"
        told = f"{listing.summary}{of}"
        table.add_row(listing.name, escape(told), listing.tasks_by, listing.trained_on)
    out.print(table)
    out.print("your own: --method module:Class (docs/reference/methods.md)")
    return 0
