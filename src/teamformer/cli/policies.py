"""Flags of the verbs on policies."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from teamformer.cli.app import AsJson, app, split_names


@app.command()
def methods() -> None:
    """List the methods by name."""
    from teamformer.cli.verbs.policies.listing import methods as command

    raise typer.Exit(command())


@app.command()
def bench(
    suite: Annotated[
        str, typer.Argument(metavar="SUITE", help="name of a suite, or a .yaml file with one")
    ],
    worlds: Annotated[
        list[Path] | None,
        typer.Argument(metavar="[WORLDS]...", help="files or folders, for `authors` and `others`"),
    ] = None,
    trials: Annotated[int | None, typer.Option(min=1, help="worlds for each setting")] = None,
    methods: Annotated[
        str, typer.Option(help="names, separated by commas; by default those of the suite")
    ] = "",
    settings: Annotated[
        str, typer.Option(help="names, separated by commas; by default all of the suite")
    ] = "",
    seed: Annotated[int, typer.Option(min=0, help="seed of the first world")] = 0,
    time_limit: Annotated[
        float | None, typer.Option(min=0, help="seconds for --method central; others ignore it")
    ] = None,
    out: Annotated[
        Path | None, typer.Option(help="folder to write rows, tables and figures into")
    ] = None,
    workers: Annotated[
        int | None, typer.Option(min=1, help="number of processes; by default one for each core")
    ] = None,
    report: Annotated[
        Path | None,
        typer.Option(help="document to write: the paper's claims beside these measurements"),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Measure methods on the settings of a suite.

    Suites: missions, large, uncertain, learned, others, fleet, robotarium; in continuous time
    roads, clock, shifts, optional, charging, zones; of the paper fig3 fig4a fig4b fig5a fig5b fig6
    fig9 table1 (together `paper`), scale, methods, authors, taught. `speed` times the simulator,
    `size` large missions.

    The same command goes on after an interruption, or adds trials.
    """
    from teamformer.cli.verbs.policies.bench import BenchOptions
    from teamformer.cli.verbs.policies.bench import bench as command

    options = BenchOptions(
        trials=trials,
        seed=seed,
        time_limit=time_limit,
        methods=split_names(methods),
        settings=split_names(settings),
        worlds=tuple(worlds or ()),
        workers=workers,
        folder=out,
        results=report,
    )
    raise typer.Exit(command(suite, options, as_json))


@app.command()
def train(
    settings: Annotated[
        str | None,
        typer.Argument(
            metavar="SETTINGS",
            help="a name, a .yaml file, or the folder of a training to continue",
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            help="folder, by default runs/SETTINGS-SEED; a training that is there is continued"
        ),
    ] = None,
    minutes: Annotated[
        float | None, typer.Option(min=0, help="minutes from the first start, after which it stops")
    ] = None,
    seed: Annotated[int | None, typer.Option(min=0, help="by default that of the settings")] = None,
) -> None:
    """Train a policy; needs the extra `train`.

    Settings are named as the networks that learned by them: teamformer, teamformer-c4, gnn-c8-ppo.
    """
    from teamformer.cli.verbs.policies.train import TrainOptions
    from teamformer.cli.verbs.policies.train import train as command

    raise typer.Exit(command(TrainOptions(settings, out, minutes, seed)))
