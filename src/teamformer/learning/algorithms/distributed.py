"""Several processes that train one policy: each plays its own worlds, gradients are averaged.

Started by torchrun, which sets RANK and WORLD_SIZE; a single process is the only rank.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager

import torch
import torch.distributed as dist
from torch import Tensor, nn


def rank() -> int:
    """Return this process's number, from 0."""
    return dist.get_rank() if dist.is_initialized() else 0


def count() -> int:
    """Return how many processes train together."""
    return dist.get_world_size() if dist.is_initialized() else 1


@contextmanager
def joined(device: str) -> Iterator[None]:
    """Join the other processes if torchrun started this one."""
    if "WORLD_SIZE" not in os.environ or dist.is_initialized():
        yield
        return
    dist.init_process_group("nccl" if device.startswith("cuda") else "gloo")
    try:
        yield
    finally:
        dist.destroy_process_group()


def average_gradients(network: nn.Module) -> None:
    """Replace every gradient by its mean over the processes."""
    if count() == 1:
        return
    parameters = list(network.parameters())
    flat = torch.cat([_gradient(weights).flatten() for weights in parameters])
    dist.all_reduce(flat)
    flat /= count()
    begin = 0
    for weights in parameters:
        part = flat[begin : begin + weights.numel()]
        weights.grad = part.view_as(weights)
        begin += weights.numel()


def largest(number: int, device: str = "cpu") -> int:
    """Return the largest of the processes' numbers."""
    if count() == 1:
        return number
    shared = torch.tensor(number, device=device)
    dist.all_reduce(shared, dist.ReduceOp.MAX)
    return int(shared)


def agreed(numbers: list[float], device: str = "cpu") -> list[float]:
    """Return the first process's numbers, so that all go by the same."""
    if count() == 1:
        return numbers
    shared = torch.tensor(numbers, dtype=torch.float64, device=device)
    dist.broadcast(shared, 0)
    result: list[float] = shared.tolist()
    return result


def _gradient(weights: Tensor) -> Tensor:
    return torch.zeros_like(weights) if weights.grad is None else weights.grad
