"""Messages over Zenoh, from peer to peer: no router, no broker."""

from __future__ import annotations

import json
import random
import threading
import time
from collections import deque
from collections.abc import Callable, Iterable, Sequence

import zenoh

from teamformer.base.errors import TeamformerError
from teamformer.fleet.messages import EVERYBODY, LARGEST, OPERATOR
from teamformer.fleet.transports.keys import Certificates

MOST_WAITING = 5_000
"""Messages that wait to be taken; beyond that the oldest are lost."""

DEAF = 15.0
"""Seconds without any message after which the session is opened anew."""


Take = Callable[[zenoh.Sample], None]


class ZenohTransport:
    """One session of one robot, which hears operators, what is said to it, and who it listens to.

    A robot dials others and is dialled, each pair one way only. `drop` is the part of incoming
    messages that is thrown away, for trials.
    """

    def __init__(
        self,
        mission: int,
        me: int,
        listen: str | None,
        connect: Sequence[str],
        drop: float = 0.0,
        certificates: Certificates | None = None,
    ) -> None:
        self._root = f"teamformer/{mission:x}"
        self._me = me
        self._listen, self._connect = listen, tuple(connect)
        self._drop = drop
        self._certificates = certificates
        self._came: deque[bytes] = deque(maxlen=MOST_WAITING)
        self._body: deque[bytes] = deque(maxlen=MOST_WAITING)
        self._bell = threading.Event()
        self._heard = time.monotonic()
        self._takers: dict[str, Take] = {  # by key
            f"to/{me}": self._take,
            f"from/{OPERATOR}": self._take,
        }
        self._ears: dict[str, zenoh.Subscriber[None]] = {}
        self._session = self._open()

    def send(self, to: int, data: bytes) -> None:
        """Send to a robot, or to all that listen."""
        self._put(f"from/{self._me}" if to == EVERYBODY else f"to/{to}", data)

    def listen_to(self, robots: Iterable[int]) -> None:
        """Take from now on what these robots say to everybody, and no others."""
        wanted = {f"from/{robot}" for robot in (*robots, OPERATOR)}
        for key in [key for key in self._takers if key.startswith("from/")]:
            if key not in wanted:
                del self._takers[key]
                self._ears.pop(key).undeclare()  # type: ignore[no-untyped-call]
        for key in sorted(wanted - self._takers.keys()):
            self._hear(key, self._take)

    def send_body(self, key: str, data: bytes) -> None:
        """Send to, or from, a simulated body."""
        self._put(f"body/{key}", data)

    def receive(self, seconds: float) -> Sequence[bytes]:
        """Wait so long at most for messages; return all that have come."""
        self._bell.wait(max(0.0, seconds))
        self._bell.clear()
        if time.monotonic() - self._heard > DEAF and (self._connect or self._listen):
            self._reopen()
        return _drain(self._came)

    def receive_body(self) -> Sequence[bytes]:
        """Return what has come to, or from, simulated bodies."""
        return _drain(self._body)

    def listen_to_body(self, key: str) -> None:
        """Take what is sent to, or from, simulated bodies."""
        self._hear(f"body/{key}", self._take_body)

    def close(self) -> None:
        """End the session."""
        self._session.close()  # type: ignore[no-untyped-call]

    def _hear(self, key: str, take: Take) -> None:
        self._takers[key] = take
        self._ears[key] = self._declare(self._session, key, take)

    def _declare(self, session: zenoh.Session, key: str, take: Take) -> zenoh.Subscriber[None]:
        """Subscribe to a key; robots are heard whatever their mission is, so that it is told."""
        root = "teamformer/*" if key.startswith("from/") else self._root
        return session.declare_subscriber(f"{root}/{key}", take)

    def _put(self, key: str, data: bytes) -> None:
        drop = zenoh.CongestionControl.DROP
        self._session.put(f"{self._root}/{key}", data, congestion_control=drop)

    def _open(self) -> zenoh.Session:
        config = zenoh.Config()
        settings: dict[str, object] = {
            "mode": "peer",
            "scouting/multicast/enabled": False,
            "listen/endpoints": [self._listen] if self._listen else [],
            "connect/endpoints": list(self._connect),
            "connect/timeout_ms": -1,  # in the background, for ever
            "connect/exit_on_failure": False,
            "transport/link/tx/lease": 2000,
        }
        if self._certificates is not None:
            settings |= _tls_settings(self._certificates)
        for key, value in settings.items():
            config.insert_json5(key, json.dumps(value))
        try:
            session = zenoh.open(config)
        except zenoh.ZError as error:
            raise TeamformerError(
                f"{self._listen or self._connect}: no way to the others: {error}",
                "is another process there? name another endpoint",
            ) from None
        for key, take in self._takers.items():
            self._ears[key] = self._declare(session, key, take)
        return session

    def _reopen(self) -> None:
        """Sessions that were cut have been seen to stay deaf: begin anew."""
        self._heard = time.monotonic()
        try:
            session = self._open()
        except TeamformerError:
            return
        self._session.close()  # type: ignore[no-untyped-call]
        self._session = session

    def _take(self, sample: zenoh.Sample) -> None:
        self._heard = time.monotonic()
        data = sample.payload.to_bytes()
        if len(data) <= LARGEST and not (self._drop and random.random() < self._drop):
            self._came.append(data)
            self._bell.set()

    def _take_body(self, sample: zenoh.Sample) -> None:
        self._body.append(sample.payload.to_bytes())
        self._bell.set()


def _tls_settings(files: Certificates) -> dict[str, object]:
    """Return Zenoh's settings under which both ends of a link must show a certificate."""
    tls = {
        "root_ca_certificate": str(files.ca),
        "enable_mtls": True,
    }
    for end in ("listen", "connect"):
        tls |= {f"{end}_certificate": str(files.certificate), f"{end}_private_key": str(files.key)}
    return {f"transport/link/tls/{key}": value for key, value in tls.items()}


def _drain(waiting: deque[bytes]) -> list[bytes]:
    taken = []
    while waiting:
        taken.append(waiting.popleft())
    return taken
