"""What stays of an earlier report: tables whose rows are not at hand when it is written again."""

from __future__ import annotations

import re
from pathlib import Path

KEPT = "Kept from an earlier report"
MADE_BY = re.compile(r"The version of Teamformer that ran (?:them|the trials): (.+?)\.\s")


def kept_tables(document: Path) -> dict[str, str]:
    """Return the table beneath each heading of a document, and which version made its rows."""
    if not document.exists():
        return {}
    before, *sections = re.split(r"^## (.*)\n", document.read_text("utf-8"), flags=re.MULTILINE)
    made_by = MADE_BY.search(before)
    note = f"{KEPT}; these rows were made by version {made_by[1] if made_by else 'unknown'}.\n\n"
    tables = {}
    for heading, body in zip(sections[::2], sections[1::2], strict=True):
        lines = [line for line in body.splitlines() if line.startswith(("|", KEPT))]
        if any(line.startswith("|") for line in lines):
            kept_before = "\n\n".join([lines.pop(0), ""]) if lines[0].startswith(KEPT) else ""
            tables[heading] = (kept_before or note) + "".join(f"{line}\n" for line in lines)
    return tables
