"""Exports trained networks to ONNX, which runs without torch."""

from __future__ import annotations

import logging
import warnings
from pathlib import Path

import onnx
import torch
from torch import nn

from teamformer.methods.learned.dispatch.offers import FEATURES, MOST_OFFERS, OFFER_INPUTS
from teamformer.methods.learned.macro_actions import CHOICES, TASKS, TEAMS
from teamformer.methods.learned.relational_features import (
    OWN_FEATURES,
    TASK_FEATURES,
    TEAM_FEATURES,
    Relations,
)

NETWORK_FILE = "network.onnx"


def export_any_fleet(network: nn.Module, capabilities: int | None, folder: Path) -> None:
    """Write the network for any fleet; inputs are named as in `Relations`."""
    write_onnx(network, _example(), Relations._fields, ("scores",), folder / NETWORK_FILE)


def export_offers(network: nn.Module, capabilities: int | None, folder: Path) -> None:
    """Write the network that scores offers; inputs are those of `OFFER_INPUTS`."""
    example = (
        torch.zeros(3, MOST_OFFERS, FEATURES),
        torch.ones(3, MOST_OFFERS, dtype=torch.bool),
    )
    write_onnx(network, example, OFFER_INPUTS, ("scores",), folder / NETWORK_FILE)


def write_onnx(
    network: nn.Module,
    example: tuple[torch.Tensor, ...],
    inputs: tuple[str, ...],
    outputs: tuple[str, ...],
    file: Path,
    axes: tuple[dict[int, torch.export.Dim], ...] = (),
) -> None:
    """Write a network that takes tensors (teams, ...) by position, for any number of teams.

    `axes` says for each input which axes may have any size; as a rule the first.
    """
    file.parent.mkdir(parents=True, exist_ok=True)
    any_teams = {0: torch.export.Dim("count", min=1)}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of the exporter's own making
        logging.getLogger("torch.onnx").setLevel(logging.ERROR)  # it misses torchvision
        program = torch.onnx.export(
            network.eval().cpu(),
            example,
            dynamo=True,
            input_names=list(inputs),
            output_names=list(outputs),
            dynamic_shapes=(axes or tuple(any_teams for _ in inputs),),
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
