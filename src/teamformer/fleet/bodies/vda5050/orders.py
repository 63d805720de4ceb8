"""Orders and actions as the standard writes them.

A node says where the vehicle is to be, never how it is to be turned: no task asks for a heading,
and vehicles reject an order whose first node has another one than theirs.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from teamformer.mission.parts.grid import Place

Action = Mapping[str, Any]


class OrderStop(NamedTuple):
    """A place of an order, and what is to be done there."""

    place: Place
    actions: Sequence[Action] = ()


class Way(NamedTuple):
    """What the stops of an order have in common."""

    map: str
    begins: str  # the node that the vehicle passed last
    deviation: Mapping[str, Any]  # how far from its first node the vehicle may be
    limits: Mapping[str, float] = {}  # of its edges


def order_of(name: str, stops: Sequence[OrderStop], way: Way) -> dict[str, Any]:
    """Return an order from where the vehicle is, its first stop, to each other one."""
    nodes = [_node(f"{name}-{number}", 2 * number, *stop, way) for number, stop in enumerate(stops)]
    nodes[0]["nodeId"] = way.begins
    nodes[0]["nodePosition"] |= way.deviation
    edges = [
        {
            "edgeId": f"{name}-way-{number}",
            "sequenceId": 2 * number - 1,
            "released": True,
            "startNodeId": nodes[number - 1]["nodeId"],
            "endNodeId": nodes[number]["nodeId"],
            "actions": [],
            **way.limits,
        }
        for number in range(1, len(nodes))
    ]
    return {"orderId": name, "orderUpdateId": 0, "nodes": nodes, "edges": edges}


def _node(
    name: str, sequence: int, place: Place, actions: Sequence[Action], way: Way
) -> dict[str, Any]:
    return {
        "nodeId": name,
        "sequenceId": sequence,
        "released": True,
        "nodePosition": {"x": place[0], "y": place[1], "mapId": way.map},
        "actions": list(actions),
    }


def action_of(kind: str, name: str, parameters: Mapping[str, Any], blocking: str) -> dict[str, Any]:
    """Return an action, instant or of a node."""
    return {
        "actionType": kind,
        "actionId": name,
        "blockingType": blocking,
        "actionParameters": [{"key": k, "value": v} for k, v in parameters.items()],
    }
