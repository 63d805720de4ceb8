"""What the site has beside the written pages: examples, notebooks, and every verb's flags."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import typer
from mkdocs.structure.files import File, Files

ROOT = Path(__file__).parents[2]
PLACE = "<!-- every command -->"


def on_files(files: Files, config: Any) -> Files:
    """Add the examples, so that a page may link to them, and a page for each notebook."""
    for path in sorted((ROOT / "examples").rglob("*")):
        if path.suffix in (".yaml", ".ipynb"):
            name = path.relative_to(ROOT).as_posix()
            files.append(File.generated(config, name, abs_src_path=str(path)))
        if path.suffix == ".ipynb":
            page = f"notebooks/{path.stem}.md"
            files.append(File.generated(config, page, content=page_of_notebook(path)))
    return files


def page_of_notebook(path: Path) -> str:
    """Return a notebook as a page: its text, its code, and what each cell printed."""
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    title, *rest = (part for cell in cells for part in _parts(cell))
    head, _, text = title.partition("\n")
    whole = f"[This notebook](../examples/notebooks/{path.name}) with what it printed."
    return "\n\n".join([head, whole, text.strip(), *rest]) + "\n"


def _parts(cell: dict[str, Any]) -> list[str]:
    source = "".join(cell["source"])
    if cell["cell_type"] == "markdown":
        return [re.sub(r"`docs/([\w-]+/)([\w-]+)\.md`", r"[\2](../\1\2.md)", source)]
    parts = [f"```python\n{source}\n```"]
    if cell["metadata"].get("page"):
        parts.append("*The page appears here when you run the notebook.*")
    printed = "".join("".join(_printed(output)) for output in cell["outputs"]).strip("\n")
    return [*parts, f"```text\n{printed}\n```"] if printed else parts


def _printed(output: dict[str, Any]) -> list[str]:
    return output.get("text") or output.get("data", {}).get("text/plain", [])


def on_page_markdown(markdown: str, page: Any, config: Any, files: Files) -> str:
    """Return a page with links to the examples as the site has them, and with all commands."""
    notebook = r"\]\(((?:\.\./)*)\.\./examples/notebooks/([\w-]+)\.ipynb\)"
    if not page.file.src_uri.startswith("notebooks/"):
        markdown = re.sub(notebook, r"](\1notebooks/\2.md)", markdown)
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
