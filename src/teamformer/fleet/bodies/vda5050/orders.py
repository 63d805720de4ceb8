"""Orders and actions as the standard writes them.

A node says where the vehicle is to be, never how it is to be turned: no task asks for a heading,
and vehicles reject an order whose first node has another one than theirs.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

from teamformer.fleet.bodies.vda5050.graph import RoadGraph
from teamformer.mission.parts.grid import Place

Action = Mapping[str, Any]


class OrderStop(NamedTuple):
    """A place of an order, and what is to be done there."""

    place: Place
    actions: Sequence[Action] = ()


class Way(NamedTuple):
    """What the stops of an order have in common.

    On roads `graph` names nodes and edges; a node has a position only if its layout says it.
    """

    map: str
    begins: str  # the node that the vehicle passed last
    deviation: Mapping[str, Any]  # how far from its first node the vehicle may be
    limits: Mapping[str, float] = {}  # of its edges
    graph: RoadGraph | None = None


def order_of(name: str, stops: Sequence[OrderStop], way: Way) -> dict[str, Any]:
    """Return an order from where the vehicle is, its first stop, to each other one.

    On roads it leads through every place on the way.
    """
    stops = _through(stops, way.graph)
    nodes = [_node(f"{name}-{number}", 2 * number, *stop, way) for number, stop in enumerate(stops)]
    nodes[0]["nodeId"] = way.begins
    if "nodePosition" in nodes[0]:
        nodes[0]["nodePosition"] |= way.deviation
    ids = [node["nodeId"] for node in nodes]
    edges = [
        {
            "edgeId": f"{name}-way-{number}" if way.graph is None else way.graph.edge(*ends),
            "sequenceId": 2 * number - 1,
            "released": True,
            "startNodeId": ends[0],
            "endNodeId": ends[1],
            "actions": [],
            **way.limits,
        }
        for number, ends in enumerate(pairwise(ids), start=1)
    ]
    return {"orderId": name, "orderUpdateId": 0, "nodes": nodes, "edges": edges}


def _through(stops: Sequence[OrderStop], graph: RoadGraph | None) -> Sequence[OrderStop]:
    """Return stops with the places of roads that lie between them; one for what is at one place."""
    if graph is None:
        return stops
    whole = [stops[0]]
    for before, stop in pairwise(stops):
        if graph.node(before.place) == graph.node(stop.place):
            whole[-1] = OrderStop(stop.place, [*whole[-1].actions, *stop.actions])
            continue
        between = graph.between(before.place, stop.place)
        whole += [*(OrderStop(place) for place in between), stop]
    return whole


def _node(
    name: str, sequence: int, place: Place, actions: Sequence[Action], way: Way
) -> dict[str, Any]:
    graph = way.graph
    at = place if graph is None else graph.position(place)
    position = {} if at is None else {"nodePosition": {"x": at[0], "y": at[1], "mapId": way.map}}
    return {
        "nodeId": name if graph is None else graph.node(place),
        "sequenceId": sequence,
        "released": True,
        **position,
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
