"""A file written anew as its tree has become, with the comments and the layout that it had."""

from __future__ import annotations

import io
import re
from collections.abc import Mapping
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap, CommentedSeq
from ruamel.yaml.error import YAMLError
from ruamel.yaml.scalarstring import DoubleQuotedScalarString

from teamformer.files.yaml import reader, writer

WIDE = 10_000  # columns: no line is folded that was not
INDENTED = re.compile(r"^\w+:[^\n]*\n  - ", re.MULTILINE)
"""Entries of a list that stand further right than its key."""


def rewrite(text: str, tree: Mapping[str, Any]) -> str | None:
    """Return a YAML text changed so that it holds a tree; None if it cannot be done by changes.

    What stays as it was keeps its comments, its quotes and its place; robots and tasks are known by
    their names. The result is read again before it is trusted.
    """
    yaml = YAML()
    yaml.width, yaml.preserve_quotes = WIDE, True
    if INDENTED.search(text):
        yaml.indent(mapping=2, sequence=4, offset=2)
    try:
        document = yaml.load(text)
        if not isinstance(document, CommentedMap):
            return None
        _update_mapping(document, tree)
        out = io.StringIO()
        yaml.dump(document, out)
    except YAMLError:
        return None
    written = out.getvalue()
    return written if reader.parse(written).value == dict(tree) else None


def _update_mapping(mapping: CommentedMap, tree: Mapping[str, Any]) -> None:
    for key in [key for key in mapping if key not in tree]:
        del mapping[key]
    for key, value in tree.items():
        mapping[key] = _updated(mapping.get(key), value)


def _updated(old: Any, new: Any) -> Any:
    """Return a value as it is to be written: the old one changed where it is of the same kind."""
    if isinstance(old, CommentedMap) and isinstance(new, Mapping):
        _update_mapping(old, new)
        return old
    if isinstance(old, CommentedSeq) and isinstance(new, list):
        return _updated_list(old, new)
    if old == new and type(old) is not bool:
        return old  # with its quotes, and numbers as they were written
    return _laid_out(new)


def _updated_list(old: CommentedSeq, new: list[Any]) -> Any:
    """Change a list: entries with names stay with them, others with their places."""
    names = [_name(entry) for entry in new]
    if None not in names:
        for place in reversed(range(len(old))):
            if _name(old[place]) not in names:
                del old[place]
    if [_name(entry) for entry in old] != names[: len(old)]:
        return _laid_out(new)  # in another order: comments would be at other entries
    del old[len(new) :]
    for place, value in enumerate(new):
        if place < len(old):
            old[place] = _updated(old[place], value)
        else:
            old.append(_laid_out(value, is_entry=True))
    return old


def _name(entry: Any) -> Any:
    return entry.get("name") if isinstance(entry, Mapping) else None


def _laid_out(value: Any, is_entry: bool = False) -> Any:
    """Return a new value laid out as people write it: pairs, counts and entries in a line each."""
    if isinstance(value, Mapping):
        mapping = CommentedMap({key: _laid_out(part) for key, part in value.items()})
        if is_entry or not any(isinstance(part, (Mapping, list)) for part in value.values()):
            mapping.fa.set_flow_style()
        return mapping
    if isinstance(value, list):
        are_large = any(isinstance(part, Mapping) for part in value)
        sequence = CommentedSeq([_laid_out(part, is_entry=are_large) for part in value])
        if not are_large and not any(isinstance(part, str) and "#" in part for part in value):
            sequence.fa.set_flow_style()
        return sequence
    if isinstance(value, str) and writer.to_text({"text": value}) != f"text: {value}\n":
        return DoubleQuotedScalarString(value)
    return value
