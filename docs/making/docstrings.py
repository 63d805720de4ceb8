"""Docstrings as the site shows them: examples as code, and fields' comments as their text."""

from __future__ import annotations

import ast
import re
from typing import Any

from griffe import Attribute, Docstring, Extension, Object

EXAMPLE = re.compile(r"^>>> .*?(?=\n[ \t]*\n|\Z)", re.DOTALL | re.MULTILINE)
PAGE = re.compile(r"docs/([\w-]+/)([\w-]+)\.md")


class AsTheSiteShowsThem(Extension):
    """Changes docstrings when the code has been read."""

    def on_object(self, *, obj: Object, **_: Any) -> None:
        """Put fences around examples, and links where pages are named (from reference/)."""
        if obj.docstring is not None:
            text = EXAMPLE.sub(lambda found: f"```pycon\n{found[0]}\n```", obj.docstring.value)
            obj.docstring.value = PAGE.sub(r"[\2](../\1\2.md)", text)

    def on_attribute(self, *, attr: Attribute, **_: Any) -> None:
        """Give a field without a docstring the comment at the end of its line."""
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
