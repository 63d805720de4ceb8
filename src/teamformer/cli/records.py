"""Flags of the verbs on records of trials."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from teamformer.cli.app import AsJson, MissionPath, RecordPath, app


@app.command()
def check(
    record: RecordPath,
    mission: Annotated[
        Path | None, typer.Option(help="the file that the record must be of")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Judge the record of a trial by the rules alone."""
    from teamformer.cli.verbs.records.check import check as command

    raise typer.Exit(command(record, mission, as_json))


@app.command()
def view(
    files: Annotated[
        list[Path],
        typer.Argument(
            metavar="FILE... [PAGE]",
            help="records, and the .html to write, by default beside the first; a folder; a map",
        ),
    ],
) -> None:
    """Write the page of a recorded trial, or of several in step; of a map, draw the free cells.

    A folder of records gets a page with a row for each, which opens them. A mission (.yaml) or a
    map (.map, or a ROS map's .yaml) is drawn in the terminal.
    """
    if len(files) == 1 and files[0].suffix.lower() in (".yaml", ".yml", ".map"):
        from teamformer.cli.verbs.missions.draw_map import draw_map

        raise typer.Exit(draw_map(files[0]))
    if len(files) == 1 and files[0].is_dir():
        from teamformer.cli.verbs.records.view_folder import view_folder

        raise typer.Exit(view_folder(files[0]))
    from teamformer.cli.verbs.records.view import view as command

    raise typer.Exit(command(files))


@app.command()
def learn(
    mission: MissionPath,
    records: Annotated[
        list[Path], typer.Argument(metavar="RECORD...", help="records, or folders with record.json")
    ],
    learned: Annotated[Path, typer.Argument(metavar="LEARNED", help="the .yaml to write")],
) -> None:
    """Write a mission whose uncertain durations and needs are as records of its site show them."""
    from teamformer.cli.verbs.records.learn import learn_from

    raise typer.Exit(learn_from(mission, records, learned))


@app.command()
def export(
    record: RecordPath,
    wanted: Annotated[
        list[Path],
        typer.Argument(metavar="FILE", help=".mcap, .gif, .yaml (the mission), or a folder"),
    ],
) -> None:
    """Write a recorded trial for other tools: the ending of each file chooses its format.

    .mcap is for Foxglove; .yaml is the mission with all that happened to it; a folder gets CSV
    tables of robots, tasks, events and the Gantt chart.
    """
    from teamformer.cli.verbs.records.export import export as command

    raise typer.Exit(command(record, wanted))
