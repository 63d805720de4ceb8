"""Flags of the verbs on policies."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

import typer

from teamformer.cli.app import AsJson, app, split_names


@app.command()
def methods() -> None:
    """List what can be named with --method."""
    from teamformer.cli.verbs.policies.listing import methods as command

    raise typer.Exit(command())


@app.command()
def bench(
    suite: Annotated[str, typer.Argument(metavar="SUITE", help="a name, or a .yaml file")],
    worlds: Annotated[
        list[Path] | None,
        typer.Argument(metavar="[WORLDS]...", help="files or folders, for `authors` and `others`"),
    ] = None,
    trials: Annotated[int | None, typer.Option(min=1, help="of each method and setting")] = None,
    methods: Annotated[str, typer.Option(help="names, with commas; else the suite's")] = "",
    settings: Annotated[str, typer.Option(help="the only ones wanted")] = "",
    seed: Annotated[int, typer.Option(min=0, help="of the first world")] = 0,
    time_limit: Annotated[
        float | None, typer.Option(min=0, help="seconds for the method central; others ignore it")
    ] = None,
    out: Annotated[Path | None, typer.Option(help="folder for rows, tables and figures")] = None,
    workers: Annotated[
        int | None, typer.Option(min=1, help="processes; one for each core by default")
    ] = None,
    report: Annotated[
        Path | None, typer.Option(help="write the paper's claims beside what was measured here")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Measure methods on a suite of settings; `speed` times the simulator, `size` large missions.

    Suites: fig3 fig4a fig4b fig5a fig5b fig6 fig9 table1, together `paper`; taught,
    missions, large, uncertain, methods, scale, authors, others, robotarium, fleet.

    Run it again with the same folder to go on after an interruption, or for more trials.
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
        workers=workers or os.cpu_count() or 1,
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
            help="a name, a .yaml file, or the folder of a training to go on with",
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(help="folder, runs/SETTINGS-SEED by default; goes on if it has one"),
    ] = None,
    minutes: Annotated[float | None, typer.Option(min=0, help="at most")] = None,
    seed: Annotated[int | None, typer.Option(min=0, help="else that of the settings")] = None,
) -> None:
    """Train a policy; needs the extra `train`.

    Settings are named as the networks that learned by them: teamformer, teamformer-c4, gnn-c8-ppo.
    """
    from teamformer.cli.verbs.policies.train import TrainOptions
    from teamformer.cli.verbs.policies.train import train as command

    raise typer.Exit(command(TrainOptions(settings, out, minutes, seed)))
