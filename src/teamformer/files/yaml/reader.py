"""YAML and JSON as plain trees that remember their lines, with what is wrong told by line.

Read from the parser's events, so that nothing but mappings, lists and scalars is ever built and a
file that is deep, or refers to itself, is stopped before it costs anything.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import yaml
from yaml import events as ev

from teamformer.base.errors import Problem
from teamformer.files.yaml.words import Misread, kind_of, misread, scalar, shorten

Where = tuple[str | int, ...]
"""The path to a place in a tree, such as `("tasks", 3, "needs")`."""

DEEPEST = 12
MOST_PROBLEMS = 1000
LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)  # libyaml is ten times as fast

STRING = "tag:yaml.org,2002:str"
UNPRINTABLE = re.compile(r"[^\t\n\r\x20-\x7e\x85\xa0-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


@dataclass
class Tree:
    """What a file says: plain values, the line of each place, and what is wrong with it."""

    value: Any = None
    is_from_text: bool = False  # and has lines therefore
    language: str = "YAML"
    lines: dict[Where, int] = field(default_factory=dict)
    problems: list[tuple[int, Problem]] = field(default_factory=list)

    def line(self, where: Where) -> int:
        """Return the line of a place, or of the nearest place around it that is in the file."""
        while where and where not in self.lines:
            where = where[:-1]
        return self.lines.get(where, 1)

    def refuse(self, where: Where, message: str, line: int | None = None) -> None:
        """Note that something is wrong at a place; one too many raises `StopReadingError`."""
        self.problems.append((line or self.line(where), Problem(where, message)))
        if len(self.problems) >= MOST_PROBLEMS:
            raise StopReadingError


class StopReadingError(Exception):
    """The rest of the file is not worth reading; its problems are in the tree."""


def parse(text: str, language: str = "YAML") -> Tree:
    """Read YAML into a tree; syntax errors become its problems.

    `language` is what the text claims to be, if it is one that YAML holds.
    """
    tree = Tree(is_from_text=True, language=language)
    strange = UNPRINTABLE.search(text)
    if strange:
        line = text.count("\n", 0, strange.start()) + 1
        code = f"U+{ord(strange.group()):04X}"
        tree.refuse((), f"the character {code} cannot stand in a text file; remove it", line)
        return tree
    try:
        tree.value = _Builder(text, tree).document()
    except yaml.MarkedYAMLError as error:
        tree.refuse((), *_syntax_problem(text, error, language))
    except yaml.YAMLError as error:
        tree.refuse((), " ".join(f"this is not {language}: {error}".split()))
    except StopReadingError:
        pass
    return tree


def parse_json(text: str) -> Tree:
    """Read JSON into a tree: YAML but for tabs and for letters written as two halves."""
    return parse(_SURROGATES.sub(_join_surrogates, text.replace("\t", " ")), "JSON")


_SURROGATES = re.compile(r"\\\\|\\u(d[89ab][0-9a-f]{2})\\u(d[c-f][0-9a-f]{2})", re.IGNORECASE)


def _join_surrogates(match: re.Match[str]) -> str:
    if match.group(1) is None:  # an escaped backslash: what follows is no escape
        return match.group()
    high, low = (int(match.group(half), 16) for half in (1, 2))
    return chr(0x10000 + ((high - 0xD800) << 10) + low - 0xDC00)


def from_value(value: Any) -> Tree:
    """Return a tree of values that come from no file and so have no lines."""
    return Tree(value)


def _syntax_problem(text: str, error: yaml.MarkedYAMLError, language: str) -> tuple[str, int]:
    mark = error.problem_mark or error.context_mark
    row, column = (mark.line, mark.column) if mark else (0, 0)
    lines = text.splitlines()
    found = lines[row][column : column + 1] if row < len(lines) else ""
    layout = "indentation" if language == "YAML" else "commas"
    advice = f"check quotes, brackets and {layout} here and above"
    if found == "\t":
        advice = "indent with spaces, not tabs"
    elif found and found in "@`%":
        advice = f"put a text that begins with {found} in quotes"
    begun = error.context_mark
    since = f" ({error.context}, begun on line {begun.line + 1})" if begun and error.context else ""
    what = f"this is not {language}: {error.problem or error.context}{since}"
    return f"{what}; {advice}", row + 1


class _Builder:
    """Turns the parser's events into values, noting lines and problems in the tree."""

    def __init__(self, text: str, tree: Tree) -> None:
        self.events: Iterator[Any] = yaml.parse(text, Loader=LOADER)
        self.tree = tree

    def document(self) -> Any:
        next(self.events)  # the stream begins
        if isinstance(next(self.events), ev.StreamEndEvent):
            self.tree.refuse((), "the file is empty; write a mission into it")
            return None
        value = self.value(next(self.events), ())
        next(self.events)  # the document ends
        event = next(self.events)
        if not isinstance(event, ev.StreamEndEvent):
            self.refuse(event, (), "a second document begins here; keep one a file")
        return value

    def value(self, event: Any, where: Where) -> Any:
        self.tree.lines.setdefault(where, _line(event))
        if len(where) > DEEPEST:
            self.refuse(event, where, f"this is nested deeper than {DEEPEST} levels; flatten it")
            raise StopReadingError
        if isinstance(event, ev.AliasEvent):
            name = shorten(str(event.anchor))
            self.refuse(event, where, f"*{name} is not followed; write the value out")
            return None
        if event.tag not in (None, "!", STRING):
            self.refuse(event, where, f"the tag {shorten(event.tag)} is not understood; remove it")
        if isinstance(event, ev.MappingStartEvent):
            return self.mapping(where)
        if isinstance(event, ev.SequenceStartEvent):
            return self.sequence(where)
        return self.scalar(event)

    def scalar(self, event: Any) -> Any:
        is_plain = event.tag is None and event.implicit[0]
        return scalar(event.value, self.tree.language) if is_plain else event.value

    def sequence(self, where: Where) -> list[Any]:
        values: list[Any] = []
        while not isinstance(event := next(self.events), ev.SequenceEndEvent):
            values.append(self.value(event, (*where, len(values))))
        return values

    def mapping(self, where: Where) -> dict[str, Any]:
        values: dict[str, Any] = {}
        while not isinstance(event := next(self.events), ev.MappingEndEvent):
            key = self.key(event, where)
            if key is None:
                self.value(next(self.events), (*where, "?"))  # skip it
                continue
            is_repeated = key in values
            if is_repeated:
                again = f"'{shorten(key)}' stands here a second time"
                first = self.tree.line((*where, key))
                self.refuse(event, (*where, key), f"{again}, first on line {first}; keep one")
            self.tree.lines.setdefault((*where, key), _line(event))
            value = self.value(next(self.events), (*where, key))
            if not is_repeated:
                values[key] = value
        return values

    def key(self, event: Any, where: Where) -> str | None:
        """Return the text of a key, or None for one that cannot be."""
        if not isinstance(event, ev.ScalarEvent):
            self.refuse(event, where, "a list or mapping stands where a name belongs; name it")
            self.value(event, (*where, "?"))  # skip it
            return None
        value = self.scalar(event)
        if isinstance(value, Misread) and value.kind == "a merge":
            self.refuse(event, where, "<< is not followed; write the keys out")
            return None
        if not isinstance(value, str):
            said = misread(event.value, kind_of(value), self.tree.language)
            self.refuse(event, where, said)
        return str(event.value)

    def refuse(self, event: Any, where: Where, message: str) -> None:
        self.tree.refuse(where, message, _line(event))


def _line(event: Any) -> int:
    return int(event.start_mark.line) + 1
