"""Agents drive AGVs that others wrote, over a broker that others wrote.

The mission needs mosquitto, node and `npm install -g vda-5050-lib` (or NODE_PATH with it). That
library speaks version 2.0; of the later ones, what a body says is held against the schemas that the
VDA publishes (`vda5050_schemas/`, of the tags of github.com/VDA5050/VDA5050, but for commas that
made that of orders in 3.0.0 no JSON), and a small vehicle of ours answers over the broker.
"""

from __future__ import annotations

import json
import os
import shutil
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import pytest
from paho.mqtt import client as mqtt
from paho.mqtt.enums import CallbackAPIVersion

from teamformer.errors import TeamformerError
from teamformer.fleet.agent.planning import first_plan
from teamformer.fleet.bodies.body import Command, Report
from teamformer.fleet.bodies.vda5050 import Vda5050Body
from teamformer.fleet.fleet_mission import Mission
from teamformer.fleet.planner import CoordinatedPlanner
from teamformer.fleet.process.facts_file import FactsFile
from teamformer.fleet.process.fleet import free_ports
from teamformer.model import Robot, Scenario, Task
from teamformer.plane import Plane
from teamformer.scenarios.files import write_scenario

AGV = Path(__file__).parent / "virtual_agv.js"
SCHEMAS = Path(__file__).parent / "vda5050_schemas"


def two_vehicles() -> Mission:
    """Return a lifter and a scanner 10 m apart, with a task for each and one for both."""
    robots = (Robot("v1", (1.0, 1.0), {"lift": 1}, 2.0), Robot("v2", (11.0, 1.0), {"scan": 1}, 2.0))
    tasks = (
        Task("both", (6.0, 4.0), {"lift": 1, "scan": 1}, 2),
        Task("one", (2.0, 3.0), {"lift": 1}, 1),
        Task("other", (9.0, 3.0), {"scan": 1}, 1),
    )
    return Mission(Scenario("yard", Plane(20.0, 20.0), ("lift", "scan"), robots, tasks))


def node_path() -> str | None:
    """Return where vda-5050-lib is, if it is anywhere."""
    if shutil.which("node") is None or shutil.which("npm") is None:
        return None
    root = subprocess.run(["npm", "root", "-g"], capture_output=True, text=True).stdout.strip()
    for folder in (*os.environ.get("NODE_PATH", "").split(os.pathsep), root):
        if folder and (Path(folder) / "vda-5050-lib").is_dir():
            return folder
    return None


@contextmanager
def running(*command: str, **env: str) -> Iterator[subprocess.Popen[bytes]]:
    quiet = subprocess.DEVNULL
    process = subprocess.Popen(command, stdout=quiet, stderr=quiet, env={**os.environ, **env})
    try:
        yield process
    finally:
        process.terminate()
        process.wait(20)


@contextmanager
def hearing(port: int) -> Iterator[list[tuple[str, dict[str, Any]]]]:
    """Collect all that is said over a broker, by topic."""
    heard: list[tuple[str, dict[str, Any]]] = []
    client = mqtt.Client(CallbackAPIVersion.VERSION2)
    client.on_message = lambda _client, _data, message: heard.append(
        (message.topic, json.loads(message.payload))
    )
    client.connect("127.0.0.1", port)
    client.subscribe("#")
    client.loop_start()
    try:
        yield heard
    finally:
        client.disconnect()
        client.loop_stop()
        if folder := os.environ.get("VDA5050_HEARD"):  # to look at
            Path(folder).write_text(json.dumps(heard, indent=1))


@pytest.mark.parametrize(
    "url", ["", "mqtt://host", "http://h/a/b/c", "mqtt://h/a/b", "mqtt:///a/b/c"]
)
def test_what_is_no_address_is_refused(url: str) -> None:
    with pytest.raises(TeamformerError, match="is no address of a vehicle"):
        Vda5050Body(url, two_vehicles(), 0)


def test_a_broker_that_is_away_is_told() -> None:
    [port] = free_ports(1)
    with pytest.raises(TeamformerError, match=f"no broker at 127.0.0.1:{port}"):
        Vda5050Body(f"mqtt://127.0.0.1:{port}/uagv/acme/v1", two_vehicles(), 0)


@pytest.mark.parametrize(
    ("query", "told"),
    [
        ("map=yard&version=2.2", "version of --body vda5050 is '2.2'"),
        ("map=yard&verison=2.1.0", "--body vda5050 has no key 'verison'"),
    ],
)
def test_what_is_no_setting_is_refused(query: str, told: str) -> None:
    with pytest.raises(TeamformerError, match=told):
        Vda5050Body(f"mqtt://127.0.0.1:1/uagv/acme/v1?{query}", two_vehicles(), 0)


class Vehicle:
    """Says what it was told as done at once, in the words of a version.

    One that `stays` does what it is told where it stands, and does not drive on.
    """

    def __init__(self, port: int, version: str, stays: bool = False) -> None:
        self.version, self.told = version, dict[str, dict[str, Any]]()
        self.orders = list[dict[str, Any]]()
        self._topic = f"uagv/v{version[0]}/acme/v1"
        self._order, self._at, self._done = "", (1.0, 1.0), list[str]()
        self._stays, self._is_driving, self._acted = stays, False, list[str]()
        self.client = mqtt.Client(CallbackAPIVersion.VERSION2)
        self.client.on_message = lambda _client, _data, message: self._hear(message)
        self.client.connect("127.0.0.1", port)
        self.client.subscribe([(f"{self._topic}/order", 0), (f"{self._topic}/instantActions", 0)])
        self.client.loop_start()

    def _hear(self, message: mqtt.MQTTMessage) -> None:
        what, content = message.topic.rpartition("/")[2], json.loads(message.payload)
        self.told[what] = content
        if what == "order":
            self.orders.append(content)
            nodes = content["nodes"][:1] if self._stays else content["nodes"]
            self._acted += [action["actionId"] for node in nodes for action in node["actions"]]
            goal = nodes[-1]["nodePosition"]
            self._order, self._at = content["orderId"], (goal["x"], goal["y"])
            self._is_driving = len(nodes) < len(content["nodes"])
        else:
            self._is_driving &= content["actions"][0]["actionType"] != "cancelOrder"
            self._done += [action["actionId"] for action in content["actions"]]

    def state(self) -> dict[str, Any]:
        """Return its state, as the schema of its version has it."""
        where = {"x": self._at[0], "y": self._at[1], "theta": 0.0, "mapId": "yard"}
        done = [{"actionId": name, "actionStatus": "FINISHED"} for name in self._done]
        acted = [{"actionId": name, "actionStatus": "FINISHED"} for name in self._acted]
        edge = {"edgeId": "way", "sequenceId": 1, "released": True}
        common = {
            **{"headerId": 1, "timestamp": "2026-11-25T04:00:00.000Z", "version": self.version},
            **{"manufacturer": "acme", "serialNumber": "v1", "orderId": self._order},
            **{"orderUpdateId": 0, "lastNodeId": "", "lastNodeSequenceId": 0, "nodeStates": []},
            **{"edgeStates": [edge] * self._is_driving, "driving": False},
            **{"operatingMode": "AUTOMATIC", "errors": []},
        }
        if self.version[0] == "2":
            return common | {
                "agvPosition": where | {"positionInitialized": True},
                "actionStates": done + acted,
                "batteryState": {"batteryCharge": 80.0, "charging": False},
                "safetyState": {"eStop": "NONE", "fieldViolation": False},
            }
        return common | {
            "mobileRobotPosition": where | {"localized": True},
            "actionStates": acted,
            "instantActionStates": done,
            "powerSupply": {"stateOfCharge": 80.0, "charging": False},
            "safetyState": {"activeEmergencyStop": "NONE", "fieldViolation": False},
        }

    def say(self) -> None:
        """Publish its state."""
        self.client.publish(f"{self._topic}/state", json.dumps(self.state()))


def wrong_with(version: str, name: str, content: dict[str, Any]) -> list[str]:
    """Return what the published schema says is wrong with a message."""
    validators = pytest.importorskip("jsonschema.validators")
    schema = json.loads((SCHEMAS / version / f"{name}.schema").read_text(encoding="utf-8"))
    found = validators.validator_for(schema)(schema).iter_errors(content)
    return [f"{list(error.absolute_path)}: {error.message}" for error in found]


@pytest.mark.skipif(shutil.which("mosquitto") is None, reason="needs mosquitto")
@pytest.mark.parametrize("version", ["2.1.0", "3.0.0"])
def test_a_vehicle_of_a_later_version_drives_and_serves(version: str) -> None:
    """In the words of that version, by its published schemas, over a real broker."""
    [port] = free_ports(1)
    with running("mosquitto", "-p", str(port)):
        wait_for_port(port)
        vehicle = Vehicle(port, version)
        url = f"mqtt://127.0.0.1:{port}/uagv/acme/v1?map=yard&version={version}"
        body = Vda5050Body(url, two_vehicles(), 0)
        try:
            body.command(Command(7, (2.0, 3.0), 1, 0, True))
            report, deadline = None, time.monotonic() + 20
            while time.monotonic() < deadline and not (report and report.is_done):
                vehicle.say()
                time.sleep(0.05)
                report = body.report()
        finally:
            body.close()
            vehicle.client.disconnect()
            vehicle.client.loop_stop()
    assert report is not None
    assert (report.x, report.y, report.leg, report.is_done) == (2.0, 3.0, 7, True)
    assert wrong_with(version, "state", vehicle.state()) == []
    assert set(vehicle.told) == {"order", "instantActions"}
    for name, content in vehicle.told.items():
        assert wrong_with(version, name, content) == []
        assert content["version"] == version
    [served] = vehicle.told["instantActions"]["actions"]
    assert served["actionType"] == "serve"
    assert {"key": "task", "value": "one"} in served["actionParameters"]


def wait_for(body: Vda5050Body, vehicle: Vehicle, is_so: Callable[[Report], bool]) -> Report:
    """Let a vehicle say its state until what its body reports is so."""
    for _ in range(400):
        vehicle.say()
        time.sleep(0.05)
        report = body.report()
        if report is not None and is_so(report):
            return report
    raise AssertionError("never reported")


def a_load() -> Mission:
    """Return a vehicle with a load to bring from where it stands to [9, 3]."""
    load = Task("crate", (1.0, 1.0), {"lift": 1}, 2, to=(9.0, 3.0), unload=3)
    robot = Robot("v1", (1.0, 1.0), {"lift": 1}, 2.0)
    return Mission(Scenario("yard", Plane(20.0, 20.0), ("lift",), (robot,), (load,)))


@contextmanager
def driving(version: str, stays: bool = False) -> Iterator[tuple[Vda5050Body, Vehicle]]:
    """Yield the body of a vehicle with a load, and the vehicle, over a broker."""
    [port] = free_ports(1)
    with running("mosquitto", "-p", str(port)):
        wait_for_port(port)
        vehicle = Vehicle(port, version, stays)
        url = f"mqtt://127.0.0.1:{port}/uagv/acme/v1?map=yard&version={version}"
        body = Vda5050Body(url, a_load(), 0)
        try:
            yield body, vehicle
        finally:
            body.close()
            vehicle.client.disconnect()
            vehicle.client.loop_stop()


@pytest.mark.skipif(shutil.which("mosquitto") is None, reason="needs mosquitto")
@pytest.mark.parametrize("version", ["2.0.0", "2.1.0", "3.0.0"])
def test_a_vehicle_picks_a_load_goes_as_fast_as_its_team_and_drops_it(version: str) -> None:
    with driving(version) as (body, vehicle):
        body.command(Command(1, None, 0, 0, True, 2.0, 0.5))
        report = wait_for(body, vehicle, lambda report: report.is_done)
    assert (report.x, report.y, report.carries) == (9.0, 3.0, False)
    [order] = vehicle.orders
    assert wrong_with(version, "order", order) == []
    [pick], [drop] = (node["actions"] for node in order["nodes"])
    assert (pick["actionType"], drop["actionType"]) == ("pick", "drop")
    lasts = [action["actionParameters"][2] for action in (pick, drop)]
    assert lasts == [{"key": "duration", "value": 2.0}, {"key": "duration", "value": 3.0}]
    [edge] = order["edges"]
    assert edge["maximumSpeed" if version[0] == "3" else "maxSpeed"] == 0.5


@pytest.mark.skipif(shutil.which("mosquitto") is None, reason="needs mosquitto")
@pytest.mark.parametrize("version", ["2.1.0", "3.0.0"])
def test_a_vehicle_that_is_told_to_stop_drops_its_load_there(version: str) -> None:
    with driving(version, stays=True) as (body, vehicle):
        body.command(Command(1, None, 0, 0, True, 2.0, 2.0))
        wait_for(body, vehicle, lambda report: report.carries)
        body.command(Command(1, None, 0, 0, False, 2.0))
        report = wait_for(body, vehicle, lambda report: report.load is not None)
    assert (report.load, report.carries, report.is_done) == ((1.0, 1.0), False, False)
    assert vehicle.told["instantActions"]["actions"][0]["actionType"] == "cancelOrder"
    order = vehicle.orders[-1]
    assert wrong_with(version, "order", order) == []
    assert [a["actionType"] for node in order["nodes"] for a in node["actions"]] == ["drop"]


def wait_for_port(port: int) -> None:
    for _ in range(100):
        with socket.socket() as probe:
            if probe.connect_ex(("127.0.0.1", port)) == 0:
                return
        time.sleep(0.05)
    raise AssertionError("mosquitto does not listen")


@pytest.mark.slow
def test_two_vehicles_do_a_mission(tmp_path: Path) -> None:
    modules = node_path()
    if shutil.which("mosquitto") is None or modules is None:
        pytest.skip("needs mosquitto, node and vda-5050-lib")
    mission = two_vehicles()
    write_scenario(mission.scenario, tmp_path / "yard.yaml")
    first_plan(mission, CoordinatedPlanner())  # so that no agent has to compile what plans
    broker, *ports = free_ports(3)
    with ExitStack() as stack:
        stack.enter_context(running("mosquitto", "-p", str(broker)))
        time.sleep(2)
        heard = stack.enter_context(hearing(broker))
        for robot in mission.scenario.robots:
            words = ("uagv", "acme", robot.name, *map(str, robot.at))
            agv = ("node", str(AGV), f"mqtt://127.0.0.1:{broker}", *words)
            stack.enter_context(running(*agv, NODE_PATH=modules))
        for number, robot in enumerate(mission.scenario.robots):
            command = [sys.executable, "-m", "teamformer.cli", "fleet", "agent"]
            command += [str(tmp_path / "yard.yaml"), robot.name]
            command += ["--listen", f"tcp/127.0.0.1:{ports[number]}"]
            body = f"mqtt://127.0.0.1:{broker}/uagv/acme/{robot.name}?map=map"
            command += ["--body", f"vda5050:{body}", "--facts", str(tmp_path / robot.name)]
            if number:
                command += ["--connect", f"tcp/127.0.0.1:{ports[0]}"]
            stack.enter_context(running(*command))
        files = [FactsFile(tmp_path / f"v{n + 1}", mission.number, n) for n in range(2)]
        deadline = time.monotonic() + 240
        done: list[set[int]] = []
        while time.monotonic() < deadline and done != [{0, 1, 2}, {0, 1, 2}]:
            time.sleep(1)
            kept = [file.read() for file in files]
            done = [set(each.done) if each else set() for each in kept]
        assert done == [{0, 1, 2}, {0, 1, 2}]
    served = {
        (topic.split("/")[3], parameter["value"])
        for topic, content in heard
        if topic.endswith("/instantActions")
        for action in content["actions"]
        for parameter in action["actionParameters"]
        if action["actionType"] == "serve" and parameter["key"] == "task"
    }
    assert served == {("v1", "both"), ("v2", "both"), ("v1", "one"), ("v2", "other")}
    goals = {
        (topic.split("/")[3], node["nodePosition"]["x"], node["nodePosition"]["y"])
        for topic, content in heard
        if topic.endswith("/order")
        for node in content["nodes"][-1:]
    }
    assert goals == {("v1", 6.0, 4.0), ("v2", 6.0, 4.0), ("v1", 2.0, 3.0), ("v2", 9.0, 3.0)}
