"""What the site has beside the pages as they are written: examples, and every verb's flags."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import typer
from mkdocs.structure.files import File, Files

ROOT = Path(__file__).parents[2]
PLACE = "<!-- every command -->"


def on_files(files: Files, config: Any) -> Files:
    """Add the examples, so that a page may link to them."""
    for path in sorted((ROOT / "examples").rglob("*")):
        if path.suffix in (".yaml", ".ipynb"):
            name = path.relative_to(ROOT).as_posix()
            files.append(File.generated(config, name, abs_src_path=str(path)))
    return files


def on_page_markdown(markdown: str, page: Any, config: Any, files: Files) -> str:
    """Return a page with links to the examples as the site has them, and with all commands."""
    markdown = re.sub(r"\]\(((?:\.\./)*)\.\./examples/", r"](\1examples/", markdown)
    return markdown.replace(PLACE, every_command()) if PLACE in markdown else markdown


def every_command() -> str:
    """Return a section for each verb: how it is called, what it does, its arguments and flags."""
    from teamformer.cli.app import app

    return "\n\n".join(_sections("teamformer", typer.main.get_command(app)))


def _sections(name: str, command: Any) -> list[str]:
    commands = getattr(command, "commands", None)
    if commands:
        return [part for verb in commands for part in _sections(f"{name} {verb}", commands[verb])]
    context = typer.Context(command, info_name=name)
    called = " ".join([name, *command.collect_usage_pieces(context)])
    records = [one.get_help_record(context) for one in command.params if not one.is_eager]
    rows = [f"| `{_in_cell(left)}` | {_in_cell(right)} |" for left, right in records if left]
    table = "| argument or flag | what it is |\n|---|---|\n" + "\n".join(rows)
    said = command.help.replace("\n\n", "\0").replace("\n", " ").replace("\0", "\n\n")
    return [f"## {name}\n\n```text\n{called}\n```\n\n{said}\n\n{table}"]


def _in_cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|").replace("[", "(").replace("]", ")")
