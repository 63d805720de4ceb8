"""Who is let in to a live mission, and how long a connection may take to say what it wants."""

from __future__ import annotations

import asyncio
import hmac
from dataclasses import dataclass
from urllib.parse import urlsplit

from starlette.datastructures import MutableHeaders
from starlette.requests import HTTPConnection
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from uvicorn.protocols.http.h11_impl import H11Protocol

REQUEST_LIMIT = 10.0
"""Seconds within which a request's headers must have come, else its connection is closed."""

KEPT_APART = {
    "Content-Security-Policy": "frame-ancestors 'none'",
    "X-Frame-Options": "DENY",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",  # the address holds the token
}
"""Headers of every answer: no other page may frame it, guess its type or learn its address."""


@dataclass(frozen=True)
class Doors:
    """Who is let in: by the names of hosts, and by the token if one is needed.

    `hosts` are the names that the server may be asked for under; None is any name, and then the
    token decides. `further` names are those of tunnels and proxies, whose pages are its own.
    """

    hosts: frozenset[str] | None
    token: str | None = None
    further: frozenset[str] = frozenset()

    def refusal(self, connection: HTTPConnection) -> str | None:
        """Return why a request is refused, or None."""
        host = connection.headers.get("host", "").lower()
        origin = connection.headers.get("origin", f"http://{host}").lower()
        if self.hosts is not None and _name(f"//{host}") not in self.hosts | self.further:
            return f"this server does not answer to '{host}'; if it is yours, add it with --host"
        is_own = origin in (f"http://{host}", f"https://{host}")
        if not is_own and _name(origin) not in self.further:
            return f"pages of {origin} may not control this mission; if it is yours, add --host"
        given = connection.query_params.get("token", "")
        if self.token is not None and not hmac.compare_digest(given.encode(), self.token.encode()):
            return "the token is missing or wrong; use the address that was printed"
        return None


def _name(address: str) -> str | None:
    """Return the name of the host in an address, without its port; None if there is none."""
    try:
        return urlsplit(address).hostname
    except ValueError:  # a bracket that is not closed
        return None


class KeepApart:
    """Adds to each answer of an application that no other page may make use of it."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer as the application does, with these headers."""

        async def send_apart(message: Message) -> None:
            if message["type"] == "http.response.start":
                MutableHeaders(scope=message).update(KEPT_APART)
            await send(message)

        await self._app(scope, receive, send_apart)


class PromptRequests(H11Protocol):
    """Closes a connection whose next request takes too long to come."""

    limit = REQUEST_LIMIT
    _waiting: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Wait for a first request."""
        super().connection_made(transport)
        self._wait()

    def on_response_complete(self) -> None:
        """Wait for another request."""
        self._wait()
        super().on_response_complete()

    def connection_lost(self, exc: Exception | None) -> None:
        """Wait no more."""
        self._stop_waiting()
        super().connection_lost(exc)

    def _wait(self) -> None:
        self._stop_waiting()
        self._waiting = self.loop.call_later(self.limit, self._close_if_idle)

    def _stop_waiting(self) -> None:
        if self._waiting is not None:
            self._waiting.cancel()

    def _close_if_idle(self) -> None:
        is_answering = self.cycle is not None and not self.cycle.response_complete
        if not is_answering and self.transport.get_protocol() is self:  # else a socket has it now
            self.transport.close()
