"""Work beside the conversation: what takes long goes on while pages are heard, and can be ended."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Awaitable, Callable, Coroutine, Hashable
from typing import TypeVar

from teamformer.live.serving.watchers import Watcher

MOST_UNDER_WAY = 100
"""What a page may have asked for that is not done yet; it is heard again once some of it is."""

T = TypeVar("T")


class Errands:
    """Work that goes on beside the conversation, each with a key; a new one ends the one before."""

    def __init__(self) -> None:
        self._tasks: dict[Hashable, asyncio.Task[None]] = {}

    def begin(self, key: Hashable, work: Coroutine[None, None, None]) -> None:
        """Begin some work; what goes on under the same key ends."""
        self.end(key)
        task = self._tasks[key] = asyncio.create_task(work)
        task.add_done_callback(lambda _: self._forget(key, task))

    def is_under_way(self, key: Hashable) -> bool:
        """Say whether the work of a key goes on."""
        return key in self._tasks

    def end(self, key: Hashable) -> bool:
        """End the work of a key; say whether there was any."""
        task = self._tasks.pop(key, None)
        return task is not None and task.cancel()

    def close(self) -> None:
        """End all work."""
        for key in list(self._tasks):
            self.end(key)

    def _forget(self, key: Hashable, task: asyncio.Task[None]) -> None:
        if self._tasks.get(key) is task:
            del self._tasks[key]


async def apart(work: Callable[[Callable[[], bool]], T]) -> T:
    """Do work in a thread; it is given what says that nobody wants its result any more."""
    is_over = threading.Event()
    try:
        return await asyncio.to_thread(work, is_over.is_set)
    finally:
        is_over.set()


class Conversation:
    """What one page asks for: begun at once, in the order in which it is asked.

    So a page is heard, and its line stays open, while something that it asked for takes long.
    """

    def __init__(self, act: Callable[[Watcher, str], Awaitable[None]], watcher: Watcher) -> None:
        self._act, self._watcher = act, watcher
        self._under_way: set[asyncio.Task[None]] = set()

    async def hear(self, text: str) -> None:
        """Begin what a page asks for; wait only if it has asked for too much."""
        if len(self._under_way) >= MOST_UNDER_WAY:
            await asyncio.wait(self._under_way, return_when=asyncio.FIRST_COMPLETED)
        task = asyncio.create_task(self._do(text))
        self._under_way.add(task)
        task.add_done_callback(self._under_way.discard)

    async def _do(self, text: str) -> None:
        """Do what is asked; a page whose message brings about a fault of ours is let go."""
        try:
            await self._act(self._watcher, text)
        except Exception:
            self._watcher.let_go()
