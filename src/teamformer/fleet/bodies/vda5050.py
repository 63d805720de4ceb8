"""A vehicle that speaks VDA5050 over MQTT: commands become orders, states become reports.

A leg is an order of two nodes, where the vehicle is and where it is to go; it is sent again until
the vehicle's state shows it, and the order before is cancelled first. Serving is an instant action.
A task counts as done when the vehicle has finished that action.

A load is an order of its own: `pick` where the vehicle is, the way at the pace of its team, and
`drop` where the load is to be brought. Its task counts as done when the vehicle has dropped it. If
it is told to stop on its way, that order is cancelled and another one has it drop the load there.
"""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from typing import Any, NamedTuple
from urllib.parse import parse_qsl, urlparse

from paho.mqtt import client as mqtt
from paho.mqtt.enums import CallbackAPIVersion

from teamformer.errors import TeamformerError
from teamformer.fleet.bodies.body import Command, Report
from teamformer.fleet.fleet_mission import Mission
from teamformer.fleet.messages import TaskFact
from teamformer.grid import Place

VERSIONS = ("2.0.0", "2.1.0", "3.0.0")
"""Versions of VDA5050 that a vehicle may speak; the first unless the address names another."""

SERVE = "serve"
"""The action that a vehicle must know; its parameters are `task`, `team` and `duration`."""

AGAIN = 1.5
"""Seconds until what a vehicle does not show is sent once more."""

PICK, DROP, SET_DOWN = "pick", "drop", "set-down"
"""The standard's actions for loads, whose parameters are `task`, `team` and `duration` too, and how
the names of orders end that have a load dropped on its way."""

NEAR = 0.3
"""Metres from its goal at which a vehicle that has nothing more to drive is there."""

KEEPALIVE = 15  # seconds


class Dialect(NamedTuple):
    """What versions of VDA5050 say differently."""

    position: str  # where a vehicle is
    is_localized: str  # whether that is known
    action_states: str  # of instant actions
    action_lists: tuple[str, ...]  # names of the list of instant actions
    blocking: str  # how a service blocks other actions
    deviation: Any  # by a metre from the node that a vehicle stands at
    speed: str  # at most, on an edge


DIALECTS = {
    # The text of 2.0 calls the list `actions`, its first schema `instantActions`; vehicles check
    # for one or the other.
    "2": Dialect(
        position="agvPosition",
        is_localized="positionInitialized",
        action_states="actionStates",
        action_lists=("actions", "instantActions"),
        blocking="HARD",
        deviation=1.0,
        speed="maxSpeed",
    ),
    "3": Dialect(
        position="mobileRobotPosition",
        is_localized="localized",
        action_states="instantActionStates",
        action_lists=("actions",),
        blocking="NONE",
        deviation={"a": 1.0, "b": 1.0, "theta": 0.0},
        speed="maximumSpeed",
    ),
}
"""By the first number of a version."""


class Vda5050Body:
    """One vehicle; `url` is mqtt://HOST:PORT/INTERFACE/MANUFACTURER/SERIAL?map=ID&version=2.1.0."""

    def __init__(self, url: str, mission: Mission, robot: int) -> None:
        address = urlparse(url)
        parts = [part for part in address.path.split("/") if part]
        if address.scheme != "mqtt" or not address.hostname or len(parts) != 3:
            raise TeamformerError(
                f"--body vda5050:{url} is no address of a vehicle",
                "write vda5050:mqtt://HOST:PORT/INTERFACE/MANUFACTURER/SERIAL?map=ID",
            )
        self._interface, self._manufacturer, self._serial = parts
        told = {"map": "map", "version": VERSIONS[0]} | dict(parse_qsl(address.query))
        if unknown := sorted(set(told) - {"map", "version"}):
            raise TeamformerError(
                f"--body vda5050 has no key '{unknown[0]}'", "use map and version"
            )
        self._map, self._version = told["map"], told["version"]
        if self._version not in VERSIONS:
            raise TeamformerError(
                f"version of --body vda5050 is '{self._version}'", f"use {', '.join(VERSIONS)}"
            )
        self._major = self._version.partition(".")[0]
        self._dialect = DIALECTS[self._major]
        self._tasks = {task.key: task for task in mission.tasks}
        self._lock = threading.Lock()
        self._state: Mapping[str, Any] = {}
        self._headers: dict[str, int] = {}
        self._taken = 0
        self._command = Command()
        self._run = f"{robot}-{time.time_ns() // 1_000_000:x}"  # so that no order is an earlier one
        self._action = ""  # the service at hand
        self._held = ""  # the service whose load it has
        self._lies: Place | None = None  # where it has set down the load of the task at hand
        self._sent: dict[str, float] = {}  # when each order or action was last sent
        self._client = mqtt.Client(CallbackAPIVersion.VERSION2, f"teamformer-{self._run}")
        self._client.on_connect = self._on_connect
        self._client.on_message = self._on_message
        host, port = address.hostname, address.port or 1883
        try:
            self._client.connect(host, port, KEEPALIVE)
        except OSError as error:
            raise TeamformerError(
                f"no broker at {host}:{port}: {error}", "start it, or name another one"
            ) from None
        self._client.loop_start()

    def command(self, command: Command) -> None:
        """Take up a command; it is pursued whenever there is news of the vehicle."""
        with self._lock:
            if command.task != self._command.task:
                self._lies = None
            if command.serve and not self._command.serve:
                self._action = f"{self._run}-{command.leg}-{time.time_ns() // 1_000_000:x}"
            self._command = command
            self._pursue()

    def report(self) -> Report | None:
        """Return what the newest state says; None before the first, or while it is off line."""
        with self._lock:
            at = self._position()
            if at is None:
                return None
            self._pursue()
            leg = self._command.leg if self._is_on_it() else -1
            report = Report(*self._place(at), leg, self._is_served(), False, self._taken)
            has = bool(self._held) and self._is_bringing()
            return report if self._load is None else report._replace(carries=has, load=self._lies)

    def close(self) -> None:
        """Cancel what the vehicle has to do, and leave the broker."""
        with self._lock:
            if self._is_driving():
                self._send_action("cancelOrder", f"{self._run}-end", {})
        time.sleep(0.2)  # until that is out
        self._client.disconnect()
        self._client.loop_stop()

    def _on_connect(self, client: mqtt.Client, *_: Any) -> None:
        for topic in ("state", "connection"):
            client.subscribe(self._topic(topic), qos=1)

    def _on_message(self, _client: mqtt.Client, _data: Any, message: mqtt.MQTTMessage) -> None:
        """Take in a state or a connection; what is no JSON object is left."""
        try:
            content = json.loads(message.payload)
        except ValueError:
            return
        if not isinstance(content, dict):
            return
        with self._lock:
            if message.topic.endswith("/state"):
                self._state, self._taken = content, self._taken + 1
            elif content.get("connectionState") != "ONLINE":
                self._state = {}  # its last will: nothing that it said holds any more

    def _position(self) -> tuple[float, float] | None:
        at = self._state.get(self._dialect.position)
        if not isinstance(at, dict) or not at.get(self._dialect.is_localized):
            return None
        x, y = at.get("x"), at.get("y")
        if isinstance(x, int | float) and isinstance(y, int | float) and x == x and y == y:
            return float(x), float(y)
        return None

    def _pursue(self) -> None:
        """Bring the vehicle from what its state shows to what the command wants, one thing each."""
        at, command = self._position(), self._command
        if at is None:
            return
        self._note_load(at)
        if self._held and not self._is_bringing():
            if self._is_driving() and self._state.get("orderId") == self._held:
                self._once(f"cancel-{self._held}", self._cancel)
            else:
                self._once(f"{self._held}-{SET_DOWN}", lambda: self._set_down(at))
        elif not self._is_on_it():
            if self._is_driving():
                self._once(f"cancel-{command.leg}", self._cancel)
            elif command.place is not None:
                goal = command.place
                self._once(f"order-{command.leg}", lambda: self._drive(at, goal))
        elif command.serve and self._load is not None:
            if self._state.get("orderId") != self._action:
                load = self._load
                self._once(self._action, lambda: self._bring(at, load))
        elif command.serve and self._status_of(self._action) is None:
            self._once(self._action, self._serve)

    def _once(self, what: str, send: Any) -> None:
        """Send something now, or again if it was sent some time ago."""
        now = time.monotonic()
        if now - self._sent.get(what, float("-inf")) > AGAIN:
            self._sent[what] = now
            send()

    def _is_driving(self) -> bool:
        return bool(self._state.get("nodeStates") or self._state.get("edgeStates"))

    def _is_on_it(self) -> bool:
        """Say whether the vehicle has taken up the command of this leg."""
        if self._is_bringing():
            return True
        if self._held:
            return False
        if self._command.place is None:
            return not self._is_driving()
        return bool(self._state.get("orderId") == self._order_id())

    def _is_bringing(self) -> bool:
        """Say whether it does as it was told with a load, or has done so."""
        is_told = self._command.serve and self._load is not None
        return is_told and self._state.get("orderId") == self._action

    def _note_load(self, at: Place) -> None:
        """Note whether it has a load, and where it has set one down."""
        if self._held:
            is_brought = self._status_of(f"{self._held}-{DROP}") == "FINISHED"
            if is_brought or self._status_of(f"{self._held}-{SET_DOWN}") == "FINISHED":
                self._held, self._lies = "", None if is_brought else at
        elif (
            self._is_bringing()
            and not self._is_served()
            and self._status_of(f"{self._action}-{PICK}") == "FINISHED"
        ):
            self._held, self._lies = self._action, None

    def _order_id(self) -> str:
        return f"{self._run}-{self._command.leg}"

    def _place(self, at: tuple[float, float]) -> Place:
        """Return where it is; who has driven its order and is near the goal is there."""
        goal = self._command.place
        if self._is_bringing() and self._load is not None:
            goal = self._load.to if self._is_served() else None
        if goal is None or self._is_driving() or not self._is_on_it():
            return at
        is_near = (at[0] - goal[0]) ** 2 + (at[1] - goal[1]) ** 2 <= NEAR**2
        return goal if is_near else at

    def _is_served(self) -> bool:
        action = self._action if self._load is None else f"{self._action}-{DROP}"
        return self._command.serve and self._status_of(action) == "FINISHED"

    @property
    def _load(self) -> TaskFact | None:
        """Return the task at hand if it has a load."""
        task = self._tasks.get(self._command.task)
        return None if task is None or task.to is None else task

    def _status_of(self, action: str) -> str | None:
        """Return what a vehicle says of an action, be it instant or one of an order."""
        for name in {self._dialect.action_states, "actionStates"}:
            for state in self._state.get(name) or ():
                if isinstance(state, dict) and state.get("actionId") == action:
                    return str(state.get("actionStatus"))
        return None

    def _drive(self, at: tuple[float, float], goal: Place) -> None:
        self._order(self._order_id(), at, goal)

    def _bring(self, at: tuple[float, float], load: TaskFact) -> None:
        """Order the vehicle to pick a load, to go with it as fast as its team, and to drop it."""
        assert load.to is not None
        actions = [
            [self._action_of(kind, f"{self._action}-{kind}", self._service(load, lasts), "HARD")]
            for kind, lasts in ((PICK, load.duration), (DROP, load.unload))
        ]
        pace = {self._dialect.speed: self._command.pace} if self._command.pace else {}
        self._order(self._action, at, load.to, actions, pace)

    def _set_down(self, at: tuple[float, float]) -> None:
        """Order the vehicle to drop the load that it has where it is."""
        name = f"{self._held}-{SET_DOWN}"
        parameters = {"task": self._held, "team": self._command.team, "duration": 0.0}
        node = self._node(f"{name}-node", 0, at[0], at[1])
        node["nodePosition"]["allowedDeviationXY"] = self._dialect.deviation
        node["actions"] = [self._action_of(DROP, name, parameters, "HARD")]
        self._publish("order", {"orderId": name, "orderUpdateId": 0, "nodes": [node], "edges": []})

    def _order(
        self,
        name: str,
        at: tuple[float, float],
        goal: Place,
        actions: Sequence[Sequence[Mapping[str, Any]]] = ((), ()),
        limits: Mapping[str, float] | None = None,
    ) -> None:
        """Send an order of two nodes, with what is to be done at each and limits of the way."""
        last = str(self._state.get("lastNodeId") or "start")
        start = self._node(last, 0, at[0], at[1])
        start["nodePosition"]["allowedDeviationXY"] = self._dialect.deviation
        end = self._node(f"{name}-goal", 2, goal[0], goal[1])
        start["actions"], end["actions"] = (list(each) for each in actions)
        edge = {
            "edgeId": f"{name}-way",
            "sequenceId": 1,
            "released": True,
            "startNodeId": start["nodeId"],
            "endNodeId": end["nodeId"],
            "actions": [],
            **(limits or {}),
        }
        order = {"orderId": name, "orderUpdateId": 0}
        self._publish("order", {**order, "nodes": [start, end], "edges": [edge]})

    def _serve(self) -> None:
        task = self._tasks.get(self._command.task)
        lasts = 0.0 if task is None else task.duration
        self._send_action(SERVE, self._action, self._service(task, lasts))

    def _service(self, task: TaskFact | None, lasts: float) -> dict[str, Any]:
        """Return the parameters of an action that is for a task."""
        name = str(self._command.task) if task is None else task.name
        return {"task": name, "team": self._command.team, "duration": lasts}

    def _cancel(self) -> None:
        stamp = time.time_ns() // 1_000_000
        self._send_action("cancelOrder", f"{self._run}-cancel-{stamp:x}", {})

    def _send_action(self, kind: str, name: str, parameters: Mapping[str, Any]) -> None:
        action = self._action_of(kind, name, parameters, self._dialect.blocking)
        self._publish("instantActions", {name: [action] for name in self._dialect.action_lists})

    def _action_of(
        self, kind: str, name: str, parameters: Mapping[str, Any], blocking: str
    ) -> dict[str, Any]:
        return {
            "actionType": kind,
            "actionId": name,
            "blockingType": blocking,
            "actionParameters": [{"key": k, "value": v} for k, v in parameters.items()],
        }

    def _node(self, name: str, sequence: int, x: float, y: float) -> dict[str, Any]:
        position = {"x": x, "y": y, "theta": 0.0, "mapId": self._map}
        node = {"nodeId": name, "sequenceId": sequence, "released": True, "actions": []}
        return {**node, "nodePosition": position}

    def _topic(self, name: str) -> str:
        return f"{self._interface}/v{self._major}/{self._manufacturer}/{self._serial}/{name}"

    def _publish(self, topic: str, content: Mapping[str, Any]) -> None:
        self._headers[topic] = self._headers.get(topic, -1) + 1
        stamp = datetime.now(UTC).isoformat(timespec="milliseconds").replace("+00:00", "Z")
        header = {
            "headerId": self._headers[topic],
            "timestamp": stamp,
            "version": self._version,
            "manufacturer": self._manufacturer,
            "serialNumber": self._serial,
        }
        self._client.publish(self._topic(topic), json.dumps({**header, **content}))
