"""Pages that watch a mission."""

from __future__ import annotations

import asyncio

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

    def let_go(self) -> None:
        """Have the line end once what is queued is sent; the page may come again."""
        self.outbox.put_nowait(None)
