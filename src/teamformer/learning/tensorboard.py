"""Curves of a training for TensorBoard."""

from __future__ import annotations

from pathlib import Path
from types import TracebackType

from teamformer.learning.trainer import IterationReport


class Curves:
    """Writes every report's figures to a folder that TensorBoard shows."""

    def __init__(self, folder: Path) -> None:
        from torch.utils.tensorboard import SummaryWriter

        self._writer = SummaryWriter(str(folder))

    def write(self, report: IterationReport) -> None:
        """Add a point to every curve, at the number of world steps so far."""
        for name, value in figures(report).items():
            self._writer.add_scalar(name, value, report.progress.steps)

    def __enter__(self) -> Curves:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._writer.close()


def figures(report: IterationReport) -> dict[str, float]:
    """Return what there is to plot of an iteration."""
    found = {f"iteration/{name}": value for name, value in report.iteration.figures.items()}
    found["speed/steps per second"] = report.steps_per_second
    if report.score is not None:
        found[f"held out/ratio to {next(iter(report.score.bars))}"] = report.score.ratio
        found["held out/failures"] = report.score.failures
        found["held out/splits"] = report.score.splits
        for number, steps in enumerate(report.score.steps):
            found[f"held out/steps, setting {number + 1}"] = steps
    return found
