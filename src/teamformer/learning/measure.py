"""Measure a policy on worlds never trained or selected on.

`python -m teamformer.learning.measure` does it.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import torch

from teamformer.base.array_types import Array
from teamformer.base.errors import TeamformerError
from teamformer.files.drawn.generate import generate
from teamformer.files.drawn.named_settings import spec_of
from teamformer.learning.checkpoint import load_policy_weights, read_about
from teamformer.learning.evaluation import torch_brain
from teamformer.learning.nets.actor import Actor
from teamformer.learning.trainer import make_learner
from teamformer.learning.training_settings import TrainSettings
from teamformer.learning.training_worlds import FINAL
from teamformer.methods.learned.codec import Codec
from teamformer.methods.learned.policy import Learned
from teamformer.methods.scripted.heuristic import Heuristic
from teamformer.methods.scripted.joining import JoinAll
from teamformer.methods.seam.protocol import Guarded, Policy
from teamformer.methods.trained_folder import load_trained
from teamformer.mission.model import Mission
from teamformer.trials.list_schedule import list_schedule
from teamformer.trials.trial import run_trials

SETTINGS = {
    name: spec_of(name)
    for name in (
        "4N4T-C4",
        "4N20T-C4",
        "8N20T-C8",
        "20N100T-C4",
        "24N100T-C8",
        "100N20T-C100-R10",
        "100N20T-C100-R20",
        "100N20T-C100-R50",
        "100N20T-C100-R90",
    )
}


@dataclass(frozen=True)
class MeasuredTrials:
    """How the trials of one policy ended."""

    steps: Array  # (worlds,) the step limit where a trial failed
    failures: int
    joins: float  # for each trial
    splits: float
    seconds: float  # of CPU for each trial, simulator included, side by side with the others


def measure(policy: Policy, worlds: Sequence[Mission]) -> MeasuredTrials:
    """Run one trial of each world."""
    begun = time.process_time()
    tallies = run_trials(worlds, policy)
    return MeasuredTrials(
        steps=np.array([tally.steps for tally in tallies]),
        failures=sum(tally.status != "completed" for tally in tallies),
        joins=float(np.mean([tally.joins for tally in tallies])),
        splits=float(np.mean([tally.splits for tally in tallies])),
        seconds=(time.process_time() - begun) / len(worlds),
    )


def mean_and_error(values: Array) -> tuple[float, float]:
    """Return a mean and its standard error."""
    return float(values.mean()), float(values.std(ddof=1) / np.sqrt(len(values)))


def final_worlds(name: str, count: int) -> list[Mission]:
    """Return the worlds of a setting that figures are reported on."""
    rng = np.random.default_rng([FINAL, *name.encode()])
    return [generate(SETTINGS[name], rng, name) for _ in range(count)]


def main() -> None:
    """Print a line of Markdown for each setting that fits the training's network."""
    options = _parser().parse_args()
    torch.set_num_threads(1)
    print(
        "| setting | greedy | sampled | bar | greedy - bar | list schedule | heuristic "
        "| failures, without rule, sampled | overdue | joins, splits | CPU ms a trial |"
    )
    print("|---|---|---|---|---|---|---|---|---|---|---|")
    about = read_about(options.folder / "best")["settings"]
    rules = {"sensing_radius": options.sensing}
    for name in options.settings:
        if about["capabilities"] in (None, SETTINGS[name].capabilities):
            drawn = final_worlds(name, options.worlds)
            worlds = [replace(world, **rules) for world in drawn]
            print(_line(name, worlds, options.folder / "best"), flush=True)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m teamformer.learning.measure", description=__doc__
    )
    parser.add_argument("folder", type=Path, help="a training's folder")
    parser.add_argument("--worlds", type=int, default=200)
    parser.add_argument("--settings", nargs="*", default=list(SETTINGS), choices=SETTINGS)
    parser.add_argument("--sensing", type=float, default=1.0, help="cells; inf: everybody")
    return parser


def _line(name: str, worlds: Sequence[Mission], folder: Path) -> str:
    policy = load_trained(folder)
    if not isinstance(policy, Learned):
        hint = "use teamformer bench learned --methods FOLDER"
        raise TeamformerError(
            f"{folder} holds a method that plans, which views do not measure", hint
        )
    played, bar = measure(policy, worlds), measure(JoinAll(), worlds)
    overdue = policy.overdue if isinstance(policy, Guarded) else 0
    heuristic = measure(Heuristic(), worlds)
    codec, network = load_network(folder)
    bare = measure(Learned(codec, torch_brain(network), is_guarded=False), worlds)
    generator = torch.Generator().manual_seed(0)
    sampled = measure(Learned(codec, torch_brain(network, generator=generator)), worlds)
    less, less_error = mean_and_error(played.steps - bar.steps)
    room = np.mean([list_schedule(world) for world in worlds])
    return (
        f"| {name} | {_with_error(played)} | {_with_error(sampled)} | {_with_error(bar)} "
        f"| {less:+.2f} ± {less_error:.2f} ({100 * less / bar.steps.mean():+.1f}%) "
        f"| {room:.1f} | {_with_error(heuristic)} "
        f"| {played.failures}, {bare.failures}, {sampled.failures} "
        f"| {overdue} | {played.joins:.1f}, {played.splits:.1f} | {1000 * played.seconds:.1f} |"
    )


def _with_error(played: MeasuredTrials) -> str:
    mean, error = mean_and_error(played.steps)
    return f"{mean:.1f} ± {error:.1f}"


def load_network(folder: Path) -> tuple[Codec, Actor]:
    """Return a checkpoint's network and what it reads."""
    about = read_about(folder)["settings"]
    settings = TrainSettings(network=about["network"], capabilities=about["capabilities"])
    learner = make_learner(settings)
    load_policy_weights(folder, learner)
    return settings.architecture.codec_for(settings.capabilities), learner.policy  # type: ignore[return-value]


if __name__ == "__main__":
    main()
