"""What messages and hints in the source name is there: commands, flags, methods, functions."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import typer

import teamformer
from teamformer.cli import app
from teamformer.methods.listings import our_method_names
from test_command_line import verbs_of

SOURCE = Path(teamformer.__file__).parent
VERBS = {
    name: {flag for param in verb.params for flag in param.opts}
    for name, verb in verbs_of(typer.main.get_command(app))
}
FOREIGN = {"--upgrade", "--no-deps", "--target", "--system-site-packages"}
"""Flags of pip and others."""


def told(node: ast.AST) -> str:
    """Return a text of the source; what is put into it is `{}`."""
    if isinstance(node, ast.JoinedStr):
        return "".join(told(part) or "{}" for part in node.values)
    is_text = isinstance(node, ast.Constant) and isinstance(node.value, str)
    return node.value if is_text else ""


def texts() -> Iterator[tuple[str, str]]:
    """Yield where each text of the source is, and the text; docstrings too."""
    for path in sorted(SOURCE.rglob("*.py")):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        parts = {id(part) for node in ast.walk(tree) if isinstance(node, ast.JoinedStr)
                 for part in node.values}  # fmt: skip
        for node in ast.walk(tree):
            if id(node) not in parts and (text := told(node)):
                yield f"{path.relative_to(SOURCE)}:{node.lineno}", text


TEXTS = list(texts())
OWN = {text for _, text in TEXTS if re.fullmatch("--[a-z-]+", text)}
"""Those that modules have which are called by themselves."""

FLAGS = FOREIGN.union({"--help"}, OWN, *VERBS.values())


def test_texts_are_found() -> None:
    assert any("`teamformer generate -o FILE`" in text for _, text in TEXTS)
    assert len(TEXTS) > 5000


def test_commands_that_messages_name_are_there_with_their_flags() -> None:
    unknown = []
    for where, text in TEXTS:
        for words in (command.split() for command in re.findall(r"`teamformer ([^`]+)`", text)):
            two = " ".join(words[:2])
            name = two if two in VERBS else words[0]
            flags = {word.split("=")[0] for word in words if word.startswith("-")} - {"--help"}
            if name == "{}":
                continue
            if name not in VERBS and not any(verb.startswith(f"{name} ") for verb in VERBS):
                unknown.append((where, name))
            elif name in VERBS and not flags <= VERBS[name]:
                unknown.append((where, f"{name} {flags - VERBS[name]}"))
    assert unknown == []


def test_flags_that_messages_name_are_there() -> None:
    named = (
        (where, flag)
        for where, text in TEXTS
        for flag in re.findall(r"(?<![\w-])--[a-z][a-z-]+", text)
    )
    assert [it for it in named if it[1] not in FLAGS] == []


def test_methods_that_messages_name_are_there() -> None:
    names = {*our_method_names(), "module", "and"}
    named = (
        (where, name) for where, text in TEXTS for name in re.findall(r"--method ([\w-]+)", text)
    )
    assert [it for it in named if it[1] not in names] == []


def test_functions_that_messages_name_are_there() -> None:
    named = ((where, name) for where, text in TEXTS for name in re.findall(r"\btf\.(\w+)", text))
    assert [it for it in named if it[1] not in teamformer.__all__] == []
