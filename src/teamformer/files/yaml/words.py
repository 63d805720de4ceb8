"""What a plain word of a YAML file means, and how values are named to people."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

import yaml

HUGE = 10**15

WHOLE = re.compile(r"[-+]?(0|[1-9]\d{0,14})", re.ASCII)
REAL = re.compile(r"[-+]?((0|[1-9]\d*)(\.\d*)?|\.\d+)([eE][-+]?\d+)?", re.ASCII)
SPECIAL = re.compile(r"[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)")


@dataclass(frozen=True)
class Misread:
    """A plain word that YAML takes for something else than text: `no`, `12:30`, `0x1F`.

    `language` is what the file is called, for those who are told.
    """

    text: str
    kind: str
    language: str = "YAML"


def scalar(text: str, language: str = "YAML") -> Any:
    """Return what a word without quotes means: a text, a number, None, or a `Misread`."""
    if WHOLE.fullmatch(text):
        return int(text)
    if REAL.fullmatch(text):
        return float(text)
    if SPECIAL.fullmatch(text):
        return float(text.replace(".", ""))
    kind = _KINDS.get(_RESOLVER.resolve(yaml.ScalarNode, text, (True, False)))
    if kind == "nothing":
        return None
    return Misread(text, kind, language) if kind else text


_RESOLVER: Any = yaml.resolver.Resolver()
_KINDS = {
    "tag:yaml.org,2002:bool": "true or false",
    "tag:yaml.org,2002:int": "a number",
    "tag:yaml.org,2002:float": "a number",
    "tag:yaml.org,2002:null": "nothing",
    "tag:yaml.org,2002:timestamp": "a date",
    "tag:yaml.org,2002:merge": "a merge",
}


def misread(text: str, kind: str, language: str) -> str:
    """Say that a language does not take a word for a name."""
    shown = shorten(text) or "an empty value"
    return f"{language} reads {shown} as {kind}; put it in quotes to make it a name"


def kind_of(value: Any) -> str:
    """Name the kind of a value for people."""
    if isinstance(value, Misread):
        return value.kind
    kinds = {
        type(None): "nothing",
        bool: "true or false",
        int: "a number",
        float: "a number",
        str: "a text",
        list: "a list",
        dict: "a mapping",
    }
    return kinds.get(type(value), type(value).__name__)


def shorten(text: str) -> str:
    """Return a text that fits into a message."""
    shown = text if len(text) <= 40 else f"{text[:40]}..."
    return "".join(letter if letter.isprintable() else "?" for letter in shown)


def describe(value: Any) -> str:
    """Show a value to people if it is short, else name its kind."""
    if isinstance(value, Misread):
        return f"{shorten(value.text)} (for {value.language} {value.kind})"
    if isinstance(value, str) and value:
        return f"the text '{shorten(value)}'"
    if isinstance(value, float) or (isinstance(value, int) and abs(value) < HUGE):
        return str(value).lower()
    return kind_of(value)
