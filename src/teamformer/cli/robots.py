"""Flags of the verbs on robots of their own."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from teamformer.cli.app import AsJson, Method, ScenarioPath, Seed, app
from teamformer.errors import TeamformerError

FleetMethod = Annotated[str, typer.Option(help="plan, or who forms teams; see `methods`")]

Sign = Annotated[
    Path | None, typer.Option(help="folder of the robots' public keys and the own private one")
]


@app.command()
def robotarium(
    words: Annotated[
        list[str], typer.Argument(metavar="[deploy] SCENARIO", help="a scenario file on a plane")
    ],
    method: Method = None,
    seed: Seed = 0,
    simulator: Annotated[str, typer.Option(help="plant, ours, or rps, the official one")] = "plant",
    delay: Annotated[float, typer.Option(min=0, max=1, help="seconds until robots obey")] = 0.0,
    noise: Annotated[bool, typer.Option("--noise", help="2 mm and 1 degree")] = False,
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="folder for pictures, or to upload")
    ] = None,
    verify: Annotated[bool, typer.Option("--verify", help="run what was deployed")] = False,
    python: Annotated[
        str, typer.Option(help="that verifies: one that has the simulator")
    ] = sys.executable,
    as_json: AsJson = False,
) -> None:
    """Fly a mission in Robotarium's arena; `deploy` writes what its testbed takes."""
    from teamformer.commands.robots.robotarium import RobotariumOptions, deploy
    from teamformer.commands.robots.robotarium import robotarium as command

    *verbs, path = words
    if verbs not in ([], ["deploy"]):
        raise TeamformerError(f"'{' '.join(words)}' is not one scenario", "give one file")
    options = RobotariumOptions(method, seed, simulator, delay, noise, out)
    if verbs:
        raise typer.Exit(deploy(Path(path), options, verify, python, as_json))
    raise typer.Exit(command(Path(path), options, as_json))


@app.command()
def rehearse(
    scenario: ScenarioPath,
    schedules: Annotated[int, typer.Option(min=1, help="schedules of faults")] = 100,
    seed: Seed = 0,
    loss: Annotated[float | None, typer.Option(help="of messages, 0 to 1; else by chance")] = None,
    crashes: Annotated[int | None, typer.Option(min=0, help="robots; else by chance")] = None,
    schedule: Annotated[int | None, typer.Option(min=0, help="play only this one")] = None,
    out: Annotated[Path | None, typer.Option(help="folder for its replay.json")] = None,
    workers: Annotated[
        int | None, typer.Option(min=1, help="processes; one for each core by default")
    ] = None,
    method: FleetMethod = "plan",
    as_json: AsJson = False,
) -> None:
    """Try the fleet's own agents under random faults: every robot a mind of its own, no server."""
    from teamformer.commands.robots.rehearse import Options
    from teamformer.commands.robots.rehearse import rehearse as command

    options = Options(schedules, seed, loss, crashes, schedule, out, workers, method)
    raise typer.Exit(command(scenario, options, as_json))


@app.command()
def fleet(
    words: Annotated[list[str], typer.Argument(metavar="[add] SCENARIO", help="a scenario file")],
    pace: Annotated[float, typer.Option(min=0.01, help="how much faster than real time")] = 1.0,
    drop: Annotated[
        float, typer.Option(min=0, max=0.95, help="of messages to throw away, for trials")
    ] = 0.0,
    facts: Annotated[Path | None, typer.Option(help="folder for the agents' facts files")] = None,
    time_limit: Annotated[float, typer.Option(min=1, help="seconds until it gives up")] = 3600.0,
    method: FleetMethod = "plan",
    sign: Sign = None,
    task: Annotated[str | None, typer.Option(help="add: the new task's name")] = None,
    at: Annotated[str | None, typer.Option(help="add: its place, X,Y")] = None,
    needs: Annotated[str | None, typer.Option(help="add: such as lift:12.5,scan")] = None,
    duration: Annotated[float, typer.Option(min=0, help="add: steps that it takes")] = 0.0,
    connect: Annotated[str | None, typer.Option(help="add: the endpoint of an agent")] = None,
    key: Annotated[Path | None, typer.Option(help="add: file of the fleet's shared key")] = None,
    tls: Annotated[Path | None, typer.Option(help="add: folder of certificates")] = None,
    patience: Annotated[float, typer.Option(min=0, help="add: seconds until it gives up")] = 20.0,
    as_json: AsJson = False,
) -> None:
    """Run every robot as a process of its own on this machine; `add` adds a task to it."""
    from teamformer.commands.robots.fleet import Added, Options, add
    from teamformer.commands.robots.fleet import fleet as command

    *verbs, path = words
    if verbs not in ([], ["add"]):
        raise TeamformerError(f"'{' '.join(words)}' is not one scenario", "give one file")
    if not verbs:
        options = Options(pace, drop, facts, time_limit, method, sign)
        raise typer.Exit(command(Path(path), options, as_json))
    if task is None or at is None or needs is None:
        raise TeamformerError("a task to add needs --task NAME, --at X,Y and --needs ...")
    added = Added(task, at, needs, duration, connect, key, tls, pace, patience, sign)
    raise typer.Exit(add(Path(path), added, as_json))


@app.command()
def agent(
    scenario: ScenarioPath,
    robot: Annotated[str, typer.Option(help="whose mind it is, by name")],
    body: Annotated[str, typer.Option(help="sim, vda5050:URL or module:Class")] = "sim",
    listen: Annotated[str | None, typer.Option(help="own endpoint: tcp/127.0.0.1:7447")] = None,
    connect: Annotated[
        list[str] | None, typer.Option(help="endpoint of another; again for more")
    ] = None,
    key: Annotated[Path | None, typer.Option(help="file of the fleet's shared key")] = None,
    tls: Annotated[Path | None, typer.Option(help="folder of certificates for tls/")] = None,
    facts: Annotated[Path | None, typer.Option(help="file of what must not be forgotten")] = None,
    plan: Annotated[Path | None, typer.Option(hidden=True)] = None,
    pace: Annotated[float, typer.Option(min=0.01, help="how much faster than real time")] = 1.0,
    drop: Annotated[
        float, typer.Option(min=0, max=0.95, help="of messages to throw away, for trials")
    ] = 0.0,
    method: FleetMethod = "plan",
    sign: Sign = None,
) -> None:
    """Run the mind of one robot, over Zenoh from peer to peer."""
    from teamformer.commands.robots.agent import Options
    from teamformer.commands.robots.agent import agent as command

    ends = (listen, tuple(connect or ()))
    options = Options(robot, body, *ends, key, tls, facts, plan, pace, drop, method, sign)
    raise typer.Exit(command(scenario, options))
