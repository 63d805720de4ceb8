"""The network in NumPy says what ONNX Runtime says."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from teamformer.base.array_types import Array
from teamformer.base.errors import TeamformerError
from teamformer.methods.by_name import load_method
from teamformer.methods.learned import autoregressive, combinations
from teamformer.methods.learned.onnx_sessions import OnnxNetwork, shipped
from teamformer.methods.learned.relational_features import Relations, relate
from teamformer.methods.learned.shipped import ANY_FLEET
from teamformer.robotarium.deployment.graphs import Node
from teamformer.robotarium.deployment.numpy_network import NumpyNetwork
from teamformer.robotarium.deployment.onnx_files import read_graph
from teamformer.robotarium.random_missions import random_mission
from teamformer.trials.trial import run_trial
from teamformer.world.env import TeamFormation


def test_the_shipped_network_scores_alike() -> None:
    content = shipped(f"{ANY_FLEET}.onnx")
    graph = read_graph(content)
    assert graph.inputs == Relations._fields
    worlds = [random_mission(20, 5, 10, np.random.default_rng(seed)) for seed in range(3)]
    tokens = relate(TeamFormation(worlds).view())
    [ours] = NumpyNetwork(graph)(*tokens)
    [theirs] = OnnxNetwork(content, ANY_FLEET, Relations._fields)(*tokens)
    assert ours.shape == theirs.shape
    np.testing.assert_allclose(ours, theirs, rtol=1e-4, atol=1e-4)


class InNumpy(OnnxNetwork):
    """A network's file, run in NumPy instead."""

    def __init__(self, content: bytes, name: str, inputs: tuple[str, ...]) -> None:
        super().__init__(content, name, inputs)
        self.network = NumpyNetwork(read_graph(content))

    def __call__(self, *values: Array) -> list[Array]:
        return self.network(*values)


PAPERS = [
    f"{family}{how}"
    for family in ("teamformer-c4", "teamformer-c8", "deepset-c4", "gnn-c4", "gnn-c8")
    for how in ("", "-ppo")
]


@pytest.mark.parametrize("name", PAPERS)
def test_the_networks_of_the_paper_decide_alike(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whole missions come to the same steps, whoever runs the network's files."""
    worlds = [random_mission(4, 5, 4, np.random.default_rng(seed)) for seed in range(3)]
    theirs = [run_trial(world, load_method(name), 0).record for world in worlds]

    for module in (autoregressive, combinations):
        monkeypatch.setattr(module, "OnnxNetwork", InNumpy)
    ours = [run_trial(world, load_method(name), 0).record for world in worlds]
    assert ours == theirs


def test_a_file_that_is_cut_off_is_refused() -> None:
    content = shipped(f"{ANY_FLEET}.onnx")
    for end in (0, 1, 100, len(content) // 2, len(content) - 1):
        with pytest.raises(TeamformerError, match="no ONNX file"):
            read_graph(content[:end])


def test_an_unknown_operation_is_refused() -> None:
    graph = read_graph(shipped(f"{ANY_FLEET}.onnx"))
    with pytest.raises(TeamformerError, match="Conv"):
        NumpyNetwork(replace(graph, nodes=(Node("Conv", (), (), {}),)))
