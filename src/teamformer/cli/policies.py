"""Flags of the verbs on policies."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

import typer

from teamformer.cli.app import AsJson, Seed, app, is_given, split_names
from teamformer.errors import TeamformerError


@app.command()
def methods(as_json: AsJson = False) -> None:
    """List what can be named with --method."""
    from teamformer.commands.policies.listing import methods as command

    raise typer.Exit(command(as_json))


@app.command()
def bench(
    suite: Annotated[str, typer.Argument(metavar="SUITE", help="a name, or a .yaml file")],
    trials: Annotated[int | None, typer.Option(min=1, help="of each method and setting")] = None,
    methods: Annotated[str, typer.Option(help="names, with commas; else the suite's")] = "",
    without: Annotated[str, typer.Option(help="methods to leave out")] = "",
    settings: Annotated[str, typer.Option(help="the only ones wanted")] = "",
    seed: Annotated[int, typer.Option(min=0, help="of the first world")] = 0,
    time_limit: Annotated[
        float | None, typer.Option(min=0, help="seconds that central may plan")
    ] = None,
    worlds: Annotated[
        list[Path] | None, typer.Option(help="files or folders, for `authors` and `others`")
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
    """Measure methods on a suite of settings; `speed` times the simulator.

    Suites: fig3 fig4a fig4b fig5a fig5b fig6 fig9 table1, together `paper`; taught,
    missions, uncertain, methods, scale, authors, others, robotarium.

    Run it again with the same folder to go on after an interruption, or for more trials.
    """
    from teamformer.commands.policies.bench import BenchOptions
    from teamformer.commands.policies.bench import bench as command

    options = BenchOptions(
        trials=trials,
        seed=seed,
        time_limit=time_limit,
        methods=split_names(methods),
        without=split_names(without),
        settings=split_names(settings),
        worlds=tuple(worlds or ()),
        workers=workers or os.cpu_count() or 1,
        engine=engine,
        folder=out,
        results=report,
        beside=tuple(beside or ()),
    )
    raise typer.Exit(command(suite, options, as_json))


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
    algorithm: Annotated[
        str | None, typer.Option(help="rollouts, ppo or imitation; the network's own by default")
    ] = None,
    reward: Annotated[
        str, typer.Option(help="of ppo; mission, or team as in the paper")
    ] = "mission",
    seed: Seed = 0,
    device: Annotated[str, typer.Option(help="cpu or cuda")] = "cpu",
    as_json: AsJson = False,
) -> None:
    """Train a policy; needs torch: pip install 'teamformer[train]'."""
    from teamformer.commands.policies.train import TrainOptions
    from teamformer.commands.policies.train import train as command

    for name, given, known in (
        ("--device", device, ("cpu", "cuda")),
        ("--reward", reward, ("mission", "team")),
    ):
        if given not in known:
            raise TeamformerError(f"{name} {given} is unknown", f"use {' or '.join(known)}")
    anew = ("minutes", "device", "resume", "as_json")
    given_too = [name for name in context.params if is_given(context, name) and name not in anew]
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
        method=algorithm,
        reward=reward,
        seed=seed,
        device=device,
        folder=out,
        resume=resume,
    )
    raise typer.Exit(command(options, as_json))
