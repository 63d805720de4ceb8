"""A small vehicle that speaks VDA5050 over a real broker, and what tests of it have in common."""

from __future__ import annotations

import json
import math
import os
import socket
import subprocess
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from paho.mqtt import client as mqtt
from paho.mqtt.enums import CallbackAPIVersion

from teamformer.fleet.bodies.body import Report
from teamformer.fleet.bodies.vda5050.body import Vda5050Body
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.process.fleet import free_ports
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.plane import Plane

TURNED = 0.35
"""Radians by which a vehicle may be turned other than a node wants, as in vda-5050-lib."""


class Vehicle:
    """Does at once what it is told, and says so in the words of a version.

    One that `stays` does what it is told where it stands, and drives no further than `part` of the
    way. It is turned by `heading`, and to where it drives; it rejects orders for who is turned
    otherwise, as vehicles do. Each kind of action fails as often as `fails` says. It knows nothing
    of actions that are not in `knows`, and `rejects` is why it takes no order at all. Its battery
    has `charge` percent, and is charged while it `is_charging`.
    """

    def __init__(
        self,
        port: int,
        version: str,
        stays: bool = False,
        part: float = 0.0,
        heading: float = 0.0,
        serial: str = "v1",
    ) -> None:
        self.version, self.told = version, dict[str, dict[str, Any]]()
        self.orders, self.actions = list[dict[str, Any]](), list[dict[str, Any]]()
        self.stays, self.part, self.heading = stays, part, heading
        self.fails, self.rejects, self.map = Counter[str](), "", "yard"
        self.knows = {"serve", "cancelOrder", "pick", "drop", "startCharging", "stopCharging"}
        self.charge, self.is_charging = 80.0, False
        self.errors = list[dict[str, Any]]()
        self._serial = serial
        self._topic = f"uagv/v{version[0]}/acme/{serial}"
        self._order, self.at, self._is_driving = "", (1.0, 1.0), False
        self._done, self._acted = list[dict[str, Any]](), list[dict[str, Any]]()
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
            why = self.rejects or self._why_not(content["nodes"][0])
            if why:
                self._reject("orderError", why, orderId=content["orderId"], nodeId="start")
            elif content["orderId"] != self._order:
                self._take(content)
        for action in content["actions"] if what == "instantActions" else ():
            self.actions.append(action)
            if action["actionType"] not in self.knows:
                self._reject("actionError", "not supported", actionId=action["actionId"])
            else:
                self._is_driving &= action["actionType"] != "cancelOrder"
                self._done.append(self._act(action))

    def _take(self, order: dict[str, Any]) -> None:
        self.errors.clear()
        self._acted.clear()
        nodes = order["nodes"][:1] if self.stays else order["nodes"]
        self._acted += [self._act(action) for node in nodes for action in node["actions"]]
        x, y = (order["nodes"][-1]["nodePosition"][axis] for axis in ("x", "y"))
        dx, dy = x - self.at[0], y - self.at[1]
        part = self.part if self.stays else 1.0
        self._order, self.at = order["orderId"], (self.at[0] + part * dx, self.at[1] + part * dy)
        if part and (dx or dy):
            self.heading = math.atan2(dy, dx)
        self._is_driving = len(nodes) < len(order["nodes"])

    def _why_not(self, node: dict[str, Any]) -> str:
        first = node["nodePosition"]
        if first["mapId"] != self.map:
            return "another map"
        turned = abs(first.get("theta", self.heading) - self.heading)
        return "turned otherwise" if turned > TURNED else ""

    def _reject(self, kind: str, why: str, **named: str) -> None:
        references = [{"referenceKey": k, "referenceValue": v} for k, v in named.items()]
        about = {"errorDescription": why, "errorLevel": "WARNING", "errorReferences": references}
        self.errors.append({"errorType": kind, **about})

    def _act(self, action: dict[str, Any]) -> dict[str, Any]:
        has_failed = self.fails[action["actionType"]] > 0
        self.fails[action["actionType"]] -= has_failed
        if "Charging" in action["actionType"] and not has_failed:
            self.is_charging = action["actionType"] == "startCharging"
        status = "FAILED" if has_failed else "FINISHED"
        result = "actionResult" if self.version[0] == "3" else "resultDescription"
        state = {"actionId": action["actionId"], "actionStatus": status}
        return {**state, result: "jammed"} if has_failed else state

    def state(self) -> dict[str, Any]:
        """Return its state, as the schema of its version has it."""
        where = {"x": self.at[0], "y": self.at[1], "theta": self.heading, "mapId": self.map}
        edge = {"edgeId": "way", "sequenceId": 1, "released": True}
        common = {
            **{"headerId": 1, "timestamp": "2026-11-25T04:00:00.000Z", "version": self.version},
            **{"manufacturer": "acme", "serialNumber": self._serial, "orderId": self._order},
            **{"orderUpdateId": 0, "lastNodeId": "", "lastNodeSequenceId": 0, "nodeStates": []},
            **{"edgeStates": [edge] * self._is_driving, "driving": False},
            **{"operatingMode": "AUTOMATIC", "errors": list(self.errors)},
        }
        if self.version[0] == "2":
            return common | {
                "agvPosition": where | {"positionInitialized": True},
                "actionStates": self._done + self._acted,
                "batteryState": {"batteryCharge": self.charge, "charging": self.is_charging},
                "safetyState": {"eStop": "NONE", "fieldViolation": False},
            }
        return common | {
            "mobileRobotPosition": where | {"localized": True},
            "actionStates": list(self._acted),
            "instantActionStates": list(self._done),
            "powerSupply": {"stateOfCharge": self.charge, "charging": self.is_charging},
            "safetyState": {"activeEmergencyStop": "NONE", "fieldViolation": False},
        }

    def say(self) -> None:
        """Publish its state."""
        self.client.publish(f"{self._topic}/state", json.dumps(self.state()))

    def say_connection(self, state: str) -> None:
        """Publish whether it is there, or have its last will do so."""
        said = json.dumps({"connectionState": state})
        self.client.publish(f"{self._topic}/connection", said)

    def leave(self) -> None:
        """Leave the broker."""
        self.client.disconnect()
        self.client.loop_stop()


def wait_for(body: Vda5050Body, vehicle: Vehicle, is_so: Callable[[Report], bool]) -> Report:
    """Let a vehicle say its state until what its body reports is so."""
    for _ in range(800):
        vehicle.say()
        time.sleep(0.025)
        report = body.report()
        if report is not None and is_so(report):
            return report
    raise AssertionError("never reported")


def a_load() -> FleetMission:
    """Return a vehicle with a load to bring from where it stands to [9, 3]."""
    load = Task("crate", (1.0, 1.0), {"lift": 1}, 2, to=(9.0, 3.0), unload=3)
    robot = Robot("v1", (1.0, 1.0), {"lift": 1}, 2.0)
    return FleetMission(Mission("yard", Plane(20.0, 20.0), ("lift",), (robot,), (load,)))


def two_vehicles() -> FleetMission:
    """Return a lifter and a scanner 10 m apart, with a task for each and one for both."""
    robots = (Robot("v1", (1.0, 1.0), {"lift": 1}, 2.0), Robot("v2", (11.0, 1.0), {"scan": 1}, 2.0))
    tasks = (
        Task("both", (6.0, 4.0), {"lift": 1, "scan": 1}, 2),
        Task("one", (2.0, 3.0), {"lift": 1}, 1),
        Task("other", (9.0, 3.0), {"scan": 1}, 1),
    )
    return FleetMission(Mission("yard", Plane(20.0, 20.0), ("lift", "scan"), robots, tasks))


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
def driving(
    version: str,
    stays: bool = False,
    part: float = 0.0,
    heading: float = 0.0,
    mission: FleetMission | None = None,
) -> Iterator[tuple[Vda5050Body, Vehicle]]:
    """Yield the body of a vehicle, with a load unless told otherwise, and it, over a broker."""
    [port] = free_ports(1)
    with running("mosquitto", "-p", str(port)):
        wait_for_port(port)
        vehicle = Vehicle(port, version, stays, part, heading)
        url = f"mqtt://127.0.0.1:{port}/uagv/acme/v1?map=yard&version={version}"
        body = Vda5050Body(url, mission or a_load(), 0)
        try:
            yield body, vehicle
        finally:
            body.close()
            vehicle.leave()


def wait_for_port(port: int) -> None:
    for _ in range(100):
        with socket.socket() as probe:
            if probe.connect_ex(("127.0.0.1", port)) == 0:
                return
        time.sleep(0.05)
    raise AssertionError("mosquitto does not listen")
