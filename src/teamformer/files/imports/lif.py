"""Layouts in VDMA's Layout Interchange Format (LIF), which goes with VDA5050.

Layouts have nodes, edges in one direction, and stations. Each type of vehicle has a table of times
of its own, by the edges that it may take and their `maxSpeed`. Vehicles start at nodes where they
charge; the other stations are tasks.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import NamedTuple

from teamformer.files.imports.curves import length_of
from teamformer.files.imports.site import CARRY, Lane, Site, mover_of, roads_of, seconds_of
from teamformer.files.imports.trees import TreePart, read_json
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Place

VERSIONS = ("0", "1")
"""First numbers of the versions that are read; 0.11 is what the published examples say."""

CHARGING = "startCharging"

Numbers = Mapping[str, int]
"""The number of each node, by its id."""


def read(path: Path) -> list[Mission | Site]:
    """Return the site of a LIF file; a mission if its vehicles charge and it has stations."""
    tree = read_json(path)
    version = tree["metaInformation"]["lifVersion"]
    if version.text().split(".")[0] not in VERSIONS:
        version.refuse(f"is {version.value}; versions 0 and 1 are read", "export it as LIF 1.0")
    layouts = [part for _, part in tree["layouts"].parts()]
    nodes = [node for part in layouts for _, node in part["nodes"].parts()]
    numbers = _numbers(nodes)
    lanes: dict[str, list[Lane]] = {}
    for part in layouts:
        for _, edge in part["edges"].parts() if part["edges"].value else ():
            for vehicle, lane in _lanes(edge, nodes, numbers):
                lanes.setdefault(vehicle, []).append(lane)
    if not lanes:
        tree["layouts"].refuse("has no edge that a vehicle may take", "add edges between its nodes")
    world = roads_of(list(numbers), lanes)
    robots = tuple(_robots(nodes, lanes))
    tasks = tuple(_tasks(layouts, nodes, numbers))
    name = tree["metaInformation"]["projectIdentification"].text()
    return [Site(name, world, robots, tasks).complete()]


class LaidOutGraph(NamedTuple):
    """What the vehicles of a site call its nodes and edges, and where nodes are, in metres."""

    positions: Mapping[str, Place]
    edges: Mapping[tuple[str, str], Mapping[str, str]]  # by both ends, then by how vehicles move


def read_layout(path: Path) -> LaidOutGraph:
    """Return the nodes and edges of a LIF file, by the names that a mission made of it has."""
    tree = read_json(path)
    layouts = [part for _, part in tree["layouts"].parts()]
    nodes = [node for part in layouts for _, node in part["nodes"].parts()]
    numbers = _numbers(nodes)
    edges: dict[tuple[str, str], dict[str, str]] = {}
    found = [e for part in layouts if part["edges"].value for _, e in part["edges"].parts()]
    rows = [(edge, vehicle) for edge in found for vehicle, _ in _lanes(edge, nodes, numbers)]
    types = {vehicle for _, vehicle in rows}
    for edge, vehicle in rows:
        ends = edge["startNodeId"].text(), edge["endNodeId"].text()
        edges.setdefault(ends, {})[mover_of(vehicle, types)] = edge["edgeId"].text()
    return LaidOutGraph(
        {name: _position(node) for name, node in zip(numbers, nodes, strict=True)}, edges
    )


def _numbers(nodes: list[TreePart]) -> Numbers:
    numbers: dict[str, int] = {}
    for node in nodes:
        if node["nodeId"].text() in numbers:
            node["nodeId"].refuse(f"is '{node['nodeId'].value}', as another node is; rename one")
        numbers[node["nodeId"].text()] = len(numbers)
    return numbers


def _number(part: TreePart, numbers: Numbers) -> int:
    """Return the number of the node that is named."""
    if part.text() not in numbers:
        part.refuse(f"is '{part.value}', which is no node; name one")
    return numbers[part.text()]


def _position(node: TreePart) -> Place:
    at = node["nodePosition"]
    return at["x"].number(), at["y"].number()


def _lanes(edge: TreePart, nodes: list[TreePart], numbers: Numbers) -> Iterator[tuple[str, Lane]]:
    """Yield the types of vehicles that may take an edge, each with how long it takes."""
    begin, end = (_number(edge[key], numbers) for key in ("startNodeId", "endNodeId"))
    allowed = set(_vehicles(nodes[begin])) & set(_vehicles(nodes[end]))
    for _, said in edge["vehicleTypeEdgeProperties"].parts():
        vehicle = said["vehicleTypeId"].text()
        if vehicle not in allowed:
            continue
        ends = _position(nodes[begin]), _position(nodes[end])
        metres = length_of(said["trajectory"] if "trajectory" in said.value else None, *ends)
        limit = 0.0
        if "maxSpeed" in said.value:
            limit = said["maxSpeed"].number()
            if limit <= 0:
                said["maxSpeed"].refuse(f"is {limit:g}; here should be more than 0")
        yield vehicle, Lane(begin, end, seconds_of(metres, limit))


def _vehicles(node: TreePart) -> list[str]:
    """Return the types of vehicles that may be at a node."""
    parts = node["vehicleTypeNodeProperties"].parts()
    return [said["vehicleTypeId"].text() for _, said in parts]


def _robots(nodes: list[TreePart], lanes: Mapping[str, list[Lane]]) -> Iterator[Robot]:
    """Yield a robot of each type for each node where that type charges."""
    count = dict.fromkeys(lanes, 0)
    for number, node in enumerate(nodes):
        for _, said in node["vehicleTypeNodeProperties"].parts():
            vehicle = said["vehicleTypeId"].text()
            if vehicle in lanes and CHARGING in _actions(said):
                count[vehicle] += 1
                name, moves = f"{vehicle}-{count[vehicle]}", mover_of(vehicle, lanes)
                yield Robot(name, (number, 0), {CARRY: 1}, moves=moves)


def _actions(said: TreePart) -> list[str]:
    actions = said["actions"].parts() if said.value.get("actions") else []
    return [action["actionType"].text() for _, action in actions]


def _tasks(layouts: list[TreePart], nodes: list[TreePart], numbers: Numbers) -> Iterator[Task]:
    """Yield a task for each station that is not for charging, at its first node."""
    taken: set[str] = set()
    for part in layouts:
        for _, station in part["stations"].parts() if part.value.get("stations") else ():
            at = [_number(one, numbers) for _, one in station["interactionNodeIds"].parts()]
            said_of = nodes[at[0]]["vehicleTypeNodeProperties"].parts()
            name = station["stationId"].text()
            if name in taken:
                station["stationId"].refuse(f"is '{name}', as another station is; rename one")
            taken.add(name)
            if not any(CHARGING in _actions(said) for _, said in said_of):
                note = station["stationName"].text() if station.value.get("stationName") else ""
                yield Task(name, (at[0], 0), {CARRY: 1}, note=note)
