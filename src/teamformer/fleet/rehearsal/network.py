"""A network that loses, doubles, delays and cuts messages, as one seed determines."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable

from teamformer.fleet.messages import EVERYBODY, OPERATOR, Message, Notice, Post
from teamformer.fleet.rehearsal.faults import Faults
from teamformer.mission.parts.grid import Place

FASTEST, SLOWEST = 0.002, 0.02
"""Seconds that a message takes on a good network."""

Apart = Callable[[Place, Place], float]
"""Says how far two places are from one another."""

Deliver = Callable[[float, int, int, Message], None]
"""Hands a message over: when, from whom, to whom."""


class RehearsedNetwork:
    """Takes messages as bytes, and opens them once for all that receive them."""

    def __init__(self, post: Post, faults: Faults, deliver: Deliver, apart: Apart) -> None:
        self.messages = 0
        self.bytes = 0
        self.received_bytes = 0
        self._post = post
        self._faults = faults
        self._deliver, self._apart = deliver, apart
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
        rng, loss = self._rng, self._faults.loss
        data = self._post.seal(sender, notice)
        self.messages += 1
        self.bytes += len(data)
        self._last = data
        message = self._post.open(data)
        assert message is not None, self._post.dropped
        to = receivers if notice.to == EVERYBODY else (notice.to,)
        for receiver in self._in_reach(now, sender, to, places):
            if receiver != sender and not (loss and rng.random() < loss):
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

    def _in_reach(
        self,
        now: float,
        sender: int,
        receivers: Iterable[int],
        places: Callable[[int], Place] | None,
    ) -> Iterable[int]:
        """Return the receivers that no cut and no distance keeps from hearing a sender."""
        for cut in self._faults.cuts:
            if cut.begin <= now < cut.end and sender in cut.senders:
                receivers = [receiver for receiver in receivers if receiver not in cut.receivers]
        radio = self._faults.radio
        if radio is None or places is None or sender == OPERATOR:
            return receivers
        here = places(sender)
        return [
            receiver
            for receiver in receivers
            if receiver == OPERATOR or self._apart(here, places(receiver)) <= radio
        ]

    def _hand_over(self, now: float, sender: int, receiver: int, message: Message) -> None:
        self._deliver(now + self._delay(), sender, receiver, message)
        twice = self._faults.twice
        if twice and self._rng.random() < twice:
            self._deliver(now + self._delay(), sender, receiver, message)

    def _delay(self) -> float:
        late = self._faults.late
        delay = FASTEST + (SLOWEST - FASTEST) * self._rng.random()
        if late and self._rng.random() < late:
            delay += self._faults.delay * self._rng.random()
        return delay
