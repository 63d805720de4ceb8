"""A vehicle that speaks VDA5050 on an imported layout, over a real broker."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from teamformer.files.imports.lif import read
from teamformer.files.imports.site import Site
from teamformer.fleet.bodies.body import Command
from teamformer.fleet.bodies.vda5050.body import Vda5050Body
from teamformer.fleet.bodies.vda5050.dialect import DIALECTS
from teamformer.fleet.bodies.vda5050.graph import RoadGraph
from teamformer.fleet.bodies.vda5050.state import State
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.process.fleet import free_ports
from teamformer.mission.model import Mission, Robot, Task
from vda5050_vehicle import Vehicle, running, wait_for, wait_for_port

needs_mosquitto = pytest.mark.skipif(shutil.which("mosquitto") is None, reason="needs mosquitto")

DOCK, GATE, SHELF = (0, 0), (1, 0), (2, 0)


def layout() -> dict[str, Any]:
    """Return a loop in one direction: from the dock to the gate 4 m, to the shelf 3, back 5."""
    places = {"dock": (0.0, 0.0), "gate": (4.0, 0.0), "shelf": (4.0, 3.0)}
    types = [{"vehicleTypeId": "cart"}]
    nodes = [
        {
            "nodeId": name,
            "nodePosition": {"x": x, "y": y},
            "vehicleTypeNodeProperties": types,
        }
        for name, (x, y) in places.items()
    ]
    edges = [
        {
            "edgeId": number,
            "startNodeId": start,
            "endNodeId": end,
            "vehicleTypeEdgeProperties": types,
        }
        for number, start, end in [
            ("e1", "dock", "gate"),
            ("e2", "gate", "shelf"),
            ("e3", "shelf", "dock"),
        ]
    ]
    about = {"projectIdentification": "yard", "lifVersion": "1.0.0"}
    parts = [{"layoutId": "l", "nodes": nodes, "edges": edges, "stations": []}]
    return {"metaInformation": about, "layouts": parts}


def on_layout(folder: Path) -> tuple[FleetMission, Path]:
    """Return the imported site with a cart at the dock and work at the shelf, and its file."""
    path = folder / "yard.lif.json"
    path.write_text(json.dumps(layout()))
    [site] = read(path)
    assert isinstance(site, Site)
    crate = Task("crate", SHELF, {"carry": 1}, 2.0, to=DOCK, unload=1.0)
    count = Task("count", SHELF, {"carry": 1}, 1.0)
    cart = Robot("v1", DOCK, {"carry": 1})
    mission = Mission("yard", site.world, ("carry",), (cart,), (crate, count), time="continuous")
    return FleetMission(mission), path


class OnNodes(Vehicle):
    """A vehicle that knows nodes only: it drives an order node by node, each time it is told to."""

    def __init__(self, port: int) -> None:
        super().__init__(port, "2.0.0")
        self.last, self.ahead = "dock", list[dict[str, Any]]()

    def _take(self, order: dict[str, Any]) -> None:
        self._order, first, *self.ahead = order["orderId"], *order["nodes"]
        assert first["nodeId"] == self.last
        self._acted += [self._act(action) for action in first["actions"]]

    def _why_not(self, node: dict[str, Any]) -> str:
        return ""

    def drive(self) -> None:
        """Pass the next node, and do there what is to be done."""
        node = self.ahead.pop(0)
        self.last = node["nodeId"]
        self._acted += [self._act(action) for action in node["actions"]]

    def state(self) -> dict[str, Any]:
        """Return its state: where it was last, and what is ahead."""
        ahead = [
            {"nodeId": node["nodeId"], "sequenceId": node["sequenceId"], "released": True}
            for node in self.ahead
        ]
        seen = {"lastNodeId": self.last, "nodeStates": ahead, "driving": bool(ahead)}
        return super().state() | seen | {"edgeStates": []}


@contextmanager
def driving(folder: Path, query: str = "") -> Iterator[tuple[Vda5050Body, OnNodes]]:
    [port] = free_ports(1)
    mission, _ = on_layout(folder)
    with running("mosquitto", "-p", str(port)):
        wait_for_port(port)
        vehicle = OnNodes(port)
        body = Vda5050Body(f"mqtt://127.0.0.1:{port}/uagv/acme/v1?map=l{query}", mission, 0)
        try:
            yield body, vehicle
        finally:
            body.close()
            vehicle.leave()


@needs_mosquitto
def test_an_order_leads_along_the_nodes_and_edges_of_the_layout(tmp_path: Path) -> None:
    """Sent to the shelf, the vehicle is told of the gate too; half-way it is 3 s from the shelf."""
    with driving(tmp_path, f"&layout={tmp_path}/yard.lif.json") as (body, vehicle):
        wait_for(body, vehicle, lambda report: (report.x, report.y) == DOCK)
        body.command(Command(1, SHELF, 1))
        wait_for(body, vehicle, lambda report: report.leg == 1)
        [order] = {one["orderId"]: one for one in vehicle.orders}.values()
        assert [node["nodeId"] for node in order["nodes"]] == ["dock", "gate", "shelf"]
        assert [node["sequenceId"] for node in order["nodes"]] == [0, 2, 4]
        assert [edge["edgeId"] for edge in order["edges"]] == ["e1", "e2"]
        assert order["nodes"][1]["nodePosition"] == {"x": 4.0, "y": 0.0, "mapId": "l"}
        near_gate = wait_for(body, vehicle, lambda report: report.x == 1)
        assert 0 < near_gate.y <= 4.0
        vehicle.drive()
        near_shelf = wait_for(body, vehicle, lambda report: report.x == 2)
        assert 0 < near_shelf.y <= 3.0
        vehicle.drive()
        there = wait_for(body, vehicle, lambda report: (report.x, report.y) == SHELF)
        assert there.leg == 1
        body.command(Command(1, SHELF, 1, 0, serve=True))
        wait_for(body, vehicle, lambda report: report.has_served)
        assert [action["actionType"] for action in vehicle.actions] == ["serve"]


@needs_mosquitto
def test_a_load_is_brought_along_the_nodes(tmp_path: Path) -> None:
    """Without the layout's file nodes have no places, and edges are called by their ends."""
    with driving(tmp_path) as (body, vehicle):
        vehicle.last = "shelf"
        wait_for(body, vehicle, lambda report: (report.x, report.y) == SHELF)
        body.command(Command(1, SHELF, 0))
        body.command(Command(2, SHELF, 0, 0, serve=True, duration=2.0, pace=1.0))
        wait_for(body, vehicle, lambda report: report.carries)
        order = vehicle.orders[-1]
        assert [node["nodeId"] for node in order["nodes"]] == ["shelf", "dock"]
        assert "nodePosition" not in order["nodes"][0]
        assert [edge["edgeId"] for edge in order["edges"]] == ["shelf-dock"]
        kinds = [[action["actionType"] for action in node["actions"]] for node in order["nodes"]]
        assert kinds == [["pick"], ["drop"]]
        vehicle.drive()
        done = wait_for(body, vehicle, lambda report: report.has_served)
        assert (done.x, done.y) == DOCK


def test_a_vehicle_that_stands_still_between_nodes_comes_no_nearer(tmp_path: Path) -> None:
    """It drives 4 s to the gate: after 1 s 3 are left, standing still changes nothing."""
    mission, _ = on_layout(tmp_path)
    graph = RoadGraph(mission, 0)

    def state(**said: Any) -> State:
        ahead = [{"nodeId": "gate", "sequenceId": 2}]
        return State({"lastNodeId": "dock", "nodeStates": ahead, **said}, DIALECTS["2"])

    assert graph.locate(state(driving=True), 10.0) == (1, 4.0)
    assert graph.locate(state(driving=True), 11.0) == (1, 3.0)
    assert graph.locate(state(driving=False), 13.0) == (1, 3.0)
    assert graph.locate(state(driving=True), 99.0) == (1, pytest.approx(0.08))
    assert graph.locate(state(lastNodeId="gate", driving=True), 99.5) == (1, 0)


def test_a_vehicle_that_has_passed_no_node_is_at_the_nearest(tmp_path: Path) -> None:
    from teamformer.files.imports.lif import read_layout

    mission, path = on_layout(tmp_path)
    graph = RoadGraph(mission, 0, read_layout(path))
    where = {"x": 4.2, "y": 2.9, "positionInitialized": True}
    assert graph.locate(State({"agvPosition": where}, DIALECTS["2"]), 0.0) == SHELF
    far = State({"agvPosition": where | {"x": 9.0}}, DIALECTS["2"])
    assert graph.locate(far, 0.0) is None


def test_edges_are_those_of_the_vehicles_own_type(tmp_path: Path) -> None:
    from teamformer.files.imports.lif import read_layout

    tree = layout()
    [part] = tree["layouts"]
    both = [{"vehicleTypeId": "cart"}, {"vehicleTypeId": "lorry"}]
    for node in part["nodes"]:
        node["vehicleTypeNodeProperties"] = both
    lorry = part["edges"][0] | {"edgeId": "e9", "vehicleTypeEdgeProperties": both[1:]}
    part["edges"].append(lorry)
    path = tmp_path / "two.json"
    path.write_text(json.dumps(tree))
    assert read_layout(path).edges["dock", "gate"] == {"cart": "e1", "lorry": "e9"}
