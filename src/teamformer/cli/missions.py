"""Flags of the verbs on missions; what a verb needs is imported inside it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from teamformer.cli.app import (
    AsJson,
    Method,
    ScenarioPath,
    Seed,
    StepLimit,
    TimeLimit,
    app,
    is_given,
)
from teamformer.errors import TeamformerError


@app.command()
def run(
    scenario: ScenarioPath,
    method: Method = None,
    seed: Seed = 0,
    step_limit: StepLimit = None,
    time_limit: TimeLimit = 10.0,
    out: Annotated[Path | None, typer.Option(help="folder for replay.json")] = None,
    html: Annotated[bool, typer.Option("--html", help="write replay.html there too")] = False,
    explain: Annotated[
        str | None, typer.Option(metavar="ROBOT", help="say what it did, and why")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Run one trial of a scenario."""
    from teamformer.commands.missions.run import run as command

    if html and out is None:
        raise TeamformerError("--html needs a folder for the page", "add --out FOLDER")
    status = command(scenario, method, seed, step_limit, time_limit, out, html, as_json, explain)
    raise typer.Exit(status)


@app.command()
def compare(
    scenario: ScenarioPath,
    methods: Annotated[
        str, typer.Option(help="names, with commas")
    ] = "heuristic,join-all,teamformer,crews,plan,central",
    seeds: Annotated[int, typer.Option(min=1, help="trials by each method")] = 1,
    step_limit: StepLimit = None,
    time_limit: TimeLimit = 10.0,
    as_json: AsJson = False,
) -> None:
    """Run a mission by several methods, side by side."""
    from teamformer.commands.missions.compare import compare as command

    names = [name.strip() for name in methods.split(",")]
    raise typer.Exit(command(scenario, names, seeds, step_limit, time_limit, as_json))


@app.command()
def generate(
    context: typer.Context,
    out: Annotated[Path, typer.Option("-o", "--out", help="the file to write")],
    setting: Annotated[
        str | None, typer.Option(help="a benchmark's, such as 4N20T-C4; with its --seed")
    ] = None,
    robots: Annotated[int, typer.Option(min=1)] = 4,
    tasks: Annotated[int, typer.Option(min=1)] = 4,
    capabilities: Annotated[int, typer.Option(min=1)] = 4,
    requirements: Annotated[int | None, typer.Option(min=1, help="of each task")] = None,
    late_tasks: Annotated[int, typer.Option(min=0, help="tasks that appear later")] = 0,
    grid: Annotated[str | None, typer.Option(help="WIDTHxHEIGHT, 10x10 by default")] = None,
    plane: Annotated[str | None, typer.Option(help="WIDTHxHEIGHT in metres")] = None,
    map_path: Annotated[Path | None, typer.Option("--map", help="a .map or a ROS map")] = None,
    cell: Annotated[float | None, typer.Option(help="metres a cell, for a ROS map")] = None,
    seed: Seed = 0,
    force: Annotated[bool, typer.Option("--force", help="overwrite a file that is there")] = False,
    as_json: AsJson = False,
) -> None:
    """Write a random scenario, or a world of a benchmark."""
    if out.exists() and not force:
        raise TeamformerError(f"{out}: there is such a file", "overwrite it with --force")
    if setting is not None:
        from teamformer.commands.missions.generate import generate_setting

        others = {"out", "setting", "seed", "force", "as_json"}
        given = [name for name in context.params if is_given(context, name)]
        if not set(given) <= others:
            raise TeamformerError("--setting says it all; leave out what else describes the world")
        raise typer.Exit(generate_setting(setting, seed, out, as_json))
    from teamformer.commands.missions.generate import generate as command
    from teamformer.scenarios.generate import Spec

    spec = Spec(robots, tasks, capabilities, requirements, late_tasks=late_tasks)
    raise typer.Exit(command(spec, grid, plane, map_path, cell, seed, out, as_json))


@app.command(name="import")
def import_(
    form: Annotated[str, typer.Argument(metavar="FORMAT", help="hetero-mrta, dcmrta or sadcher")],
    path: Annotated[Path, typer.Argument(metavar="FILE", help="their file, or folder")],
    out: Annotated[Path, typer.Option("-o", "--out", help="the scenario to write")],
    number: Annotated[
        int | None, typer.Option(min=0, help="which mission, where a file holds several")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Write somebody else's instance as a scenario file."""
    from teamformer.commands.missions.import_ import import_ as command

    raise typer.Exit(command(form, path, out, number, as_json))


@app.command()
def plan(
    scenario: ScenarioPath,
    method: Annotated[
        str, typer.Option(help="central; in continuous time also plan or reactive")
    ] = "central",
    time_limit: TimeLimit = 10.0,
    html: Annotated[bool, typer.Option("--html", help="write a Gantt chart, plan.html")] = False,
    out: Annotated[Path | None, typer.Option(help="folder for plan.html; here by default")] = None,
    as_json: AsJson = False,
) -> None:
    """Plan a mission without playing it: who goes where, and when."""
    from teamformer.commands.missions.plan import plan as command

    if out is not None and not html:
        raise TeamformerError("--out is for the page", "add --html")
    page = (out or Path()) / "plan.html" if html else None
    raise typer.Exit(command(scenario, method, time_limit, page, as_json))


@app.command()
def live(
    scenario: Annotated[
        Path | None, typer.Argument(metavar="[SCENARIO]", help="none: draw one in the editor")
    ] = None,
    method: Method = None,
    seed: Seed = 0,
    port: Annotated[int, typer.Option(min=1, max=65535)] = 8765,
    host: Annotated[
        str, typer.Option(help="address to serve on; other than loopback, a token is needed")
    ] = "127.0.0.1",
    speed: Annotated[float, typer.Option(min=0.1, max=1000, help="steps a second")] = 4.0,
    time_limit: TimeLimit = 10.0,
    out: Annotated[Path, typer.Option(help="folder that the record is saved in")] = Path(
        "out/live"
    ),
    fleet: Annotated[
        str | None, typer.Option(help="watch a running fleet: the endpoint of an agent")
    ] = None,
    pace: Annotated[float, typer.Option(min=0.01, help="fleet: its --pace")] = 1.0,
    key: Annotated[Path | None, typer.Option(help="fleet: file of its shared key")] = None,
    tls: Annotated[Path | None, typer.Option(help="fleet: folder of certificates")] = None,
    sign: Annotated[Path | None, typer.Option(help="fleet: folder of keys to sign with")] = None,
) -> None:
    """Draw a mission in the browser and run it: watch it, add tasks, lose robots.

    Needs pip install 'teamformer[live]'.
    """
    from teamformer.commands.missions.live import FleetAt, Options
    from teamformer.commands.missions.live import live as command

    at = None if fleet is None else FleetAt(fleet, pace, key, tls, sign)
    options = Options(method, seed, port, host, speed, time_limit, out, at)
    raise typer.Exit(command(scenario, options))
