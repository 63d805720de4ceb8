"""`teamformer policies`: what can be named with --policy."""

from __future__ import annotations

from rich.table import Table

from teamformer.commands.console import out, print_json
from teamformer.policies import POLICIES


def policies(as_json: bool) -> int:
    """List the policies; return the exit status."""
    if as_json:
        for listing in POLICIES:
            print_json(
                {
                    "name": listing.name,
                    "summary": listing.summary,
                    "trained_on": listing.trained_on,
                }
            )
        return 0
    table = Table(box=None, header_style="dim")
    table.add_column("name", no_wrap=True)
    table.add_column("what it does", overflow="fold")
    table.add_column("trained on", overflow="fold")
    for listing in POLICIES:
        table.add_row(listing.name, listing.summary, listing.trained_on)
    out.print(table)
    out.print("your own: --policy module:Class (docs/policies.md)")
    return 0
