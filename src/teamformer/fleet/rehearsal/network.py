"""A network that loses, doubles, delays and cuts messages, as one seed determines."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable

from teamformer.fleet.messages import (
    EVERYBODY,
    OPERATOR,
    Message,
    Notice,
    Post,
)
from teamformer.fleet.rehearsal.faults import Faults
from teamformer.grid import Place

FASTEST, SLOWEST = 0.002, 0.02
"""Seconds that a message takes on a good network."""

Deliver = Callable[[float, int, int, Message], None]
"""Hands a message over: when, from whom, to whom."""


class RehearsedNetwork:
    """Takes messages as bytes, and opens them once for all that receive them."""

    def __init__(self, post: Post, faults: Faults, deliver: Deliver) -> None:
        self.messages = 0
        self.bytes = 0
        self.received_bytes = 0
        self._post = post
        self._faults = faults
        self._deliver = deliver
        self._rng = random.Random(faults.seed)
        self._last = b""

    def send(
        self,
        now: float,
        sender: int,
        notice: Notice,
        receivers: Iterable[int],
        places: Callable[[int], Place] | None = None,
    ) -> None:
        """Send a message on its ways; `places` says where robots are if the radio is short."""
        data = self._post.seal(sender, notice)
        self.messages += 1
        self.bytes += len(data)
        self._last = data
        message = self._post.open(data)
        assert message is not None, self._post.dropped
        to = receivers if notice.to == EVERYBODY else (notice.to,)
        for receiver in to:
            if receiver != sender and self._reaches(now, sender, receiver, places):
                self.received_bytes += len(data)
                self._hand_over(now, sender, receiver, message)

    def chance(self, part: float) -> bool:
        """Say yes so often."""
        return part > 0.0 and self._rng.random() < part

    def spoil(self) -> bytes:
        """Return a message as nobody should send it: noise, damaged, foreign or absurd."""
        rng, data = self._rng, bytearray(self._last)
        kind = rng.randrange(4)
        if kind == 0 or not data:
            return rng.randbytes(rng.randrange(200))
        if kind == 1:
            data[rng.randrange(len(data))] ^= 1 << rng.randrange(8)
            return bytes(data)
        if kind == 2:
            return bytes(data[: rng.randrange(len(data))])
        post = Post(self._post.mission ^ 1, self._post.robots)
        message = self._post.open(self._last)
        assert message is not None
        return post.seal(message.sender, Notice(EVERYBODY, message.body))

    def _reaches(
        self, now: float, sender: int, receiver: int, places: Callable[[int], Place] | None
    ) -> bool:
        faults = self._faults
        for cut in faults.cuts:
            if sender in cut.senders and receiver in cut.receivers and cut.begin <= now < cut.end:
                return False
        if faults.radio is not None and places and sender != OPERATOR != receiver:
            here, there = places(sender), places(receiver)
            if (here[0] - there[0]) ** 2 + (here[1] - there[1]) ** 2 > faults.radio**2:
                return False
        return not (faults.loss and self._rng.random() < faults.loss)

    def _hand_over(self, now: float, sender: int, receiver: int, message: Message) -> None:
        rng, faults = self._rng, self._faults
        self._deliver(now + self._delay(), sender, receiver, message)
        if faults.twice and rng.random() < faults.twice:
            self._deliver(now + self._delay(), sender, receiver, message)

    def _delay(self) -> float:
        rng, faults = self._rng, self._faults
        delay = FASTEST + (SLOWEST - FASTEST) * rng.random()
        if faults.late and rng.random() < faults.late:
            delay += faults.delay * rng.random()
        return delay
