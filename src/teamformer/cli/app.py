"""The app that verbs are registered with, and the flags that several of them have."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

app = typer.Typer(
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    help="Plan, simulate and run missions in which several robots do one job together.",
)

MissionPath = Annotated[Path, typer.Argument(metavar="MISSION", help="a mission file")]
RecordPath = Annotated[
    Path, typer.Argument(metavar="RECORD", help="a record of a trial, record.json")
]
AsJson = Annotated[bool, typer.Option("--json", help="print the result as JSON")]
Seed = Annotated[int, typer.Option(min=0, help="seed of everything random")]
Method = Annotated[
    str | None,
    typer.Option(
        help="see `teamformer methods`; by default plan, or crews if the mission is too large"
    ),
]
TimeLimit = Annotated[
    float, typer.Option(min=0, help="seconds for --method central; others ignore it")
]
Port = Annotated[
    str,
    typer.Option(
        metavar="[HOST:]PORT",
        help="where to serve the page; a HOST other than this machine needs a token",
    ),
]
Host = Annotated[
    str,
    typer.Option(
        metavar="NAMES",
        help="other names of the page behind a tunnel or proxy, separated by commas",
    ),
]
Foxglove = Annotated[
    int | None,
    typer.Option(
        metavar="PORT", min=1, max=65535, help="serve the mission to Foxglove on this port"
    ),
]
Webhook = Annotated[str, typer.Option(metavar="URL", help="send each alert there as JSON, by POST")]
Folder = Annotated[Path, typer.Option(help="folder to save the record in")]


def _show_version(is_wanted: bool) -> None:
    if is_wanted:
        from importlib.metadata import version

        print(f"teamformer {version('teamformer')}")
        raise typer.Exit


@app.callback()
def _every_verb(
    version: Annotated[
        bool,
        typer.Option("--version", callback=_show_version, is_eager=True, help="show the version"),
    ] = False,
) -> None:
    """Plan, simulate and run missions in which several robots do one job together."""


def is_given(context: typer.Context, name: str) -> bool:
    """Say whether a flag stands on the command line."""
    source = context.get_parameter_source(name)
    return source is not None and source.name == "COMMANDLINE"


def split_names(names: str) -> tuple[str, ...]:
    """Return the names that stand with commas between them."""
    return tuple(name.strip() for name in names.split(",") if name.strip())
