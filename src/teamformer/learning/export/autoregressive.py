"""Exports the paper's network to two ONNX files: one encodes views, one decodes steps."""

from __future__ import annotations

from pathlib import Path

import onnx
import torch
from torch import Tensor, nn

from teamformer.learning.export.onnx_export import write_onnx
from teamformer.learning.nets.action_mask import symbols
from teamformer.learning.nets.blocks import Memory
from teamformer.learning.nets.teamformer import Encoded, Teamformer, Tokens
from teamformer.methods.learned.autoregressive import (
    ENCODER_FILE,
    ENCODER_INPUTS,
    ENCODER_OUTPUTS,
    STEP_FILE,
    STEP_INPUTS,
    STEP_OUTPUTS,
)


class _Encoder(nn.Module):
    """From tokens to what the decoder needs, with all its keys and values in one tensor."""

    def __init__(self, network: Teamformer) -> None:
        super().__init__()
        self.network = network

    def forward(self, *parts: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        nothing = parts[0].new_zeros(0)  # robots matter only for what is legal
        encoded = self.network.encode(Tokens(*(*parts, nothing, nothing)))
        return encoded.is_there, encoded.keys, _stack(encoded.memories)


class _Step(nn.Module):
    """From new symbols to the scores of the next, and the memory of all symbols so far.

    Here and in the network what is true or false is turned into numbers before a parameter is
    multiplied by it: the exporter of torch 2.11 fails where that is left to it.
    """

    def __init__(self, network: Teamformer) -> None:
        super().__init__()
        self.network = network

    def forward(self, *parts: Tensor) -> tuple[Tensor, Tensor]:
        change, spelled, is_maintain, is_there, keys, memories, before = parts
        encoded = Encoded(is_there, keys, _unstack(memories))
        scores, after = self.network.decode(encoded, change, spelled, _unstack(before))
        bias = self.network.maintain_bias * is_maintain.to(scores.dtype)
        return scores[:, -1] + bias, _stack(after)


def export_teamformer(network: nn.Module, capabilities: int | None, folder: Path) -> None:
    """Write both files into a folder, with what is not in the graphs among their properties."""
    assert isinstance(network, Teamformer)
    settings = network.settings
    teams, seen, tasks = (torch.export.Dim(name, min=1) for name in ("teams", "seen", "tasks"))
    of_teams, of_tasks = {0: teams, 1: seen}, {0: teams, 1: tasks}
    write_onnx(
        _Encoder(network),
        _tokens(settings.capabilities, settings.team_features, settings.task_features),
        ENCODER_INPUTS,
        ENCODER_OUTPUTS,
        folder / ENCODER_FILE,
        (of_teams, of_teams, of_tasks, of_tasks, of_teams, of_tasks, of_teams),
    )
    tokens, steps = torch.export.Dim("tokens", min=1), torch.export.Dim("steps", min=1)
    before = torch.export.Dim("before", min=0)
    of_steps = {0: teams, 1: steps}
    write_onnx(
        _Step(network),
        _steps(network),
        STEP_INPUTS,
        STEP_OUTPUTS,
        folder / STEP_FILE,
        (
            of_steps,
            of_steps,
            {0: teams},
            {0: teams, 1: tokens},
            {0: teams},
            {0: teams, 4: tokens},
            {0: teams, 4: before},
        ),
    )
    for file in (ENCODER_FILE, STEP_FILE):
        _describe(folder / file, settings.spelling, settings.capabilities)


def _describe(file: Path, spelling: str, capabilities: int) -> None:
    model = onnx.load(file)
    onnx.helper.set_model_props(
        model, {"spelling": spelling, "capabilities": str(capabilities), "part": file.stem}
    )
    onnx.save(model, file)


def _stack(memories: tuple[Memory, ...]) -> Tensor:
    """Return (teams, layers, keys and values, heads, tokens, d / heads)."""
    return torch.stack([torch.stack(memory, dim=1) for memory in memories], dim=1)


def _unstack(memories: Tensor) -> tuple[Memory, ...]:
    return tuple((memories[:, n, 0], memories[:, n, 1]) for n in range(memories.shape[1]))


def _tokens(caps: int, team_features: int, task_features: int) -> tuple[Tensor, ...]:
    teams, seen, tasks = 3, 4, 5
    return (
        torch.zeros(teams, seen, team_features),
        torch.zeros(teams, seen, caps),
        torch.zeros(teams, tasks, task_features),
        torch.zeros(teams, tasks, caps),
        torch.ones(teams, seen, dtype=torch.bool),
        torch.ones(teams, tasks, dtype=torch.bool),
        torch.ones(teams, seen, dtype=torch.bool),
    )


def _steps(network: Teamformer) -> tuple[Tensor, ...]:
    teams, steps, tokens, before = 3, 2, 9, 4
    settings = network.settings
    caps, d = settings.capabilities, settings.width
    of_heads = (settings.heads, -1, d // settings.heads)
    layers = settings.decoder_layers
    return (
        torch.zeros(teams, steps, caps),
        torch.zeros(teams, steps, caps),
        torch.zeros(teams, symbols(settings.spelling, caps), dtype=torch.bool),
        torch.ones(teams, tokens, dtype=torch.bool),
        torch.zeros(teams, caps, d),
        torch.zeros(teams, layers, 2, tokens * d).view(teams, layers, 2, *of_heads),
        torch.zeros(teams, layers, 2, before * d).view(teams, layers, 2, *of_heads),
    )
