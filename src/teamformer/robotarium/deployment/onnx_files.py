"""Reads what an ONNX file holds, without the onnx package: the testbed has no ONNX Runtime.

The numbers are those of fields in onnx.proto (github.com/onnx/onnx); files are protocol buffers.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from teamformer.sim.arrays import Array

DTYPES = {1: "<f4", 6: "<i4", 7: "<i8", 9: "?", 11: "<f8"}
VARINT, FIXED64, BYTES, FIXED32 = 0, 1, 2, 5


@dataclass(frozen=True)
class Node:
    """An operation: what it is called, what it reads and writes, by name, and its settings."""

    operation: str
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    settings: dict[str, Any]


@dataclass(frozen=True)
class Graph:
    """A network: operations in the order to run them, and its constants."""

    nodes: tuple[Node, ...]
    constants: dict[str, Array]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]


def read_onnx(content: bytes) -> Graph:
    """Return the network of an ONNX file."""
    [graph] = (value for field, value in _fields(content) if field == 7)
    nodes, constants = list[Node](), dict[str, Array]()
    inputs, outputs = list[str](), list[str]()
    for field, value in _fields(graph):
        if field == 1:
            nodes.append(_node(value))
        elif field == 5:
            name, tensor = _tensor(value)
            constants[name] = tensor
        elif field in (11, 12):
            name = next(v for f, v in _fields(value) if f == 1).decode()
            (inputs if field == 11 else outputs).append(name)
    given = tuple(name for name in inputs if name not in constants)
    return Graph(tuple(nodes), constants, given, tuple(outputs))


def _fields(content: bytes) -> Iterator[tuple[int, Any]]:
    """Return the fields of a message: numbers as they are, all else as bytes."""
    at = 0
    while at < len(content):
        key, at = _varint(content, at)
        field, kind = key >> 3, key & 7
        if kind == VARINT:
            value, at = _varint(content, at)
            yield field, value
            continue
        length = {FIXED64: 8, FIXED32: 4}.get(kind)
        if length is None:
            length, at = _varint(content, at)
        yield field, content[at : at + length]
        at += length


def _varint(content: bytes, at: int) -> tuple[int, int]:
    """Return a number written in groups of seven bits, lowest first, and where it ends."""
    value = shift = 0
    while True:
        byte = content[at]
        at += 1
        value |= (byte & 127) << shift
        shift += 7
        if byte < 128:
            return value, at


def _varints(content: bytes) -> list[int]:
    values, at = [], 0
    while at < len(content):
        value, at = _varint(content, at)
        values.append(_signed(value))
    return values


def _signed(value: int) -> int:
    return value - 2**64 if value >= 2**63 else value


def _node(content: bytes) -> Node:
    fields = list(_fields(content))
    return Node(
        operation=next(v for f, v in fields if f == 4).decode(),
        inputs=tuple(v.decode() for f, v in fields if f == 1),
        outputs=tuple(v.decode() for f, v in fields if f == 2),
        settings=dict(_setting(v) for f, v in fields if f == 5),
    )


def _setting(content: bytes) -> tuple[str, Any]:
    """Return a setting's name and value: a float, a number, a text, a tensor or numbers."""
    name, value, numbers = "", None, []
    for field, found in _fields(content):
        if field == 1:
            name = found.decode()
        elif field == 2:
            value = struct.unpack("<f", found)[0]
        elif field == 3:
            value = _signed(found)
        elif field == 4:
            value = found.decode()
        elif field == 5:
            value = _tensor(found)[1]
        elif field == 8:
            numbers += _varints(found) if isinstance(found, bytes) else [_signed(found)]
    return name, numbers or value


def _tensor(content: bytes) -> tuple[str, Array]:
    """Return a constant's name and values."""
    shape: list[int] = []
    name, dtype, values = "", "<f4", np.zeros(0)
    for field, found in _fields(content):
        if field == 1:
            shape += _varints(found) if isinstance(found, bytes) else [found]
        elif field == 2:
            dtype = DTYPES[found]
        elif field == 4:
            values = np.frombuffer(found, "<f4")
        elif field == 7:
            values = np.array(_varints(found) if isinstance(found, bytes) else [_signed(found)])
        elif field == 8:
            name = found.decode()
        elif field == 9:
            values = np.frombuffer(found, np.uint8)
    raw = values.dtype == np.uint8
    return name, (values.view(dtype) if raw else values.astype(dtype)).reshape(shape)
