"""Fields' comments as their documentation, which is how this code says what a field holds."""

from __future__ import annotations

import ast
from typing import Any

from griffe import Attribute, Docstring, Extension


class Comments(Extension):
    """Takes what stands behind a field, after `#`, for its docstring if it has none."""

    def on_attribute_instance(self, *, attr: Attribute, **_: Any) -> None:
        """Give a field the comment at the end of its line."""
        if attr.docstring is not None or attr.lineno is None:
            return
        line = attr.lines_collection[attr.filepath][(attr.endlineno or attr.lineno) - 1]
        code, sign, comment = line.partition("  # ")
        if sign and _is_whole(code):
            attr.docstring = Docstring(comment.strip(), parent=attr)


def _is_whole(code: str) -> bool:
    """Say whether a line is code as it stands, so that what follows it is a comment."""
    try:
        ast.parse(code.strip())
    except SyntaxError:
        return code.strip() == ")"
    return True
