"""Reads networks out of ONNX files, without the onnx package, which few have installed.

An ONNX file is a protocol buffer (onnx.proto3): numbered fields, each a whole number or so many
bytes. Field numbers below are those of that file.
"""

from __future__ import annotations

import struct
from collections import defaultdict
from typing import Any

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.errors import TeamformerError
from teamformer.robotarium.deployment.graphs import NetworkGraph, Node
from teamformer.robotarium.deployment.numpy_network import DTYPES

Fields = defaultdict[int, list[Any]]

VARINT, EIGHT_BYTES, BYTES, FOUR_BYTES = 0, 1, 2, 5
"""How a field is written."""

FLOAT, INT, STRING, TENSOR, FLOATS, INTS = 1, 2, 3, 4, 6, 7
"""Types of attributes."""


def read_graph(content: bytes) -> NetworkGraph:
    """Return the network in an ONNX file.

    Raises `TeamformerError` for a file that is cut off, and for what the testbed cannot run.
    """
    try:
        return _graph(_fields(_fields(content)[7][0]))
    except (IndexError, struct.error, UnicodeDecodeError, ValueError, KeyError) as error:
        raise TeamformerError(f"this is no ONNX file that can be read here: {error!r}") from None


def _graph(graph: Fields) -> NetworkGraph:
    constants = dict(map(_tensor, graph[5]))
    nodes = []
    for part in graph[1]:
        node = _fields(part)
        inputs, outputs = (tuple(name.decode() for name in node[field]) for field in (1, 2))
        settings = dict(map(_attribute, node[5]))
        operation = node[4][0].decode()
        if operation == "Constant":
            constants[outputs[0]] = settings["value"]
        else:
            nodes.append(Node(operation, inputs, outputs, settings))
    names = [tuple(_fields(value)[1][0].decode() for value in graph[f]) for f in (11, 12)]
    inputs = tuple(name for name in names[0] if name not in constants)
    return NetworkGraph(tuple(nodes), constants, inputs, names[1])


def _attribute(part: bytes) -> tuple[str, Any]:
    said = _fields(part)
    kind = said[20][0]
    value: Any
    if kind == FLOAT:
        [value] = struct.unpack("<f", said[2][0])
    elif kind == INT:
        value = _signed(said[3][0])
    elif kind == STRING:
        value = said[4][0].decode()
    elif kind == TENSOR:
        value = _tensor(said[5][0])[1]
    elif kind == FLOATS:
        value = np.frombuffer(b"".join(said[7]), "<f4").tolist()
    elif kind == INTS:
        value = _wholes(said[8])
    else:
        raise ValueError(f"an attribute of type {kind}")
    return said[1][0].decode(), value


def _tensor(part: bytes) -> tuple[str, Array]:
    """Return a tensor with its name; its values stand as raw bytes, or by type."""
    said = _fields(part)
    kind: Any = DTYPES[said[2][0]]
    if said[9]:
        flat = np.frombuffer(said[9][0], np.dtype(kind).newbyteorder("<"))
    elif said[4] or said[10]:
        flat = np.frombuffer(b"".join(said[4] or said[10]), "<f4" if said[4] else "<f8")
    else:
        flat = np.array(_wholes(said[5] or said[7]))
    name = said[8][0].decode() if said[8] else ""
    return name, flat.astype(kind).reshape(_wholes(said[1]))


def _wholes(values: list[Any]) -> list[int]:
    """Return whole numbers that stand one by one, or packed into bytes."""
    found: list[int] = []
    for value in values:
        if isinstance(value, int):
            found.append(_signed(value))
            continue
        at = 0
        while at < len(value):
            number, at = _varint(value, at)
            found.append(_signed(number))
    return found


def _fields(content: bytes) -> Fields:
    """Return what stands in a message, by field."""
    found: Fields = defaultdict(list)
    at = 0
    while at < len(content):
        tag, at = _varint(content, at)
        field, how = tag >> 3, tag & 7
        value: Any
        if how == VARINT:
            value, at = _varint(content, at)
        else:
            size = {EIGHT_BYTES: 8, FOUR_BYTES: 4}.get(how)
            if how == BYTES:
                size, at = _varint(content, at)
            if size is None or at + size > len(content):
                raise ValueError("it is cut off")
            value, at = content[at : at + size], at + size
        found[field].append(value)
    return found


def _varint(content: bytes, at: int) -> tuple[int, int]:
    """Return the whole number at a place, seven bits a byte, and the place after it."""
    number = shift = 0
    while True:
        byte = content[at]
        number |= (byte & 0x7F) << shift
        at, shift = at + 1, shift + 7
        if byte < 0x80:
            return number, at


def _signed(number: int) -> int:
    return number - (1 << 64) if number >> 63 else number
