"""How a page is told why something is not done."""

from __future__ import annotations

from collections.abc import Awaitable, Sequence

from teamformer.base.errors import TeamformerError
from teamformer.live.running.messages import TaskRefusedError
from teamformer.live.serving.watchers import News, Watcher


async def or_refuse(watcher: Watcher, work: Awaitable[None], is_weighed: bool = False) -> None:
    """Do what a page asks for, or tell it why not."""
    try:
        await work
    except TeamformerError as error:
        keys = error.keys if isinstance(error, TaskRefusedError) else ()
        watcher.say("refused", refusal(str(error), is_weighed, keys))


def refusal(text: str, is_weighed: bool = False, keys: Sequence[str] = ()) -> News:
    """Return what a message says of why not.

    `is_weighed` says that the page waits for no answer any more to what it wanted worked out.
    `keys` are the parts of a new task that are wrong.
    """
    return {"text": text, "keys": keys, "is_weighed": is_weighed}
