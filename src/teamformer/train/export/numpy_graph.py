"""Writes an ONNX network as arrays and operations that NumPy alone can run.

`python -m teamformer.train.export.numpy_graph NETWORK.onnx NETWORK.npz`. One array of the file
holds the operations, inputs and outputs as JSON, the others are the constants, by name.
"""

from __future__ import annotations

import argparse
import io
import json
from pathlib import Path
from typing import Any

import numpy as np
import onnx
from onnx import numpy_helper

OUTLINE = "outline"


def numpy_graph(content: bytes) -> bytes:
    """Return the file for the content of an ONNX file."""
    graph = onnx.load_from_string(content).graph
    constants = {tensor.name: numpy_helper.to_array(tensor) for tensor in graph.initializer}
    nodes = []
    for node in graph.node:
        settings = {
            part.name: _plain(onnx.helper.get_attribute_value(part)) for part in node.attribute
        }
        if node.op_type == "Constant":
            constants[node.output[0]] = settings["value"]
        else:
            nodes.append((node.op_type, list(node.input), list(node.output), settings))
    outline = {
        "nodes": nodes,
        "inputs": [value.name for value in graph.input if value.name not in constants],
        "outputs": [value.name for value in graph.output],
    }
    arrays: dict[str, Any] = {**constants, OUTLINE: np.array(json.dumps(outline))}
    file = io.BytesIO()
    np.savez_compressed(file, **arrays)
    return file.getvalue()


def _plain(value: Any) -> Any:
    """Return an attribute's value as JSON takes it; a tensor as an array."""
    if isinstance(value, onnx.TensorProto):
        return numpy_helper.to_array(value)
    return value.decode() if isinstance(value, bytes) else value


def main() -> None:
    """Convert one file."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("network", type=Path)
    parser.add_argument("file", type=Path)
    asked = parser.parse_args()
    asked.file.write_bytes(numpy_graph(asked.network.read_bytes()))


if __name__ == "__main__":
    main()
