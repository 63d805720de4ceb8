"""Where something is served, and whether it can be."""

from __future__ import annotations

import socket
from dataclasses import dataclass

from teamformer.errors import TeamformerError


@dataclass(frozen=True)
class Address:
    """Where something is served."""

    host: str = "127.0.0.1"
    port: int = 8765


def address_of(text: str) -> Address:
    """Return the address that a flag names: `8765`, or with another host `0.0.0.0:8765`."""
    host, _, port = text.rpartition(":")
    if not (port.isdecimal() and 1 <= int(port) <= 65535):
        raise TeamformerError(
            f"--port {text} is no port", "write a number from 1 to 65535, or HOST:NUMBER"
        )
    return Address(host.strip("[]") or Address.host, int(port))


def check_address(at: Address, flag: str = "--port") -> None:
    """Raise `TeamformerError` if the port is not free, and suggest one that is for its flag."""
    host, port = at.host, at.port
    with socket.socket(socket.AF_INET6 if ":" in host else socket.AF_INET) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((host, port))
        except OSError as error:
            reason = error.strerror or str(error)
            raise TeamformerError(
                f"{host}:{port} cannot be used: {reason}", f"try {flag} {_free_port()}"
            ) from None


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])
