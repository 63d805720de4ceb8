"""The network in NumPy says what ONNX Runtime says."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from teamformer.errors import TeamformerError
from teamformer.policies.learned.onnx_sessions import OnnxNetwork, shipped
from teamformer.policies.learned.relational_features import Relations, relate
from teamformer.policies.learned.shipped import ANY_FLEET
from teamformer.robotarium.deployment.graphs import Node, read_graph
from teamformer.robotarium.deployment.numpy_network import NumpyNetwork
from teamformer.robotarium.random_missions import random_mission
from teamformer.sim.env import TeamFormation


def test_the_shipped_network_scores_alike() -> None:
    content = shipped(f"{ANY_FLEET}.onnx")
    graph = read_graph(shipped(f"{ANY_FLEET}.npz"))
    assert graph.inputs == Relations._fields
    worlds = [random_mission(20, 5, 10, np.random.default_rng(seed)) for seed in range(3)]
    tokens = relate(TeamFormation(worlds).view())
    [ours] = NumpyNetwork(graph)(*tokens)
    [theirs] = OnnxNetwork(content, ANY_FLEET, Relations._fields)(*tokens)
    assert ours.shape == theirs.shape
    np.testing.assert_allclose(ours, theirs, rtol=1e-4, atol=1e-4)


def test_the_shipped_arrays_are_those_of_the_shipped_network() -> None:
    numpy_graph = pytest.importorskip("teamformer.train.export.numpy_graph").numpy_graph
    shipped_graph = read_graph(shipped(f"{ANY_FLEET}.npz"))
    exported = read_graph(numpy_graph(shipped(f"{ANY_FLEET}.onnx")))
    assert shipped_graph.nodes == exported.nodes
    assert shipped_graph.constants.keys() == exported.constants.keys()
    for name, constant in exported.constants.items():
        np.testing.assert_array_equal(shipped_graph.constants[name], constant)


def test_an_unknown_operation_is_refused() -> None:
    graph = read_graph(shipped(f"{ANY_FLEET}.npz"))
    with pytest.raises(TeamformerError, match="Einsum"):
        NumpyNetwork(replace(graph, nodes=(Node("Einsum", (), (), {}),)))
