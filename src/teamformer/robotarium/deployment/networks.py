"""Networks as the testbed gets them: a module of operations, and all constants in one array."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from teamformer.base.array_types import Array
from teamformer.robotarium.deployment.graphs import NetworkGraph


def networks_text(graphs: Mapping[str, NetworkGraph]) -> str:
    """Return a module that has networks by the names of their files.

    Told of each are its operations, its constants as (first byte, shape, type) in `weights_of` the
    same networks, its inputs and outputs, their widths, and what else its file says.
    """
    at, told = 0, {}
    for name, graph in graphs.items():
        places = {}
        for constant, array in graph.constants.items():
            places[constant] = (at, array.shape, array.dtype.str)
            at += array.nbytes
        nodes = [(n.operation, n.inputs, n.outputs, n.settings) for n in graph.nodes]
        told[name] = (nodes, places, graph.inputs, graph.outputs, graph.widths, graph.about)
    return f'"""Networks by file, with constants in weights.npy."""\n\nNETWORKS = {told!r}\n'


def weights_of(graphs: Mapping[str, NetworkGraph]) -> Array:
    """Return the bytes of all constants of networks, end to end, as (bytes,) uint8."""
    constants = [array for graph in graphs.values() for array in graph.constants.values()]
    return np.frombuffer(b"".join(array.tobytes() for array in constants), np.uint8)
