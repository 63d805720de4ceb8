"""What the documents show must run, and what they point to must be there."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
import typer

from teamformer.cli.app import app

ROOT = Path(__file__).parent.parent
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]


FENCED = re.compile(r'```python(?: title="(?P<file>\w+\.py)")?[^\n]*\n(?P<code>.*?)```', re.DOTALL)
"""A block of Python; with a title it is a file, from which later blocks of the page import."""


def python_blocks() -> list[tuple[str, str]]:
    blocks = []
    for page in PAGES:
        if page.parent.name == "tutorials":  # test_tutorials.py runs these, block after block
            continue
        found = FENCED.finditer(page.read_text(encoding="utf-8"))
        blocks += [(f"{page.name}-{number}", block["code"]) for number, block in enumerate(found)]
    return blocks


def write_files(name: str, folder: Path) -> None:
    """Write the blocks with a title of the page that a block is from."""
    page = next(page for page in PAGES if page.name == name.rpartition("-")[0])
    for block in FENCED.finditer(page.read_text(encoding="utf-8")):
        if block["file"]:
            (folder / block["file"]).write_text(block["code"], encoding="utf-8")


@pytest.mark.parametrize(("name", "code"), python_blocks(), ids=lambda value: value[:24])
@pytest.mark.thorough
def test_python_in_the_documents_runs(
    name: str, code: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    monkeypatch.chdir(tmp_path)
    write_files(name, tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    exec(compile(code, name, "exec"), {"__name__": name})


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page: Path) -> None:
    for target in re.findall(r"\]\(([^)#]+)[^)]*\)", page.read_text(encoding="utf-8")):
        if not target.startswith("http"):
            assert (page.parent / target).exists(), target


def shown_commands() -> list[tuple[str, list[str]]]:
    """Return the words of each `teamformer` command that a document shows, with its page."""
    found = []
    for page in PAGES:
        text = page.read_text(encoding="utf-8").replace("\\\n", " ")
        blocks = re.findall(r"```(?:sh|console)?\n(.*?)```", text, re.DOTALL)
        indented = re.findall(r"^    (teamformer .*)$", text, re.MULTILINE)
        lines = [line for block in blocks for line in block.splitlines()] + indented
        for line in lines:
            if line.startswith(("teamformer ", "$ teamformer ")):
                words = line.removeprefix("$ ").partition("#")[0].split()
                found.append((page.name, words[1:]))
    return found


def test_commands_in_the_documents_are_understood() -> None:
    """Each has a verb, the arguments that it must have, and only options that there are."""
    shown = shown_commands()
    assert len(shown) > 30
    for page, words in shown:
        verb: Any = typer.main.get_command(app)
        rest = words
        while hasattr(verb, "commands"):
            assert rest, (page, words)
            assert rest[0] in verb.commands, (page, words)
            verb, rest = verb.commands[rest[0]], rest[1:]
        verb.make_context(words[0], list(rest))  # raises what a user would be told


def test_verbs_named_in_the_text_are_verbs() -> None:
    verbs = typer.main.get_command(app).commands  # type: ignore[attr-defined]
    named = 0
    for page in PAGES:
        for code in re.findall(r"`teamformer ([^`]+)`", page.read_text(encoding="utf-8")):
            words = code.split()
            if not words[0].startswith("--"):
                named += 1
                assert words[0] in verbs, (page.name, code)
                commands = getattr(verbs[words[0]], "commands", None)
                assert commands is None or words[1:2] == [] or words[1] in commands, code
    assert named > 20
