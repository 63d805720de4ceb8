"""The command line: verbs and flags; what a verb needs is imported inside it."""

from __future__ import annotations

import io
import os
import sys
from pathlib import Path
from typing import Annotated

import typer

from teamformer.errors import ReaderGoneError, TeamformerError

app = typer.Typer(
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    help="Teams of robots that form, split and share out tasks by themselves.",
)

ScenarioPath = Annotated[Path, typer.Argument(metavar="SCENARIO", help="a scenario file")]
ReplayPath = Annotated[Path, typer.Argument(metavar="REPLAY", help="a replay.json")]
AsJson = Annotated[bool, typer.Option("--json", help="print JSON")]
Seed = Annotated[int, typer.Option(min=0, help="of all randomness")]
Order = Annotated[str | None, typer.Option(help="the shared task order: tsp or schedule")]
Allocation = Annotated[
    str | None, typer.Option(help="who heads for which task: paper, nearest or crews")
]
StepLimit = Annotated[int | None, typer.Option(min=1, help="give up after so many steps")]
TimeLimit = Annotated[float, typer.Option(min=0, help="seconds that central may plan")]


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


@app.command()
def run(
    scenario: ScenarioPath,
    policy: Annotated[str, typer.Option(help="who decides; see `policies`")] = "teamformer",
    order: Order = None,
    allocation: Allocation = None,
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
    from teamformer.commands.run import Changes
    from teamformer.commands.run import run as command

    if html and out is None:
        raise TeamformerError("--html needs a folder for the page", "add --out FOLDER")
    changes = Changes(order, allocation, step_limit)
    status = command(scenario, policy, seed, changes, time_limit, out, html, as_json, explain)
    raise typer.Exit(status)


@app.command()
def compare(
    scenario: ScenarioPath,
    policies: Annotated[
        str, typer.Option(help="names, with commas")
    ] = "heuristic,join-all,teamformer,central",
    seeds: Annotated[int, typer.Option(min=1, help="trials of each policy")] = 1,
    order: Order = None,
    allocation: Allocation = None,
    step_limit: StepLimit = None,
    time_limit: TimeLimit = 10.0,
    as_json: AsJson = False,
) -> None:
    """Run a scenario under several policies, side by side."""
    from teamformer.commands.compare import compare as command
    from teamformer.commands.run import Changes

    changes = Changes(order, allocation, step_limit)
    names = [name.strip() for name in policies.split(",")]
    raise typer.Exit(command(scenario, names, seeds, changes, time_limit, as_json))


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
        from teamformer.commands.generate import generate_setting

        others = {"out", "setting", "seed", "force", "as_json"}
        given = [name for name in context.params if _is_given(context, name)]
        if not set(given) <= others:
            raise TeamformerError("--setting says it all; leave out what else describes the world")
        raise typer.Exit(generate_setting(setting, seed, out, as_json))
    from teamformer.commands.generate import generate as command
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
    from teamformer.commands.import_ import import_ as command

    raise typer.Exit(command(form, path, out, number, as_json))


@app.command()
def plan(
    scenario: ScenarioPath,
    policy: Annotated[
        str, typer.Option(help="central; in continuous time also plan or reactive")
    ] = "central",
    time_limit: TimeLimit = 10.0,
    html: Annotated[bool, typer.Option("--html", help="write a Gantt chart, plan.html")] = False,
    out: Annotated[Path | None, typer.Option(help="folder for plan.html; here by default")] = None,
    as_json: AsJson = False,
) -> None:
    """Plan a mission without playing it: who goes where, and when."""
    from teamformer.commands.plan import plan as command

    if out is not None and not html:
        raise TeamformerError("--out is for the page", "add --html")
    page = (out or Path()) / "plan.html" if html else None
    raise typer.Exit(command(scenario, policy, time_limit, page, as_json))


@app.command()
def check(
    replay: ReplayPath,
    scenario: Annotated[
        Path | None, typer.Option(help="the file that the record must be of")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Judge the record of a trial by the rules alone."""
    from teamformer.commands.records import check as command

    raise typer.Exit(command(replay, scenario, as_json))


@app.command()
def view(
    replay: ReplayPath,
    out: Annotated[Path | None, typer.Option("-o", "--out", help="the page to write")] = None,
    as_json: AsJson = False,
) -> None:
    """Write the page of a recorded trial."""
    from teamformer.commands.records import view as command

    raise typer.Exit(command(replay, out, as_json))


@app.command()
def live(
    scenario: Annotated[
        Path | None, typer.Argument(metavar="[SCENARIO]", help="none: draw one in the editor")
    ] = None,
    policy: Annotated[str, typer.Option(help="who decides; see `policies`")] = "teamformer",
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
) -> None:
    """Draw a mission in the browser and run it: watch it, add tasks, lose robots.

    Needs pip install 'teamformer[live]'.
    """
    from teamformer.commands.live import Options
    from teamformer.commands.live import live as command

    raise typer.Exit(command(scenario, Options(policy, seed, port, host, speed, time_limit, out)))


@app.command()
def export(
    replay: ReplayPath,
    mcap: Annotated[Path | None, typer.Option(help="an MCAP file, for Foxglove")] = None,
    tables: Annotated[
        Path | None, typer.Option("--csv", help="a folder for tables: robots, tasks, events, Gantt")
    ] = None,
    scenario: Annotated[
        Path | None, typer.Option(help="the scenario, with all that happened to it")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Write a recorded trial for other tools."""
    from teamformer.commands.export import export as command

    raise typer.Exit(command(replay, mcap, tables, scenario, as_json))


@app.command()
def policies(as_json: AsJson = False) -> None:
    """List what can be named with --policy."""
    from teamformer.commands.policies import policies as command

    raise typer.Exit(command(as_json))


@app.command()
def bench(
    suite: Annotated[str, typer.Argument(metavar="SUITE", help="a name, or a .yaml file")],
    trials: Annotated[int | None, typer.Option(min=1, help="of each policy and setting")] = None,
    policies: Annotated[str, typer.Option(help="names, with commas; else the suite's")] = "",
    without: Annotated[str, typer.Option(help="policies to leave out")] = "",
    settings: Annotated[str, typer.Option(help="the only ones wanted")] = "",
    seed: Annotated[int, typer.Option(min=0, help="of the first world")] = 0,
    time_limit: Annotated[
        float | None, typer.Option(min=0, help="seconds that central may plan")
    ] = None,
    order: Order = None,
    allocation: Allocation = None,
    worlds: Annotated[
        list[Path] | None, typer.Option(help="files or folders of worlds, for `authors`")
    ] = None,
    out: Annotated[Path | None, typer.Option(help="folder for rows, tables and figures")] = None,
    workers: Annotated[
        int | None, typer.Option(min=1, help="processes; one for each core by default")
    ] = None,
    engine: Annotated[str, typer.Option(help="local or ray")] = "local",
    report: Annotated[
        Path | None, typer.Option(help="write the paper's claims beside what was measured here")
    ] = None,
    beside: Annotated[
        list[Path] | None, typer.Option(help="folders of other suites, for --report")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Measure policies on a suite of settings; `speed` times the simulator.

    Suites: fig3 fig4a fig4b fig5a fig5b fig6 fig9 table1, together `paper`; fleet, scale, authors.

    Run it again with the same folder to go on after an interruption, or for more trials.
    """
    from teamformer.commands.bench import BenchOptions
    from teamformer.commands.bench import bench as command

    options = BenchOptions(
        trials=trials,
        seed=seed,
        time_limit=time_limit,
        order=order,
        allocation=allocation,
        policies=_split(policies),
        without=_split(without),
        settings=_split(settings),
        worlds=tuple(worlds or ()),
        workers=workers or os.cpu_count() or 1,
        engine=engine,
        folder=out,
        results=report,
        beside=tuple(beside or ()),
    )
    raise typer.Exit(command(suite, options, as_json))


def _is_given(context: typer.Context, name: str) -> bool:
    source = context.get_parameter_source(name)
    return source is not None and source.name == "COMMANDLINE"


def _split(names: str) -> tuple[str, ...]:
    return tuple(name.strip() for name in names.split(",") if name.strip())


@app.command()
def train(
    context: typer.Context,
    capabilities: Annotated[
        int | None, typer.Option(min=1, help="how many the network is made for; none: any number")
    ] = None,
    network: Annotated[
        str | None, typer.Option(help="any, teamformer, deepset or gnn; chosen by --capabilities")
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(help="folder, runs/NETWORK-SEED by default; goes on if it has one"),
    ] = None,
    resume: Annotated[
        Path | None, typer.Option(help="folder of a training to go on with, as it was begun")
    ] = None,
    iterations: Annotated[int | None, typer.Option(min=1, help="at most; 60, or endless")] = None,
    minutes: Annotated[float | None, typer.Option(min=0, help="at most")] = None,
    worlds: Annotated[int, typer.Option(min=1, help="played in each iteration")] = 256,
    held_out: Annotated[int, typer.Option(min=1, help="worlds of each setting")] = 48,
    method: Annotated[
        str | None, typer.Option(help="rollouts, or ppo; the network's own by default")
    ] = None,
    reward: Annotated[
        str, typer.Option(help="of ppo; mission, or team as in the paper")
    ] = "mission",
    seed: Seed = 0,
    device: Annotated[str, typer.Option(help="cpu or cuda")] = "cpu",
    as_json: AsJson = False,
) -> None:
    """Train a policy; needs torch: pip install 'teamformer[train]'."""
    from teamformer.commands.train import TrainOptions
    from teamformer.commands.train import train as command

    for name, given, known in (
        ("--device", device, ("cpu", "cuda")),
        ("--reward", reward, ("mission", "team")),
    ):
        if given not in known:
            raise TeamformerError(f"{name} {given} is unknown", f"use {' or '.join(known)}")
    anew = ("minutes", "device", "resume", "as_json")
    given_too = [name for name in context.params if _is_given(context, name) and name not in anew]
    if resume is not None and given_too:
        flag = given_too[0].replace("_", "-")
        raise TeamformerError(f"--resume goes on as it was begun; leave --{flag} out")
    options = TrainOptions(
        network=network or ("any" if capabilities is None else "teamformer"),
        capabilities=capabilities,
        iterations=iterations,
        minutes=minutes,
        worlds=worlds,
        held_out=held_out,
        method=method,
        reward=reward,
        seed=seed,
        device=device,
        folder=out,
        resume=resume,
    )
    raise typer.Exit(command(options, as_json))


@app.command()
def robotarium(
    words: Annotated[
        list[str], typer.Argument(metavar="[deploy] SCENARIO", help="a scenario file on a plane")
    ],
    policy: Annotated[str, typer.Option(help="who decides; see `policies`")] = "teamformer",
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
    from teamformer.commands.robotarium import RobotariumOptions, deploy
    from teamformer.commands.robotarium import robotarium as command

    *verbs, path = words
    if verbs not in ([], ["deploy"]):
        raise TeamformerError(f"'{' '.join(words)}' is not one scenario", "give one file")
    options = RobotariumOptions(policy, seed, simulator, delay, noise, out)
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
    as_json: AsJson = False,
) -> None:
    """Try the fleet's own agents under random faults: every robot a mind of its own, no server."""
    from teamformer.commands.rehearse import Options
    from teamformer.commands.rehearse import rehearse as command

    options = Options(schedules, seed, loss, crashes, schedule, out, workers)
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
    task: Annotated[str | None, typer.Option(help="add: the new task's name")] = None,
    at: Annotated[str | None, typer.Option(help="add: its place, X,Y")] = None,
    needs: Annotated[str | None, typer.Option(help="add: such as lift:2,scan")] = None,
    duration: Annotated[float, typer.Option(min=0, help="add: steps that it takes")] = 0.0,
    connect: Annotated[str | None, typer.Option(help="add: the endpoint of an agent")] = None,
    key: Annotated[Path | None, typer.Option(help="add: file of the fleet's shared key")] = None,
    patience: Annotated[float, typer.Option(min=0, help="add: seconds until it gives up")] = 20.0,
    as_json: AsJson = False,
) -> None:
    """Run every robot as a process of its own on this machine; `add` adds a task to it."""
    from teamformer.commands.fleet import Added, Options, add
    from teamformer.commands.fleet import fleet as command

    *verbs, path = words
    if verbs not in ([], ["add"]):
        raise TeamformerError(f"'{' '.join(words)}' is not one scenario", "give one file")
    if not verbs:
        options = Options(pace, drop, facts, time_limit)
        raise typer.Exit(command(Path(path), options, as_json))
    if task is None or at is None or needs is None:
        raise TeamformerError("a task to add needs --task NAME, --at X,Y and --needs ...")
    added = Added(task, at, needs, duration, connect, key, pace, patience)
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
    facts: Annotated[Path | None, typer.Option(help="file of what must not be forgotten")] = None,
    plan: Annotated[Path | None, typer.Option(hidden=True)] = None,
    pace: Annotated[float, typer.Option(min=0.01, help="how much faster than real time")] = 1.0,
    drop: Annotated[
        float, typer.Option(min=0, max=0.95, help="of messages to throw away, for trials")
    ] = 0.0,
) -> None:
    """Run the mind of one robot, over Zenoh from peer to peer."""
    from teamformer.commands.agent import Options
    from teamformer.commands.agent import agent as command

    options = Options(robot, body, listen, tuple(connect or ()), key, facts, plan, pace, drop)
    raise typer.Exit(command(scenario, options))


def _open_what_is_closed() -> None:
    """Have something to write to where the shell was told to close an output (`>&-`)."""
    sys.stdout = sys.stdout or open(os.devnull, "w")  # noqa: SIM115  (until the process ends)
    sys.stderr = sys.stderr or open(os.devnull, "w")  # noqa: SIM115


def main() -> None:
    """Run the command line: exit 0 is good, 1 failed, 2 misused."""
    _open_what_is_closed()
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):  # names need not be text that it can hold
            stream.reconfigure(errors="backslashreplace")
    status = _run_verb()
    try:
        sys.stdout.flush()
    except BrokenPipeError:  # Python would flush once more at exit, and complain
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    sys.exit(status)


def _run_verb() -> int:
    """Run what the command line says, and return its exit status."""
    try:
        app()
    except SystemExit as stop:
        return stop.code if isinstance(stop.code, int) else 0
    except TeamformerError as error:
        print(f"error: {error}", file=sys.stderr)
        if error.hint:
            print(f"hint: {error.hint}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return 1
    except ReaderGoneError:
        return 0
    except OSError as error:  # a disk that fills up while we write, say
        where = f"{error.filename}: " if error.filename else ""
        print(f"error: {where}{error.strerror or error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    main()
