"""Where something is served, and whether it can be."""

from __future__ import annotations

import socket
from contextlib import suppress
from dataclasses import dataclass
from ipaddress import ip_address
from urllib.parse import urlsplit

from teamformer.base.errors import TeamformerError

LOOPBACK = ("127.0.0.1", "localhost", "::1")
NOBODY = {socket.AF_INET: "192.0.2.1", socket.AF_INET6: "2001:db8::1"}
"""Addresses that documents may use and no machine has."""


@dataclass(frozen=True)
class HostAndPort:
    """Where something is served; `further` are names that tunnels and proxies lead here from."""

    host: str = "127.0.0.1"
    port: int = 8765
    further: tuple[str, ...] = ()

    @property
    def is_any(self) -> bool:
        """Say whether it is every address that this machine has."""
        with suppress(ValueError):  # a name
            return ip_address(self.host).is_unspecified
        return False

    @property
    def is_here_only(self) -> bool:
        """Say whether nobody comes from another machine."""
        return self.host in LOOPBACK and not self.further

    @property
    def names(self) -> frozenset[str] | None:
        """Return the names of the host that browsers may ask for; None if any."""
        if self.is_any:
            return None
        return frozenset(LOOPBACK if self.host in LOOPBACK else (self.host.lower(),))

    def to_open(self) -> list[str]:
        """Return what to open in a browser: here, and from elsewhere where that is known."""
        return [f"http://{_bracketed(host)}:{self.port}/" for host in self._hosts_to_open()]

    def _hosts_to_open(self) -> list[str]:
        if not self.is_any:
            return [self.host]
        own = _own_address(_family(self.host))
        return ["::1" if ":" in self.host else "127.0.0.1", *([own] if own else [])]


def address_of(text: str, further: tuple[str, ...] = ()) -> HostAndPort:
    """Return the address that a flag names: `8765`, or with another host `0.0.0.0:8765`."""
    host, _, port = text.rpartition(":")
    if not (port.isdecimal() and 1 <= int(port) <= 65535):
        raise TeamformerError(
            f"--port {text} is no port", "write a number from 1 to 65535, or HOST:NUMBER"
        )
    return HostAndPort(
        host.strip("[]") or HostAndPort.host, int(port), tuple(map(_name_of, further))
    )


def _name_of(text: str) -> str:
    """Return the name of a host as it is compared; raise `TeamformerError` for what is none."""
    name = text.strip("[]").lower()
    with suppress(ValueError):  # of a bracket that is not closed
        if urlsplit(f"//{_bracketed(name)}").hostname == name:
            return name
    raise TeamformerError(f"--host {text} is no name of a host", "leave out http:// and the port")


def check_address(at: HostAndPort, flag: str = "--port") -> None:
    """Raise `TeamformerError` if the port is not free, and suggest one that is for its flag."""
    host, port = at.host, at.port
    with socket.socket(_family(host)) as probe:
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


def _own_address(family: socket.AddressFamily) -> str | None:
    """Return by what address this machine goes out, if it does; nothing is sent."""
    with suppress(OSError), socket.socket(family, socket.SOCK_DGRAM) as probe:
        probe.connect((NOBODY[family], 9))
        return str(probe.getsockname()[0])
    return None


def _family(host: str) -> socket.AddressFamily:
    return socket.AF_INET6 if ":" in host else socket.AF_INET


def _bracketed(host: str) -> str:
    return f"[{host}]" if ":" in host else host
