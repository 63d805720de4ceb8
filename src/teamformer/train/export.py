"""Exports a trained network to ONNX, which runs without torch."""

from __future__ import annotations

import warnings
from pathlib import Path

import onnx
import torch

from teamformer.nets.relational import RelationalPolicy, Tokens
from teamformer.policies.choices import CHOICES, TASKS, TEAMS
from teamformer.policies.relations import (
    OWN_FEATURES,
    TASK_FEATURES,
    TEAM_FEATURES,
    Relations,
)


class _Flat(torch.nn.Module):
    """The network with its tokens as separate inputs."""

    def __init__(self, network: RelationalPolicy) -> None:
        super().__init__()
        self.network = network

    def forward(self, *tokens: torch.Tensor) -> torch.Tensor:
        scores: torch.Tensor = self.network(Tokens(*tokens))
        return scores


def export(network: RelationalPolicy, file: Path) -> None:
    """Write a network for any number of teams; inputs are named as in `Relations`."""
    file.parent.mkdir(parents=True, exist_ok=True)
    any_teams = {0: torch.export.Dim("count", min=1)}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of the exporter's own making
        program = torch.onnx.export(
            _Flat(network).eval(),
            _example(),
            dynamo=True,
            input_names=list(Relations._fields),
            output_names=["scores"],
            dynamic_shapes={"tokens": tuple(any_teams for _ in Relations._fields)},
            external_data=False,
            verbose=False,
        )
    assert program is not None
    model = program.model_proto
    for node in model.graph.node:
        del node.metadata_props[:]  # stack traces with the paths of this machine
    onnx.save(model, file)


def _example() -> tuple[torch.Tensor, ...]:
    teams = 3
    return (
        torch.zeros(teams, OWN_FEATURES),
        torch.zeros(teams, TEAMS, TEAM_FEATURES),
        torch.zeros(teams, TASKS, TASK_FEATURES),
        torch.ones(teams, TEAMS, dtype=torch.bool),
        torch.ones(teams, TASKS, dtype=torch.bool),
        torch.ones(teams, CHOICES, dtype=torch.bool),
    )
