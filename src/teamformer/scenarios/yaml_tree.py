"""YAML and JSON as plain trees that remember their lines, with what is wrong told by line.

Nothing but mappings, lists and scalars is ever built, whatever the file says.
"""

from __future__ import annotations

import datetime
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import yaml

Where = tuple[str | int, ...]
"""The path to a place in a tree, such as `("tasks", 3, "needs")`."""

DEEPEST = 20


@dataclass
class Tree:
    """What a file says: plain values, and the line of each place."""

    value: Any = None
    lines: dict[Where, int] = field(default_factory=dict)
    problems: list[tuple[int, str]] = field(default_factory=list)

    def line(self, where: Where) -> int:
        """Return the line of a place, or of the nearest place around it that is in the file."""
        while where and where not in self.lines:
            where = where[:-1]
        return self.lines.get(where, 1)


def parse(text: str) -> Tree:
    """Read YAML (JSON is YAML too) into a tree; syntax errors become its problems."""
    tree = Tree()
    try:
        documents = list(yaml.compose_all(text, Loader=yaml.SafeLoader))
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line = mark.line + 1 if mark else 1
        tree.problems.append((line, f"this is not YAML: {error.problem or error.context}"))
        return tree
    except yaml.YAMLError as error:
        tree.problems.append((1, f"this is not YAML: {_first_line(error)}"))
        return tree
    except RecursionError:
        tree.problems.append((1, f"this is nested deeper than {DEEPEST} levels; flatten it"))
        return tree
    if not documents or documents[0] is None:
        tree.problems.append((1, "the file is empty; write a scenario into it"))
    elif len(documents) > 1:
        line = documents[1].start_mark.line + 1
        tree.problems.append((line, "a second document begins here; keep one a file"))
    else:
        tree.value = _build(documents[0], (), tree, set())
    return tree


def from_value(value: Any) -> Tree:
    """Return a tree of values that come from no file, all on line 1."""
    return Tree(value)


def _first_line(error: Exception) -> str:
    return str(error).splitlines()[0] if str(error) else type(error).__name__


def _build(node: yaml.Node, where: Where, tree: Tree, around: set[int]) -> Any:
    line = node.start_mark.line + 1
    tree.lines[where] = line
    if id(node) in around or len(where) > DEEPEST:
        tree.problems.append((line, f"this is nested deeper than {DEEPEST} levels; flatten it"))
        return None
    inside = around | {id(node)}
    if isinstance(node, yaml.MappingNode):
        return dict(_pairs(node, where, tree, inside))
    if isinstance(node, yaml.SequenceNode):
        return [_build(part, (*where, i), tree, inside) for i, part in enumerate(node.value)]
    return _scalar(node, line, tree)


def _pairs(
    node: yaml.MappingNode, where: Where, tree: Tree, around: set[int]
) -> Iterator[tuple[str, Any]]:
    seen: dict[str, int] = {}
    for key_node, value_node in node.value:
        line = key_node.start_mark.line + 1
        key = _key(key_node, line, tree)
        if key is None:
            continue
        if key in seen:
            tree.problems.append(
                (line, f"'{key}' stands here a second time, first on line {seen[key]}; keep one")
            )
            continue
        seen[key] = line
        value = _build(value_node, (*where, key), tree, around)
        tree.lines[(*where, key)] = line
        yield key, value


def _key(node: yaml.Node, line: int, tree: Tree) -> str | None:
    if not isinstance(node, yaml.ScalarNode):
        tree.problems.append((line, "a list or mapping stands where a name belongs"))
        return None
    if node.tag != "tag:yaml.org,2002:str":
        tree.problems.append((line, misread(node.value, _kind(node))))
        return None
    return str(node.value)


def _scalar(node: yaml.Node, line: int, tree: Tree) -> Any:
    try:
        value = yaml.SafeLoader("").construct_object(node)
    except (yaml.YAMLError, ValueError, OverflowError) as error:
        tree.problems.append((line, f"'{node.value}' cannot be read: {_first_line(error)}"))
        return None
    if isinstance(value, str) or value is None or isinstance(value, bool | int | float):
        return Misread(value, node.value) if _is_surprising(value, node) else value
    return Misread(value, node.value)


class Misread:
    """A plain word that YAML takes for something else: `no` for false, `12:30` for 750."""

    def __init__(self, value: Any, text: str) -> None:
        self.value = value
        self.text = text

    def __repr__(self) -> str:
        return self.text

    @property
    def kind(self) -> str:
        """Say what YAML made of it."""
        return describe(self.value)


def _is_surprising(value: Any, node: yaml.Node) -> bool:
    if isinstance(value, bool):
        return node.value.lower() not in ("true", "false")
    return isinstance(value, int | float) and not isinstance(value, bool) and ":" in node.value


def _kind(node: yaml.ScalarNode) -> str:
    return {
        "tag:yaml.org,2002:bool": "true or false",
        "tag:yaml.org,2002:int": "a number",
        "tag:yaml.org,2002:float": "a number",
        "tag:yaml.org,2002:null": "nothing",
        "tag:yaml.org,2002:timestamp": "a date",
    }.get(node.tag, "something else than text")


def misread(text: str, kind: str) -> str:
    """Say that YAML does not take a word for a name."""
    return f"YAML reads {text or 'an empty value'} as {kind}; put it in quotes to make it a name"


def describe(value: Any) -> str:
    """Name the kind of a value for people."""
    if isinstance(value, Misread):
        return f"{value.text} (for YAML {value.kind})"
    if isinstance(value, bool):
        return "true or false"
    if value is None:
        return "nothing"
    if isinstance(value, int | float):
        return "a number"
    if isinstance(value, str):
        return "a text"
    if isinstance(value, list):
        return "a list"
    if isinstance(value, dict):
        return "a mapping"
    if isinstance(value, datetime.date | datetime.datetime):
        return "a date"
    return type(value).__name__
