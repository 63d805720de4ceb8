"""Flags of the verbs of `fleet`, where every robot is a process of its own."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from teamformer.cli.app import (
    AsJson,
    Folder,
    Foxglove,
    Host,
    MissionPath,
    Port,
    Seed,
    Webhook,
    app,
    split_names,
)

fleet = typer.Typer(
    no_args_is_help=True,
    rich_markup_mode=None,
    help="Run every robot as a process of its own, without a server; needs the extra `fleet`.",
)
app.add_typer(fleet, name="fleet")

FleetMethod = Annotated[
    str, typer.Option(help="plan, a coordinator or a policy; see `teamformer methods`")
]
Keys = Annotated[Path | None, typer.Option(help="folder of the fleet's keys and certificates")]
Connect = Annotated[str, typer.Option(help="endpoint of an agent, such as tcp/127.0.0.1:7447")]


@fleet.command()
def start(
    mission: MissionPath,
    method: FleetMethod = "plan",
    keys: Keys = None,
    time_limit: Annotated[
        float, typer.Option(min=1, help="seconds after which it gives up")
    ] = 3600.0,
    as_json: AsJson = False,
) -> None:
    """Run every robot as a process of its own on this machine, with simulated bodies."""
    from teamformer.cli.verbs.robots.start import StartOptions
    from teamformer.cli.verbs.robots.start import start as command

    raise typer.Exit(command(mission, StartOptions(time_limit, method, keys), as_json))


@fleet.command()
def add(
    mission: MissionPath,
    name: Annotated[str, typer.Argument(metavar="NAME", help="the new task's name")],
    at: Annotated[str, typer.Option(metavar="X,Y", help="the place of the task")],
    needs: Annotated[
        str, typer.Option(help="the capabilities that it needs, such as lift:12.5,scan")
    ],
    connect: Connect,
    duration: Annotated[float, typer.Option(min=0, help="steps that it takes")] = 0.0,
    keys: Keys = None,
) -> None:
    """Add a task to a running fleet."""
    from teamformer.cli.verbs.robots.add import AddedTask
    from teamformer.cli.verbs.robots.add import add as command
    from teamformer.cli.verbs.robots.mesh import FleetAt

    new = AddedTask(name, at, needs, duration)
    raise typer.Exit(command(mission, new, FleetAt(connect, keys)))


@fleet.command()
def cancel(
    mission: MissionPath,
    name: Annotated[str, typer.Argument(metavar="NAME", help="the task's name")],
    connect: Connect,
    keys: Keys = None,
) -> None:
    """Call a task of a running fleet off."""
    from teamformer.cli.verbs.robots.cancel import cancel as command
    from teamformer.cli.verbs.robots.mesh import FleetAt

    raise typer.Exit(command(mission, name, FleetAt(connect, keys)))


@fleet.command()
def agent(
    mission: MissionPath,
    robot: Annotated[str, typer.Argument(metavar="ROBOT", help="name of the robot")],
    body: Annotated[str, typer.Option(help="sim, nav2, vda5050:URL or module:Class")] = "sim",
    listen: Annotated[
        str | None, typer.Option(help="own endpoint, such as tcp/127.0.0.1:7447")
    ] = None,
    connect: Annotated[
        list[str] | None, typer.Option(help="endpoint of another agent; may be repeated")
    ] = None,
    keys: Keys = None,
    facts: Annotated[
        Path | None, typer.Option(help="file that keeps what the agent knows, for a restart")
    ] = None,
    method: FleetMethod = "plan",
) -> None:
    """Run the agent of one robot, which talks to the others over Zenoh."""
    from teamformer.cli.verbs.robots.agent import AgentOptions
    from teamformer.cli.verbs.robots.agent import agent as command

    options = AgentOptions(
        robot=robot,
        body=body,
        listen=listen,
        connect=tuple(connect or ()),
        keys=keys,
        facts=facts,
        method=method,
    )
    raise typer.Exit(command(mission, options))


@fleet.command()
def rehearse(
    mission: MissionPath,
    schedules: Annotated[
        int, typer.Option(min=1, help="number of schedules of faults to play")
    ] = 100,
    seed: Seed = 0,
    schedule: Annotated[
        int | None, typer.Option(min=0, help="play only the schedule with this number")
    ] = None,
    out: Annotated[
        Path | None, typer.Option(help="folder to write its record and page into")
    ] = None,
    method: FleetMethod = "plan",
    foxglove: Foxglove = None,
    as_json: AsJson = False,
) -> None:
    """Rehearse a fleet under random faults, faster than real time."""
    from teamformer.cli.verbs.robots.rehearse import RehearseOptions
    from teamformer.cli.verbs.robots.rehearse import rehearse as command

    options = RehearseOptions(schedules, seed, schedule, out, method, foxglove)
    raise typer.Exit(command(mission, options, as_json))


@fleet.command()
def watch(
    mission: MissionPath,
    connect: Connect,
    keys: Keys = None,
    port: Port = "8765",
    host: Host = "",
    out: Folder = Path("out/live"),
    foxglove: Foxglove = None,
    webhook: Webhook = "",
) -> None:
    """Watch a running fleet in the browser, and add tasks; needs the extra `live` too."""
    from teamformer.cli.terminal.addresses import address_of
    from teamformer.cli.verbs.robots.mesh import FleetAt
    from teamformer.cli.verbs.robots.watch import WatchOptions
    from teamformer.cli.verbs.robots.watch import watch as command

    options = WatchOptions(address_of(port, split_names(host)), out, foxglove, webhook)
    raise typer.Exit(command(mission, FleetAt(connect, keys), options))
