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
        Path | None, typer.Option(help="refuse the record if it is not of this mission file")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Check that a record follows the rules, by code that shares nothing with the simulator."""
    from teamformer.cli.verbs.records.check import check as command

    raise typer.Exit(command(record, mission, as_json))


@app.command()
def view(
    files: Annotated[
        list[Path],
        typer.Argument(
            metavar="FILE... [PAGE]",
            help="records, and the page to write (.html); or a folder of records; or a map",
        ),
    ],
) -> None:
    """Write the page of a record, or of several side by side.

    A folder of records gets a page with a row for each. Of a mission (.yaml) or a map (.map, or a
    ROS map's .yaml) the free cells are drawn in the terminal.
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
    learned: Annotated[Path, typer.Argument(metavar="LEARNED", help="the mission file to write")],
) -> None:
    """Write a mission with the durations and needs that records of its site show."""
    from teamformer.cli.verbs.records.learn import learn_from

    raise typer.Exit(learn_from(mission, records, learned))


@app.command()
def export(
    record: RecordPath,
    wanted: Annotated[
        list[Path],
        typer.Argument(
            metavar="FILE",
            help="a file that ends in .mcap, .gif, .trace.json or .yaml, or a folder",
        ),
    ],
) -> None:
    """Write a record for other tools. The ending of FILE chooses its format.

    .mcap is for Foxglove, .trace.json for Perfetto, .gif a moving picture, .yaml the mission with
    all that happened to it. A folder gets CSV tables of robots, tasks, events and the Gantt chart.
    """
    from teamformer.cli.verbs.records.export import export as command

    raise typer.Exit(command(record, wanted))
