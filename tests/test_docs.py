"""What the documents show must run, and what they point to must be there."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import typer

from teamformer.cli.app import app

ROOT = Path(__file__).parent.parent
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]


def python_blocks() -> list[tuple[str, str]]:
    blocks = []
    for page in PAGES:
        code = re.findall(r"```python\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)
        blocks += [(f"{page.name}-{number}", block) for number, block in enumerate(code)]
    return blocks


@pytest.mark.parametrize(("name", "code"), python_blocks(), ids=lambda value: value[:24])
def test_python_in_the_documents_runs(
    name: str, code: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    monkeypatch.chdir(tmp_path)
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


def test_commands_in_the_documents_have_the_options_that_they_show() -> None:
    verbs = typer.main.get_command(app).commands  # type: ignore[attr-defined]
    shown = shown_commands()
    assert len(shown) > 30
    for page, (verb, *words) in shown:
        known = {option for param in verbs[verb].params for option in param.opts}
        asked = {word for word in words if word.startswith("-")}
        assert asked <= known, (page, verb, asked - known)
