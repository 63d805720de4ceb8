"""Flags of the verbs of `robotarium`: missions of small real robots."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from teamformer.base.extras import require
from teamformer.cli.app import AsJson, Method, MissionPath, Seed, app

robotarium = typer.Typer(
    no_args_is_help=True,
    rich_markup_mode=None,
    help="Missions for the Robotarium; needs the extra `robotarium`.",
)
app.add_typer(robotarium, name="robotarium")


@robotarium.command()
def fly(
    mission: MissionPath,
    method: Method = None,
    seed: Seed = 0,
    simulator: Annotated[
        str,
        typer.Option(
            help="plant; noisy, a plant 66 ms late and 2 mm off; or rps, the official one"
        ),
    ] = "plant",
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="folder to write pictures into")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Fly a mission in a simulated arena."""
    require("robotarium")
    from teamformer.cli.verbs.robots.robotarium import FlightOptions
    from teamformer.cli.verbs.robots.robotarium import fly as command

    options = FlightOptions(method, seed, simulator, out)
    raise typer.Exit(command(mission, options, as_json))


@robotarium.command()
def deploy(
    mission: MissionPath,
    folder: Annotated[
        Path, typer.Argument(metavar="FOLDER", help="the folder to write and upload")
    ],
    method: Annotated[
        str, typer.Option(help="the policy that forms teams along the paper's order")
    ] = "teamformer",
) -> None:
    """Write a folder to upload to the Robotarium; try it on the official simulator if installed."""
    require("robotarium")
    from teamformer.cli.verbs.robots.robotarium import deploy as command

    raise typer.Exit(command(mission, folder, method))
