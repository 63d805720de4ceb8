"""Measure a policy on worlds never trained or selected on: `python -m teamformer.train.measure`."""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from teamformer.model import Grid, Scenario
from teamformer.policies.heuristic import Heuristic
from teamformer.policies.learned import Learned, OnnxScorer
from teamformer.policies.protocol import Policy
from teamformer.policies.scripted import JoinAll
from teamformer.policies.trial import run_trials
from teamformer.scenarios.generate import Spec, generate
from teamformer.sim.arrays import Array
from teamformer.train.worlds import FINAL

LARGE = Grid(20, 20)
SETTINGS = {
    "4N4T-C4": Spec(4, 4, 4),
    "4N20T-C4": Spec(4, 20, 4),
    "8N20T-C8": Spec(8, 20, 8),
    "20N100T-C4": Spec(20, 100, 4, world=LARGE),
    "24N100T-C8": Spec(24, 100, 8, world=LARGE),
    "100N20T-R10": Spec(100, 20, 100, requirements=10, world=LARGE),
    "100N20T-R50": Spec(100, 20, 100, requirements=50, world=LARGE),
    "100N20T-R90": Spec(100, 20, 100, requirements=90, world=LARGE),
}


@dataclass(frozen=True)
class Played:
    """How the trials of one policy ended."""

    steps: Array  # (worlds,) the step limit where a trial failed
    failures: int
    joins: float  # for each trial
    splits: float
    seconds: float  # for each trial, side by side with the others


def measure(policy: Policy, worlds: Sequence[Scenario]) -> Played:
    """Run one trial of each world."""
    begun = time.perf_counter()
    tallies = run_trials(worlds, policy)
    return Played(
        steps=np.array([tally.steps for tally in tallies]),
        failures=sum(tally.status != "completed" for tally in tallies),
        joins=float(np.mean([tally.joins for tally in tallies])),
        splits=float(np.mean([tally.splits for tally in tallies])),
        seconds=(time.perf_counter() - begun) / len(worlds),
    )


def mean_and_error(values: Array) -> tuple[float, float]:
    """Return a mean and its standard error."""
    return float(values.mean()), float(values.std(ddof=1) / np.sqrt(len(values)))


def final_worlds(name: str, count: int) -> list[Scenario]:
    """Return the worlds of a setting that figures are reported on."""
    rng = np.random.default_rng([FINAL, list(SETTINGS).index(name)])
    return [generate(SETTINGS[name], rng, name) for _ in range(count)]


def main() -> None:
    """Print a line of Markdown for each setting."""
    parser = argparse.ArgumentParser(prog="python -m teamformer.train.measure", description=__doc__)
    parser.add_argument("--onnx", type=Path, help="the shipped network if left out")
    parser.add_argument("--worlds", type=int, default=200)
    parser.add_argument("--settings", nargs="*", default=list(SETTINGS), choices=SETTINGS)
    options = parser.parse_args()
    print(
        "| setting | teamformer-any | join-all | difference | heuristic | failures, without rule "
        "| overdue | joins, splits | ms a trial |"
    )
    print("|---|---|---|---|---|---|---|---|---|")
    for name in options.settings:
        print(_line(name, final_worlds(name, options.worlds), options.onnx), flush=True)


def _line(name: str, worlds: Sequence[Scenario], onnx: Path | None) -> str:
    learned = Learned(OnnxScorer(onnx))
    played, bar = measure(learned, worlds), measure(JoinAll(), worlds)
    heuristic = measure(Heuristic(), worlds)
    bare = measure(Learned(OnnxScorer(onnx), with_liveness=False), worlds)
    mean, error = mean_and_error(played.steps)
    bar_mean, bar_error = mean_and_error(bar.steps)
    less, less_error = mean_and_error(played.steps - bar.steps)
    slow, slow_error = mean_and_error(heuristic.steps)
    return (
        f"| {name} | {mean:.1f} ± {error:.1f} | {bar_mean:.1f} ± {bar_error:.1f} "
        f"| {less:+.2f} ± {less_error:.2f} ({100 * less / bar_mean:+.1f}%) "
        f"| {slow:.1f} ± {slow_error:.1f} | {played.failures}, {bare.failures} "
        f"| {learned.overdue} | {played.joins:.1f}, {played.splits:.1f} "
        f"| {1000 * played.seconds:.1f} |"
    )


if __name__ == "__main__":
    main()
