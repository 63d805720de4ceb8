"""Holds the simulated bodies of a fleet of processes, in real time."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from msgspec import DecodeError, ValidationError

from teamformer.fleet.bodies.body import Command
from teamformer.fleet.bodies.remote import SILENCE, decode_order, encode
from teamformer.fleet.bodies.simulated import Done
from teamformer.fleet.bodies.world import FleetWorld
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.messages import CallOff, Offer, Post
from teamformer.fleet.transports.zenoh_mesh import ZenohTransport

if TYPE_CHECKING:
    from teamformer.fleet.signatures import Signatures

REPORT_EVERY = 0.2
"""Seconds between two reports of a body to which nothing happens."""

ROUND = 0.02
"""Seconds between two looks at the world at most."""


LATEST = 120.0
"""Seconds after which time begins even if not all minds are there."""


class WorldServer:
    """Obeys orders and reports; time begins when every mind has given an order.

    `seed` decides what an uncertain mission really is.
    """

    def __init__(
        self,
        mission: FleetMission,
        transport: ZenohTransport,
        secret: bytes,
        signatures: Signatures | None = None,
        seed: int = 0,
    ) -> None:
        self.truth = mission.truth(seed)
        self.world = FleetWorld(mission, self.truth)
        self._transport = transport
        self._post = Post(mission.number, mission.robots, secret, signatures)
        self._opened = time.monotonic()
        self._begun: float | None = None
        self._heard = [float("inf")] * mission.robots
        self._reported = [float("-inf")] * mission.robots
        transport.listen_to_body("orders")

    @property
    def now(self) -> float:
        """Return the seconds since the world began."""
        return 0.0 if self._begun is None else time.monotonic() - self._begun

    @property
    def has_begun(self) -> bool:
        """Say whether time has begun."""
        return self._begun is not None

    @property
    def ready(self) -> frozenset[int]:
        """Return the robots whose minds have given an order."""
        heard = enumerate(self._heard)
        return frozenset(robot for robot, at in heard if at < float("inf"))

    def step(self) -> list[Done]:
        """Wait for a moment, let the world go on, report; return what was done meanwhile."""
        before = len(self.world.done)
        self._begin()
        offers = self._transport.receive(ROUND)
        touched = self.world.advance(self.now)
        for data in offers:
            message, _ = self._post.judge(data)
            if message is not None and type(message.body) is Offer:
                self.world.add_task(message.body.task)
            elif message is not None and type(message.body) is CallOff:
                self.world.call_off(message.body.key)
        for data in self._transport.receive_body():
            touched |= self._obey(data)
        touched |= self._stop_the_mindless()
        touched |= self.world.advance(self.now)
        for robot in range(len(self._heard)):
            clock = time.monotonic()
            if robot in touched or clock - self._reported[robot] > REPORT_EVERY:
                self._reported[robot] = clock
                report = encode(tuple(self.world.report(robot)))
                self._transport.send_body(f"reports/{robot}", report)
        return list(self.world.done.values())[before:]

    def _begin(self) -> None:
        """Let time begin once all are there, or have had long enough."""
        are_here = float("inf") not in self._heard
        if self._begun is None and (are_here or time.monotonic() - self._opened > LATEST):
            self._begun = time.monotonic()
            self._heard = [0.0] * len(self._heard)

    def _obey(self, data: bytes) -> set[int]:
        try:
            order = decode_order(data)
        except (DecodeError, ValidationError):
            return set()
        if not 0 <= order.robot < len(self._heard):
            return set()
        place, world = order.place, self.world.mission.source.world
        if place is not None and not world.is_free(place):
            return set()
        self._heard[order.robot] = self.now
        command = Command(order.leg, place, order.task, order.team, order.serve)
        return self.world.command(order.robot, command._replace(charge=order.charge))

    def _stop_the_mindless(self) -> set[int]:
        """Let bodies stop whose minds have fallen silent."""
        touched: set[int] = set()
        for robot, heard in enumerate(self._heard):
            command = self.world.robots[robot].command
            is_moving = command.place is not None or command.serve
            if self.now - heard > SILENCE and is_moving:
                touched |= self.world.command(robot, command._replace(place=None, serve=False))
        return touched
