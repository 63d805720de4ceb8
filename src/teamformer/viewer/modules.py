"""Joins the modules of a page into the one script that the page holds."""

from __future__ import annotations

import posixpath
import re
from collections import Counter
from functools import cache
from importlib.resources import files

_IMPORT = re.compile(r'^import \{[^}]*\} from "([^"]+)";\n', re.MULTILINE)
_EXPORT = re.compile(r"^export (?=(?:async function|function|class|const|let) )", re.MULTILINE)
_NAME = re.compile(r"^(?:async )?(?:function|class|const|let) (\w+)", re.MULTILINE)


@cache
def joined(*openers: str) -> str:
    """Return modules such as `live/main` and all that they import, as one script.

    A module comes after those that it imports, so nothing is left to be imported, and whoever reads
    the page finds the code as it is written.
    """
    found = (page_file(f"{name}.js") for name in names_in_order(*openers))
    texts = [_EXPORT.sub("", _IMPORT.sub("", text)) for text in found]
    counts = Counter(name for text in texts for name in _NAME.findall(text))
    twice = [name for name, count in counts.items() if count > 1]
    assert not twice, f"these names stand in several modules of a page: {', '.join(twice)}"
    return "\n".join(texts)


def names_in_order(*openers: str) -> list[str]:
    """Return the names of modules and of all that they import, each after those that it imports."""
    order: list[str] = []
    for name in openers:
        _add(name, order, ())
    return order


def _add(name: str, order: list[str], importers: tuple[str, ...]) -> None:
    assert name not in importers, f"these modules import one another: {', '.join(importers)}"
    if name in order:
        return
    for path in _IMPORT.findall(page_file(f"{name}.js")):
        imported = posixpath.normpath(posixpath.join(posixpath.dirname(name), path))
        _add(imported.removesuffix(".js"), order, (*importers, name))
    order.append(name)


def page_file(name: str) -> str:
    """Return the text of a file of the page."""
    return (files("teamformer.viewer") / "page" / name).read_text(encoding="utf-8")
