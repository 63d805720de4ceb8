"""Files out: each is there whole or not at all, whatever happens while it is written."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any


def write_whole(path: Path, content: str | bytes) -> None:
    """Write a file, as `write_all` does."""
    write_all({path: content})


def write_all(contents: Mapping[Path, str | bytes]) -> None:
    """Write files; those that were there are replaced only when all are written.

    Text is written as UTF-8. Raises OSError with the name of the file that cannot be written,
    because the disk is full, say.
    """
    replaced: dict[Path, Path] = {}
    try:
        for path, content in contents.items():
            data = content.encode() if isinstance(content, str) else content
            target = path.resolve()  # the file itself, not a link to it
            with _naming(path):
                if target.exists() and not target.is_file():  # a pipe or a device
                    target.write_bytes(data)
                else:
                    replaced[target] = target.with_name(f"{target.name}.{os.getpid()}.part")
                    replaced[target].write_bytes(data)
        for target, part in replaced.items():
            with _naming(target):
                os.replace(part, target)
    finally:
        for part in replaced.values():
            part.unlink(missing_ok=True)


@contextmanager
def _naming(path: Path) -> Iterator[None]:
    """Have an error of the disk name the file that it is about."""
    try:
        yield
    except OSError as error:
        raise OSError(error.errno, error.strerror, str(path)) from None


def own_number(value: Any) -> Any:
    """Return a number of a library such as numpy as Python's own: `default` of `json.dumps`."""
    if hasattr(value, "item"):
        return value.item()
    raise TypeError(f"{type(value).__name__} is no number")
