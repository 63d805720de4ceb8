"""Train the policy for any fleet: `python -m teamformer.train FOLDER --iterations 500`."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import torch

from teamformer.train.ppo import PpoSettings
from teamformer.train.trainer import Report, TrainSettings, train
from teamformer.train.worlds import selection_worlds


def main() -> None:
    """Train, printing a line for each iteration; Ctrl-C keeps the last checkpoint."""
    parser = argparse.ArgumentParser(prog="python -m teamformer.train", description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--iterations", type=int, default=TrainSettings.iterations)
    parser.add_argument("--worlds", type=int, default=TrainSettings.worlds)
    parser.add_argument("--cloning", type=int, default=TrainSettings.cloning)
    parser.add_argument("--seed", type=int, default=TrainSettings.seed)
    parser.add_argument("--entropy", type=float, default=PpoSettings.entropy)
    parser.add_argument("--begin-from", default="", help="take the weights of this checkpoint")
    parser.add_argument("--evaluate-every", type=int, default=TrainSettings.evaluate_every)
    parser.add_argument("--held-out", type=int, default=48, help="worlds of each setting")
    options = parser.parse_args()
    torch.set_num_threads(1)
    settings = TrainSettings(
        seed=options.seed,
        iterations=options.iterations,
        worlds=options.worlds,
        cloning=options.cloning,
        ppo=PpoSettings(entropy=options.entropy),
        begin_from=options.begin_from,
        evaluate_every=options.evaluate_every,
    )
    try:
        train(settings, options.folder, selection_worlds(options.held_out), _print)
    except KeyboardInterrupt:
        sys.exit(f"stopped; the same command goes on from {options.folder / 'last'}")


def _print(report: Report) -> None:
    update, score = report.update, report.score
    line = (
        f"{report.progress.iteration:5d}  {report.progress.steps:9d} steps  "
        f"{report.seconds:5.1f} s  reward {report.reward:6.3f}  ended {report.ended:.3f}  "
        f"decisions {report.decisions:6d}  splits {report.splits:5.2f}"
    )
    if update:
        line += f"  entropy {update.entropy:.3f}  value loss {update.value_loss:.3f}"
        line += f"  clipped {update.clipped:.3f}"
    if score:
        line += f"  | held out {score.ratio:.4f} of join-all, {score.failures} failures"
        line += f", {score.splits:.1f} splits; " + " ".join(f"{r:.3f}" for r in score.ratios)
    print(line, flush=True)


if __name__ == "__main__":
    main()
