"""Reads networks out of ONNX files; the testbed gets them as constants and operations."""

from __future__ import annotations

from teamformer.base.errors import TeamformerError
from teamformer.base.extras import require
from teamformer.robotarium.deployment.graphs import NetworkGraph, Node


def read_graph(content: bytes) -> NetworkGraph:
    """Return the network in an ONNX file.

    Raises `TeamformerError` for a file that is none, and if onnx is not installed.
    """
    require("robotarium", "onnx")
    import onnx
    from google.protobuf.message import DecodeError

    try:
        model = onnx.load_from_string(content)
        onnx.checker.check_model(model)
    except (DecodeError, onnx.checker.ValidationError) as error:
        raise TeamformerError(f"this is no ONNX file that can be read here: {error}") from None
    graph, to_array = model.graph, onnx.numpy_helper.to_array
    constants = {tensor.name: to_array(tensor) for tensor in graph.initializer}
    nodes = []
    for node in graph.node:
        settings = {it.name: onnx.helper.get_attribute_value(it) for it in node.attribute}
        if node.op_type == "Constant":
            constants[node.output[0]] = to_array(settings["value"])
        else:
            plain = {k: v.decode() if isinstance(v, bytes) else v for k, v in settings.items()}
            nodes.append(Node(node.op_type, tuple(node.input), tuple(node.output), plain))
    inputs = tuple(value.name for value in graph.input if value.name not in constants)
    outputs = tuple(value.name for value in graph.output)
    shapes = {value.name: value.type.tensor_type.shape.dim for value in graph.input}
    widths = {name: dim[-1].dim_value for name, dim in shapes.items() if dim and dim[-1].dim_value}
    about = {entry.key: entry.value for entry in model.metadata_props}
    return NetworkGraph(tuple(nodes), constants, inputs, outputs, widths, about)
