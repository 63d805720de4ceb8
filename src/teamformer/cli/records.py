"""Flags of the verbs on records of trials."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from teamformer.cli.app import AsJson, ReplayPath, app


@app.command()
def check(
    replay: ReplayPath,
    scenario: Annotated[
        Path | None, typer.Option(help="the file that the record must be of")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Judge the record of a trial by the rules alone."""
    from teamformer.commands.records.check import check as command

    raise typer.Exit(command(replay, scenario, as_json))


@app.command()
def view(
    replay: ReplayPath,
    out: Annotated[Path | None, typer.Option("-o", "--out", help="the page to write")] = None,
    as_json: AsJson = False,
) -> None:
    """Write the page of a recorded trial."""
    from teamformer.commands.records.view import view as command

    raise typer.Exit(command(replay, out, as_json))


@app.command()
def export(
    replay: ReplayPath,
    mcap: Annotated[Path | None, typer.Option(help="an MCAP file, for Foxglove")] = None,
    tables: Annotated[
        Path | None, typer.Option("--csv", help="a folder for tables: robots, tasks, events, Gantt")
    ] = None,
    gif: Annotated[Path | None, typer.Option(help="a GIF file, a frame a step")] = None,
    scenario: Annotated[
        Path | None, typer.Option(help="the scenario, with all that happened to it")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Write a recorded trial for other tools."""
    from teamformer.commands.records.export import Wanted
    from teamformer.commands.records.export import export as command

    raise typer.Exit(command(replay, Wanted(mcap, tables, gif, scenario), as_json))
