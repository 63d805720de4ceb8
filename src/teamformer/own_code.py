"""Code that a user wrote: what goes wrong in it is told by file and line."""

from __future__ import annotations

import sysconfig
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from teamformer.errors import TeamformerError

INSTALLED = (str(Path(__file__).parent), sysconfig.get_path("stdlib"))


@contextmanager
def telling_where(what: str) -> Iterator[None]:
    """Turn whatever a user's code raises into an error that says what, and in which line."""
    try:
        yield
    except TeamformerError:
        raise
    except Exception as error:
        raise TeamformerError(f"{what}{_place_of(error)}: {_spell(error)}") from error


def _place_of(error: Exception) -> str:
    """Return the file and line that raised, by the deepest frame outside of installed packages."""
    if isinstance(error, SyntaxError) and error.filename:
        return f" at {error.filename}:{error.lineno}"
    frames = traceback.extract_tb(error.__traceback__)[1:]  # without telling_where itself
    theirs = [frame for frame in frames if not _is_installed(frame.filename)]
    return f" at {theirs[-1].filename}:{theirs[-1].lineno}" if theirs else ""


def _is_installed(file: str) -> bool:
    return file.startswith(("<", *INSTALLED)) or "site-packages" in file


def _spell(error: Exception) -> str:
    return f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
