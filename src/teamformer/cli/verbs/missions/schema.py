"""`teamformer schema`: the JSON Schema of mission files, for editors."""

from __future__ import annotations

from teamformer.files.schema import schema_text


def schema() -> int:
    """Print the schema; return the exit status."""
    print(schema_text(), end="")
    return 0
