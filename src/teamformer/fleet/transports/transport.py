"""The seam to the network: send bytes to everybody or to one, and take what has come."""

from __future__ import annotations

import ipaddress
import os
import time
from collections import deque
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from teamformer.errors import TeamformerError

SHORTEST_SECRET = 16  # bytes

MOST_A_SECOND = 100
MOST_BYTES_A_SECOND = 200_000
"""What one sender may say; more is dropped and counted, so that nobody can flood the others."""


class Transport(Protocol):
    """Carries messages; it may lose, double, delay and reorder them, but not change them."""

    def send(self, to: int, data: bytes) -> None:
        """Send to a robot, or to EVERYBODY that listens to the sender."""

    def listen_to(self, robots: Iterable[int]) -> None:
        """Take from now on what these robots say to everybody, and no others."""

    def receive(self, seconds: float) -> Sequence[bytes]:
        """Wait so long at most for messages; return all that have come."""

    def close(self) -> None:
        """Say no more."""


class Sluice:
    """Lets through what one sender may say in a second."""

    def __init__(self) -> None:
        self.dropped = 0
        self._said: dict[int, deque[tuple[float, int]]] = {}
        self._bytes: dict[int, int] = {}

    def lets(self, sender: int, size: int, now: float | None = None) -> bool:
        """Say whether a message of so many bytes may pass."""
        now = time.monotonic() if now is None else now
        said = self._said.setdefault(sender, deque())
        while said and said[0][0] < now - 1.0:
            self._bytes[sender] -= said.popleft()[1]
        total = self._bytes.get(sender, 0)
        if len(said) >= MOST_A_SECOND or total + size > MOST_BYTES_A_SECOND:
            self.dropped += 1
            return False
        said.append((now, size))
        self._bytes[sender] = total + size
        return True


def read_secret(path: Path | None) -> bytes:
    """Return the shared key in a file; nothing without a file."""
    if path is None:
        return b""
    try:
        secret = path.read_bytes().strip()
    except OSError as error:
        raise TeamformerError(
            f"{path}: cannot be read: {error.strerror}", "name the file of the fleet's shared key"
        ) from None
    if len(secret) < SHORTEST_SECRET:
        raise TeamformerError(
            f"{path}: a key of {len(secret)} bytes is too short",
            "make one with: openssl rand -hex 32",
        )
    return secret


@dataclass(frozen=True)
class Certificates:
    """Files for TLS: who signs this fleet's certificates, the own one, and the key to it."""

    ca: Path
    certificate: Path
    key: Path


def read_certificates(folder: Path | None) -> Certificates | None:
    """Return the certificates in a folder; none without a folder."""
    if folder is None:
        return None
    files = Certificates(folder / "ca.pem", folder / "certificate.pem", folder / "key.pem")
    for path in (files.ca, files.certificate, files.key):
        if not os.access(path, os.R_OK):
            raise TeamformerError(
                f"{path} is absent or cannot be read",
                "the folder of --tls holds ca.pem, certificate.pem and key.pem",
            )
    return files


def check_endpoints(
    endpoints: Iterable[str], secret: bytes, certificates: Certificates | None = None
) -> None:
    """Refuse to speak beyond this machine unless messages are sealed with a key, or by TLS."""
    for endpoint in endpoints:
        protocol, _, address = endpoint.partition("/")
        if not address or protocol not in ("tcp", "udp", "tls", "quic"):
            raise TeamformerError(
                f"'{endpoint}' is no endpoint", "write it as in tcp/192.168.1.7:7447"
            )
        is_tls = protocol in ("tls", "quic")
        if is_tls and certificates is None:
            raise TeamformerError(
                f"'{endpoint}' needs certificates", "name their folder with --tls FOLDER"
            )
        if not secret and not is_tls and not _is_loopback(address):
            raise TeamformerError(
                f"'{endpoint}' is beyond this machine, and messages would not be protected",
                "name the fleet's shared key with --key FILE, or use tls/ endpoints",
            )


def _is_loopback(address: str) -> bool:
    host = address.rpartition(":")[0].strip("[]")
    try:
        return host == "localhost" or ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False
