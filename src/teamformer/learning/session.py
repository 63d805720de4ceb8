"""A training as a user runs it: one process or many, a table's rows and TensorBoard's curves."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import torch

from teamformer.base.errors import TeamformerError
from teamformer.learning.algorithms import distributed
from teamformer.learning.task_worlds import task_selection
from teamformer.learning.tensorboard import Curves
from teamformer.learning.trainer import IterationReport, train
from teamformer.learning.training_settings import TrainSettings
from teamformer.learning.training_worlds import selection_worlds


def run_session(
    settings: TrainSettings,
    folder: Path,
    on_report: Callable[[IterationReport], None],
    begun: float | None = None,
) -> bool:
    """Train, selecting on worlds of the settings' own; return whether we are the first process.

    Its minutes are counted from `begun` on, by `time.perf_counter`, or from now. Started by
    torchrun, all processes train one policy; only the first one reports.
    """
    if settings.device == "cuda" and not torch.cuda.is_available():
        raise TeamformerError("torch finds no CUDA device", "write device: cpu")
    torch.set_num_threads(1)
    architecture = settings.architecture
    if architecture.codec is None:
        worlds = task_selection(settings.held_out)
    else:
        worlds = selection_worlds(settings.held_out, architecture.selection(settings.capabilities))
    with distributed.joined(settings.device):
        if distributed.rank() > 0:
            train(settings, folder, worlds, begun=begun)
            return False
        with Curves(folder / "tensorboard") as board:

            def report_twice(report: IterationReport) -> None:
                board.write(report)
                on_report(report)

            train(settings, folder, worlds, report_twice, begun=begun)
        return True
