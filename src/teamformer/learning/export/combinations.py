"""Exports the deep set and the graph network to ONNX."""

from __future__ import annotations

from pathlib import Path

import torch
from torch import nn

from teamformer.learning.export.onnx_export import NETWORK_FILE, write_onnx
from teamformer.methods.learned.combinations import Combined, task_features, team_features


def export_combinations(network: nn.Module, capabilities: int | None, folder: Path) -> None:
    """Write a network into a folder; inputs are named as in `Combined`."""
    assert capabilities is not None
    count, seen, tasks = (torch.export.Dim(name, min=1) for name in ("count", "seen", "tasks"))
    of_teams, of_tasks = {0: count, 1: seen}, {0: count, 1: tasks}
    example = (
        torch.zeros(3, 4, team_features(capabilities)),
        torch.zeros(3, 5, task_features(capabilities)),
        torch.ones(3, 4, dtype=torch.bool),
        torch.ones(3, 5, dtype=torch.bool),
        torch.ones(3, 2 ** (capabilities + 1), dtype=torch.bool),
    )
    shapes = (of_teams, of_tasks, of_teams, of_tasks, {0: count})
    write_onnx(network, example, Combined._fields, ("scores",), folder / NETWORK_FILE, shapes)
