"""`teamformer view`: the page of a recorded trial, or of several in step."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from teamformer.base.errors import TeamformerError
from teamformer.cli.terminal.console import prepare_file, say
from teamformer.record.files.reading import read_record
from teamformer.record.files.writing import record_to_tree
from teamformer.viewer.html import write_comparison, write_page

PAGES = (".html", ".htm")


def view(files: Sequence[Path]) -> int:
    """Write the page of records; return the exit status.

    The page is the last file if it ends as a page does, else it goes beside the first record.
    """
    records = list(files)
    page = records.pop() if records[-1].suffix.lower() in PAGES else None
    if not records:
        raise TeamformerError(f"{page}: a page is made of a record", "name a record.json before it")
    page = page or records[0].with_suffix(".html")
    trees = [record_to_tree(read_record(record)) for record in records]
    prepare_file(page)
    if len(trees) == 1:
        write_page(trees[0], page)
    else:
        write_comparison(trees, page)
    say(f"page: {page}")
    return 0
