"""Training in several processes: averaged gradients, one policy."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
import torch
import torch.distributed as dist
from safetensors.torch import load_file
from torch import multiprocessing, nn

from teamformer.learning.algorithms import distributed
from teamformer.learning.checkpoint import WEIGHTS


def two_layers() -> nn.Sequential:
    torch.manual_seed(0)
    return nn.Sequential(nn.Linear(3, 2), nn.Linear(2, 1))


def fill(network: nn.Module, value: float) -> None:
    for weights in network.parameters():
        weights.grad = torch.full_like(weights, value)


def test_alone_nothing_changes() -> None:
    network = two_layers()
    fill(network, 5.0)
    distributed.average_gradients(network)
    assert all((weights.grad == 5.0).all() for weights in network.parameters())
    assert (
        distributed.rank(),
        distributed.count(),
        distributed.largest(7),
        distributed.agreed([2.5]),
    ) == (0, 1, 7, [2.5])


def _as_one_of_two(rank: int, folder: str) -> None:
    dist.init_process_group("gloo", f"file://{folder}/meet", rank=rank, world_size=2)
    network = two_layers()
    fill(network, float(1 + 2 * rank))  # 1 and 3
    if rank == 0:
        network[1].bias.grad = None  # a part that one process had no use for
    distributed.average_gradients(network)
    seen = [weights.grad.unique().tolist() for weights in network.parameters()]
    found = (
        seen,
        distributed.count(),
        distributed.largest(10 + rank),
        distributed.agreed([0.5 + rank, 2.0]),
    )
    torch.save(found, f"{folder}/{rank}.pt")
    dist.destroy_process_group()


def test_two_processes_average_and_agree(tmp_path: Path) -> None:
    multiprocessing.spawn(_as_one_of_two, (str(tmp_path),), nprocs=2)  # type: ignore[no-untyped-call]
    for rank in range(2):
        seen, count, largest, agreed = torch.load(tmp_path / f"{rank}.pt")
        assert seen == [[2.0], [2.0], [2.0], [1.5]]  # in the order of the parameters
        assert (count, largest, agreed) == (2, 11, [0.5, 2.0])


@pytest.mark.slow
def test_torchrun_trains_one_policy_in_two_processes(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "torch.distributed.run", "--nproc-per-node", "2", "-m"]
    (tmp_path / "short.yaml").write_text("iterations: 2\nworlds: 16\nheld_out: 2\n")
    command += ["teamformer.cli", "train", str(tmp_path / "short.yaml")]
    for name in ("a", "b"):
        done = subprocess.run(
            [*command, "--out", str(tmp_path / name)],
            capture_output=True,
            text=True,
            env={**os.environ, "OMP_NUM_THREADS": "1"},
        )
        assert done.returncode == 0, done.stderr
        assert (
            done.stdout.count("\n") == 4
        )  # one process prints: a header, two rows, and what scripts take
    one, other = (load_file(tmp_path / name / "last" / WEIGHTS) for name in ("a", "b"))
    assert all(torch.equal(one[key], other[key]) for key in one)
