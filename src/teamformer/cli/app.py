"""The app that verbs are registered with, and the flags that several of them have."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

app = typer.Typer(
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    help="Teams of robots that form, split and share out tasks by themselves.",
)

MissionPath = Annotated[Path, typer.Argument(metavar="MISSION", help="a mission file")]
RecordPath = Annotated[Path, typer.Argument(metavar="RECORD", help="a record.json")]
AsJson = Annotated[bool, typer.Option("--json", help="print JSON")]
Seed = Annotated[int, typer.Option(min=0, help="of all randomness")]
Method = Annotated[
    str | None,
    typer.Option(
        help="how it is solved; see `methods`; else plan, or crews if the mission is too large"
    ),
]
TimeLimit = Annotated[
    float, typer.Option(min=0, help="seconds for the method central; others ignore it")
]
Port = Annotated[
    str,
    typer.Option(
        metavar="[HOST:]PORT", help="where to serve the page; elsewhere than here with a token"
    ),
]
Host = Annotated[
    str,
    typer.Option(
        metavar="NAMES",
        help="further names, commas between, that a tunnel or proxy serves the page under",
    ),
]
Foxglove = Annotated[
    int | None,
    typer.Option(metavar="PORT", min=1, max=65535, help="port to serve it on to Foxglove"),
]
Webhook = Annotated[
    str, typer.Option(metavar="URL", help="POST a JSON object there for each alert")
]
Folder = Annotated[Path, typer.Option(help="folder that the record is saved in")]


def _show_version(is_wanted: bool) -> None:
    if is_wanted:
        from importlib.metadata import version

        print(f"teamformer {version('teamformer')}")
        raise typer.Exit


@app.callback()
def _every_verb(
    version: Annotated[
        bool, typer.Option("--version", callback=_show_version, is_eager=True, help="show it")
    ] = False,
) -> None:
    """Teams of robots that form, split and share out tasks by themselves."""


def is_given(context: typer.Context, name: str) -> bool:
    """Say whether a flag stands on the command line."""
    source = context.get_parameter_source(name)
    return source is not None and source.name == "COMMANDLINE"


def split_names(names: str) -> tuple[str, ...]:
    """Return the names that stand with commas between them."""
    return tuple(name.strip() for name in names.split(",") if name.strip())
