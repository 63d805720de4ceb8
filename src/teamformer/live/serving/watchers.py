"""Pages that watch a mission."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

News = Mapping[str, Any]
"""What a message says besides its kind, as JSON has it."""

NOTHING: News = MappingProxyType({})
MOST_WAITING = 500  # messages that a page may be behind before it is let go


class Watcher:
    """A page: what it has not been sent yet; closed when it is too far behind."""

    def __init__(self) -> None:
        self.outbox: asyncio.Queue[str | None] = asyncio.Queue()

    def tell(self, text: str) -> None:
        """Queue a message."""
        if self.outbox.qsize() < MOST_WAITING:
            self.outbox.put_nowait(text)
        elif self.outbox.qsize() == MOST_WAITING:
            self.let_go()

    def say(self, kind: str, news: News = NOTHING) -> None:
        """Queue a message of a kind."""
        self.tell(_message(kind, news))

    def let_go(self) -> None:
        """Have the line end once what is queued is sent; the page may come again."""
        self.outbox.put_nowait(None)


class Watchers(set[Watcher]):
    """The pages that watch one thing."""

    def come(self) -> Watcher:
        """Let a page watch, and return it."""
        watcher = Watcher()
        self.add(watcher)
        return watcher

    def tell_all(self, kind: str, news: News = NOTHING) -> None:
        """Queue the same message for every page."""
        text = _message(kind, news)
        for watcher in self:
            watcher.tell(text)


def _message(kind: str, news: News) -> str:
    return json.dumps({"kind": kind, **news}, separators=(",", ":"))
