"""The text of a mission's file."""

from __future__ import annotations

import re
from typing import Any

from teamformer.files.yaml.writer import to_text

ROW = re.compile(r'^    - "([.@#]+)"$', re.MULTILINE)


def text_of(tree: dict[str, Any]) -> str:
    """Return a tree as YAML; a map that is a block of text stays one."""
    rows = tree["world"].get("rows")
    if not isinstance(rows, str):
        return to_text(tree)
    listed = to_text(tree | {"world": tree["world"] | {"rows": rows.split("\n")}})
    return ROW.sub(r"    \1", listed).replace("  rows:\n", "  rows: |\n")
