"""What is heard of a vehicle: its newest state, what it says is wrong, and whether it is there."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from typing import Any

from teamformer.fleet.bodies.vda5050.address import Address
from teamformer.fleet.bodies.vda5050.graph import RoadGraph
from teamformer.fleet.bodies.vda5050.state import State
from teamformer.mission.parts.grid import Place

AWAY = 40.0
"""Seconds for which a vehicle may be silent, or somewhere else; the standard wants a state every
30."""


class VehicleWatch:
    """Takes in what a vehicle says, and tells once what keeps orders from it."""

    def __init__(
        self, address: Address, tell: Callable[[str], None], graph: RoadGraph | None = None
    ) -> None:
        self.taken = 0  # states
        self.state = State({}, address.dialect)
        self._address, self._tell, self._graph = address, tell, graph
        self._is_off = False
        self._trouble = ""
        self._heard = self._known = time.monotonic()  # when it last spoke, and said a place

    @property
    def is_away(self) -> bool:
        """Say whether it is long since the vehicle was where it can be sent off."""
        return time.monotonic() - self._known > AWAY

    def place(self) -> Place | None:
        """Return where on its map the vehicle is; None before it says so, or if it is elsewhere.

        On roads that is a place, or the next one and the seconds until then.
        """
        trouble = self._find_trouble()
        if trouble != self._trouble:
            self._tell(f"the vehicle {trouble or 'is there again'}")
            self._trouble = trouble
        return None if trouble else self._located()

    def _located(self) -> Place | None:
        if self._graph is None:
            return self.state.place
        return self._graph.locate(self.state, time.monotonic())

    def take(self, topic: str, content: Mapping[str, Any]) -> Place | None:
        """Take in a connection or a state; return the place of a state."""
        if topic == "connection":
            self._is_off = content.get("connectionState") != "ONLINE"
            if self._is_off:
                self.state = State({}, self._address.dialect)  # nothing of it holds any more
            self.place()
            return None
        before, self.state = self.state, State(content, self._address.dialect)
        self.taken += 1
        self._is_off, self._heard = False, time.monotonic()
        for error in self.state.errors:
            if error not in before.errors:
                self._tell(f"the vehicle says {error}")
        at = self.place()
        if at is not None:
            self._known = self._heard
        return at

    def _find_trouble(self) -> str:
        state, own = self.state, self._address.map
        if self._is_off:
            return "is off line"
        if not state.content:
            return ""
        if self._located() is None:
            return "does not know where it is"
        if self._graph is None and state.map not in (None, own):
            return f"is on map '{state.map}', not on '{own}', and gets no orders"
        is_silent = time.monotonic() - self._heard > AWAY
        return f"has said nothing for {AWAY:g} s" if is_silent else ""
