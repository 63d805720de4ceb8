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

from teamformer.files.mission_files import write_mission
from teamformer.fleet.agent.planning import first_plan
from teamformer.fleet.bodies.body import Command, Report
from teamformer.fleet.bodies.vda5050.body import Vda5050Body
from teamformer.fleet.planner import CoordinatedPlanner
from teamformer.fleet.process.facts_file import FactsFile
from teamformer.fleet.process.fleet import free_ports
from vda5050_vehicle import driving, running, two_vehicles, wait_for, wait_for_port

AGV = Path(__file__).parent / "virtual_agv.js"
SCHEMAS = Path(__file__).parent / "vda5050_schemas"


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
    with driving(version, mission=two_vehicles()) as (body, vehicle):
        body.command(Command(7, (2.0, 3.0), 1, 0, True))
        report = wait_for(body, vehicle, lambda report: report.has_served)
    assert (report.x, report.y, report.leg, report.has_served) == (2.0, 3.0, 7, True)
    assert wrong_with(version, "state", vehicle.state()) == []
    assert set(vehicle.told) == {"order", "instantActions"}
    for name, content in vehicle.told.items():
        assert wrong_with(version, name, content) == []
        assert content["version"] == version
    [served] = vehicle.told["instantActions"]["actions"]
    assert served["actionType"] == "serve"
    assert {"key": "task", "value": "one"} in served["actionParameters"]


@pytest.mark.skipif(shutil.which("mosquitto") is None, reason="needs mosquitto")
@pytest.mark.parametrize("version", ["2.0.0", "2.1.0", "3.0.0"])
def test_a_vehicle_picks_a_load_goes_as_fast_as_its_team_and_drops_it(version: str) -> None:
    with driving(version) as (body, vehicle):
        body.command(Command(1, None, 0, 0, True, 2.0, 0.5))
        report = wait_for(body, vehicle, lambda report: report.has_served)
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
    assert (report.load, report.carries, report.has_served) == ((1.0, 1.0), False, False)
    assert vehicle.told["instantActions"]["actions"][0]["actionType"] == "cancelOrder"
    order = vehicle.orders[-1]
    assert wrong_with(version, "order", order) == []
    assert [a["actionType"] for node in order["nodes"] for a in node["actions"]] == ["drop"]


@pytest.mark.skipif(shutil.which("mosquitto") is None, reason="needs mosquitto")
@pytest.mark.parametrize("version", ["2.0.0", "2.1.0", "3.0.0"])
@pytest.mark.parametrize("heading", [0.0, 1.57, 3.1, -2.4])
def test_a_vehicle_goes_however_it_is_turned(version: str, heading: float) -> None:
    with driving(version, heading=heading, mission=two_vehicles()) as (body, vehicle):
        body.command(Command(1, (2.0, 3.0), 1))
        report = wait_for(body, vehicle, lambda report: report.leg == 1)
    assert (report.x, report.y, vehicle.errors) == (2.0, 3.0, [])
    [order] = vehicle.orders
    assert wrong_with(version, "order", order) == []
    assert all("theta" not in node["nodePosition"] for node in order["nodes"])


@pytest.mark.skipif(shutil.which("mosquitto") is None, reason="needs mosquitto")
@pytest.mark.parametrize("version", ["2.0.0", "3.0.0"])
def test_a_vehicle_that_is_sent_elsewhere_goes_on_from_where_it_stops(version: str) -> None:
    """It stops half way to each goal but the last, turned to where it went."""
    goals = [(9.0, 1.0), (5.0, 9.0), (1.0, 1.0), (2.0, 3.0)]
    with driving(version, stays=True, part=0.5, mission=two_vehicles()) as (body, vehicle):
        places = []
        for leg, goal in enumerate(goals, start=1):
            vehicle.stays = leg < len(goals)
            body.command(Command(leg, goal, 1))
            report = wait_for(body, vehicle, lambda report, leg=leg: report.leg == leg)
            places.append((report.x, report.y))
    assert places == [(5.0, 1.0), (5.0, 5.0), (3.0, 3.0), (2.0, 3.0)]
    assert (len(vehicle.orders), vehicle.errors) == (4, [])
    assert [action["actionType"] for action in vehicle.actions] == ["cancelOrder"] * 3


@pytest.mark.slow
@pytest.mark.parametrize("heading", [0.0, 1.57, 3.1])
def test_a_virtual_agv_goes_however_it_is_turned_and_serves_again_what_failed(
    heading: float, capfd: pytest.CaptureFixture[str]
) -> None:
    """It is sent elsewhere on its way, where it fails to serve twice."""
    modules = node_path()
    if shutil.which("mosquitto") is None or modules is None:
        pytest.skip("needs mosquitto, node and vda-5050-lib")
    [port] = free_ports(1)
    url = f"mqtt://127.0.0.1:{port}"
    with ExitStack() as stack:
        stack.enter_context(running("mosquitto", "-p", str(port)))
        wait_for_port(port)
        words = ("uagv", "acme", "v1", "1", "1", str(heading), "2")
        stack.enter_context(running("node", str(AGV), url, *words, NODE_PATH=modules))
        body = Vda5050Body(f"{url}/uagv/acme/v1?map=map", two_vehicles(), 0)
        stack.callback(body.close)
        body.command(Command(1, (6.0, 1.0), 0))
        watch(body, lambda report: report.leg == 1 and report.x > 2.0)
        body.command(Command(2, (2.0, 3.0), 1))
        report = watch(body, lambda report: report.leg == 2 and report[:2] == (2.0, 3.0))
        assert not report.has_served
        body.command(Command(2, (2.0, 3.0), 1, 0, True))
        assert not watch(body, lambda report: report.has_served).is_unfit
    told = capfd.readouterr().err
    assert "noRouteError" not in told
    assert told.count("v1: the vehicle has failed to serve one; it gets the order again") == 2
    assert "v1: the vehicle says instantActionError: the gripper is jammed" in told


def watch(body: Vda5050Body, is_so: Callable[[Report], bool]) -> Report:
    """Wait until what a body reports is so."""
    for _ in range(600):
        time.sleep(0.05)
        report = body.report()
        if report is not None and is_so(report):
            return report
    raise AssertionError("never reported")


@pytest.mark.slow
def test_two_vehicles_do_a_mission(tmp_path: Path) -> None:
    modules = node_path()
    if shutil.which("mosquitto") is None or modules is None:
        pytest.skip("needs mosquitto, node and vda-5050-lib")
    mission = two_vehicles()
    write_mission(mission.source, tmp_path / "yard.yaml")
    first_plan(mission, CoordinatedPlanner())  # so that no agent has to compile what plans
    broker, *ports = free_ports(3)
    with ExitStack() as stack:
        stack.enter_context(running("mosquitto", "-p", str(broker)))
        time.sleep(2)
        heard = stack.enter_context(hearing(broker))
        for robot in mission.source.robots:
            words = ("uagv", "acme", robot.name, *map(str, robot.at), "1.57", "0")
            agv = ("node", str(AGV), f"mqtt://127.0.0.1:{broker}", *words)
            stack.enter_context(running(*agv, NODE_PATH=modules))
        for number, robot in enumerate(mission.source.robots):
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
