"""Flags of the verbs on missions; what a verb needs is imported inside it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from teamformer.base.errors import TeamformerError
from teamformer.cli.app import (
    AsJson,
    Folder,
    Foxglove,
    Host,
    Method,
    MissionPath,
    Port,
    Seed,
    TimeLimit,
    Webhook,
    app,
    is_given,
    split_names,
)


@app.command()
def run(
    mission: MissionPath,
    method: Method = None,
    seed: Seed = 0,
    time_limit: TimeLimit = 10.0,
    out: Annotated[
        Path | None, typer.Option(help="folder to write record.json and record.html into")
    ] = None,
    explain: Annotated[
        str | None, typer.Option(metavar="ROBOT", help="print what this robot did, and why")
    ] = None,
    foxglove: Foxglove = None,
    as_json: AsJson = False,
) -> None:
    """Run a mission once, say how it went, and write its record and page."""
    from teamformer.cli.verbs.missions.run import run as command

    raise typer.Exit(
        command(
            path=mission,
            method_name=method,
            seed=seed,
            time_limit=time_limit,
            folder=out,
            as_json=as_json,
            explained=explain,
            foxglove=foxglove,
        )
    )


@app.command()
def compare(
    context: typer.Context,
    mission: MissionPath,
    methods: Annotated[
        str, typer.Option(help="names, separated by commas; in continuous time plan and central")
    ] = "heuristic,join-all,teamformer,crews,plan,central",
    seeds: Annotated[
        int, typer.Option(min=1, help="trials of each method, with seeds 0, 1, ...")
    ] = 1,
    time_limit: TimeLimit = 10.0,
    out: Annotated[
        Path | None, typer.Option(help="folder to write all records and compare.html into")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Run a mission by several methods and compare them."""
    from teamformer.cli.verbs.missions.compare import compare as command

    names = [name.strip() for name in methods.split(",")]
    is_chosen = is_given(context, "methods")
    raise typer.Exit(command(mission, names, seeds, time_limit, out, as_json, is_chosen))


@app.command()
def generate(
    context: typer.Context,
    out: Annotated[Path, typer.Option("-o", "--out", help="the file to write")],
    setting: Annotated[
        str | None, typer.Option(help="a named setting, such as real or 4N20T-C4")
    ] = None,
    robots: Annotated[int, typer.Option(min=1)] = 4,
    tasks: Annotated[int, typer.Option(min=1)] = 4,
    capabilities: Annotated[int, typer.Option(min=1)] = 4,
    requirements: Annotated[
        int | None,
        typer.Option(min=1, help="capabilities that each task needs; by default a random number"),
    ] = None,
    grid: Annotated[str | None, typer.Option(help="a grid, WIDTHxHEIGHT; by default 10x10")] = None,
    plane: Annotated[str | None, typer.Option(help="a plane, WIDTHxHEIGHT in metres")] = None,
    map_path: Annotated[
        Path | None, typer.Option("--map", help="a MovingAI map, or the .yaml of a ROS map")
    ] = None,
    seed: Seed = 0,
) -> None:
    """Write a random mission file."""
    if setting is not None:
        from teamformer.cli.verbs.missions.generate import generate_setting

        given = [name for name in context.params if is_given(context, name)]
        if not set(given) <= {"out", "setting", "seed"}:
            raise TeamformerError("--setting says it all; leave out what else describes the world")
        raise typer.Exit(generate_setting(setting, seed, out))
    from teamformer.cli.verbs.missions.generate import generate as command
    from teamformer.files.drawn.generate import Spec

    spec = Spec(robots, tasks, capabilities, requirements)
    raise typer.Exit(command(spec, grid, plane, map_path, seed, out))


@app.command(name="import")
def import_(
    form: Annotated[
        str,
        typer.Argument(
            metavar="FORMAT", help="hetero-mrta, dcmrta, sadcher, hhcrsp, top, rmf or lif"
        ),
    ],
    path: Annotated[Path, typer.Argument(metavar="FILE", help="the instance: a file or a folder")],
    out: Annotated[
        Path,
        typer.Option(
            "-o", "--out", help="the mission file to write; a folder if there are several instances"
        ),
    ],
) -> None:
    """Write an instance of another project as a mission file."""
    from teamformer.cli.verbs.missions.import_ import import_ as command

    raise typer.Exit(command(form, path, out))


@app.command()
def plan(
    mission: MissionPath,
    method: Annotated[
        str, typer.Option(help="central; in continuous time also plan or reactive")
    ] = "central",
    time_limit: TimeLimit = 10.0,
    start: Annotated[
        Path | None,
        typer.Option("--from", help="a plan that central begins with: what `plan` wrote"),
    ] = None,
    out: Annotated[
        Path | None, typer.Option(help="folder to write record.json and record.html into")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Plan a mission: which robot goes where, and when, if nothing unforeseen happens."""
    from teamformer.cli.verbs.missions.plan import plan as command

    raise typer.Exit(command(mission, method, time_limit, start, out, as_json))


@app.command()
def advise(
    mission: MissionPath,
    page: Annotated[
        Path | None, typer.Argument(metavar="[PAGE]", help="the page to write, .html")
    ] = None,
    time_limit: Annotated[
        float, typer.Option(min=0, help="seconds for all searches together")
    ] = 60.0,
    as_json: AsJson = False,
) -> None:
    """Say which changes would help most, and which robots could be spared."""
    from teamformer.cli.verbs.missions.advise import advise as command

    raise typer.Exit(command(mission, page, time_limit, as_json))


@app.command()
def schema() -> None:
    """Print the JSON Schema of mission files, by which editors complete and check them."""
    from teamformer.cli.verbs.missions.schema import schema as command

    raise typer.Exit(command())


@app.command()
def mcp(
    folder: Annotated[
        Path, typer.Option(help="the folder of missions; nothing else is read or written")
    ] = Path("."),
) -> None:
    """Serve a folder of missions to an assistant, by the Model Context Protocol over stdio.

    Needs the extra `mcp`.
    """
    from teamformer.cli.verbs.missions.mcp import mcp as command

    raise typer.Exit(command(folder))


@app.command()
def live(
    mission: Annotated[
        Path | None,
        typer.Argument(metavar="[MISSION]", help="a mission file; without one the editor opens"),
    ] = None,
    method: Method = None,
    seed: Seed = 0,
    port: Port = "8765",
    host: Host = "",
    out: Folder = Path("out/live"),
    resume: Annotated[
        bool,
        typer.Option(
            "--resume",
            help="go on with a mission that was cut off; MISSION may name its autosave.jsonl",
        ),
    ] = False,
    webhook: Webhook = "",
) -> None:
    """Draw and run a mission in the browser: watch it, add tasks, lose robots.

    Needs the extra `live`.
    """
    from teamformer.cli.terminal.addresses import address_of
    from teamformer.cli.verbs.missions.live import LiveOptions
    from teamformer.cli.verbs.missions.live import live as command

    at = address_of(port, split_names(host))
    raise typer.Exit(command(mission, LiveOptions(method, seed, at, out, resume, webhook)))
