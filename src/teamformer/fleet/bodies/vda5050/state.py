"""What the newest state of a vehicle says."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from teamformer.fleet.bodies.body import charge_of
from teamformer.fleet.bodies.vda5050.dialect import Dialect
from teamformer.mission.parts.grid import Place

FINISHED = "FINISHED"
FAILED = ("FAILED", "RETRIABLE")
"""How an action ends; one that may be tried again is sent anew here, as one that has failed is."""

OURS = ("topic", "headerId", "orderId", "orderUpdateId", "actionId")
"""References of errors that say which message is meant; nobody at a terminal knows them."""


FARTHEST = 1e9
"""Metres from the origin that a vehicle cannot be away."""


@dataclass(frozen=True)
class State:
    """A state as it came: a part that is not as the standard has it counts as not there."""

    content: Mapping[str, Any]
    dialect: Dialect

    @property
    def place(self) -> Place | None:
        """Return where the vehicle is, if it knows."""
        at = self._position
        x, y = _number(at.get("x")), _number(at.get("y"))
        if not at.get(self.dialect.is_localized) or x is None or y is None:
            return None
        return x, y

    @property
    def map(self) -> str | None:
        """Return the map on which the vehicle says that it is."""
        name = self._position.get("mapId")
        return None if name is None else str(name)

    @property
    def _position(self) -> Mapping[str, Any]:
        at = self.content.get(self.dialect.position)
        return at if isinstance(at, dict) else {}

    @property
    def charge(self) -> float | None:
        """Return how full its battery is, 0 to 1, if it says so."""
        _, key = self.dialect.battery
        percent = _number(self._power.get(key))
        return None if percent is None else charge_of(percent / 100)

    @property
    def is_charging(self) -> bool:
        """Say whether it says that its battery is charged just now."""
        return self._power.get("charging") is True

    @property
    def _power(self) -> Mapping[str, Any]:
        said = self.content.get(self.dialect.battery[0])
        return said if isinstance(said, dict) else {}

    @property
    def order(self) -> str:
        """Return the order that the vehicle has, or had last."""
        return str(self.content.get("orderId") or "")

    @property
    def last_node(self) -> str:
        """Return the node that it passed last; `start` before the first."""
        return str(self.content.get("lastNodeId") or "start")

    @property
    def next_node(self) -> str:
        """Return the next node of its order; nothing after the last."""
        ahead = (str(each.get("nodeId")) for each in _records(self.content, "nodeStates"))
        return next((node for node in ahead if node != self.last_node), "")

    @property
    def is_moving(self) -> bool:
        """Say whether it says that it drives just now."""
        return self.content.get("driving") is True

    @property
    def is_driving(self) -> bool:
        """Say whether anything of its order is ahead."""
        return bool(self.content.get("nodeStates") or self.content.get("edgeStates"))

    def status_of(self, action: str) -> str | None:
        """Return what the vehicle says of an action, be it instant or one of an order."""
        return next((str(each.get("actionStatus")) for each in self._said_of(action)), None)

    def result_of(self, action: str) -> str:
        """Return what it says came of an action, in words."""
        results = (each.get(self.dialect.result) for each in self._said_of(action))
        return next((str(result) for result in results if result), "")

    def _said_of(self, action: str) -> Iterator[Mapping[str, Any]]:
        for name in sorted({self.dialect.action_states, "actionStates"}):
            yield from (a for a in _records(self.content, name) if a.get("actionId") == action)

    @property
    def errors(self) -> tuple[str, ...]:
        """Return what the vehicle says is wrong, each in a line."""
        return tuple(dict.fromkeys(map(_told, _records(self.content, "errors"))))


def _told(error: Mapping[str, Any]) -> str:
    """Return an error as its type, what it says and what it refers to."""
    words = [str(error[key]) for key in ("errorDescription", "errorHint") if error.get(key)]
    named = [
        f"{each.get('referenceKey')} {each.get('referenceValue')}"
        for each in _records(error, "errorReferences")
        if each.get("referenceKey") not in OURS
    ]
    told = ": ".join([str(error.get("errorType")), *words])
    return f"{told} ({', '.join(named)})" if named else told


def _records(content: Mapping[str, Any], key: str) -> list[Mapping[str, Any]]:
    found = content.get(key)
    return [each for each in found if isinstance(each, dict)] if isinstance(found, list) else []


def _number(value: Any) -> float | None:
    is_sane = isinstance(value, int | float) and abs(value) < FARTHEST
    return float(value) if is_sane else None
