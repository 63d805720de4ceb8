"""Code that a user wrote: where it is found, and what goes wrong in it, told by file and line."""

from __future__ import annotations

import importlib
import sys
import sysconfig
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from teamformer.base.errors import TeamformerError

OURS, STANDARD, PACKAGES = (
    str(Path(__file__).parents[1]),
    sysconfig.get_path("stdlib"),
    "site-packages",
)
"""Where code lies that no user wrote: this package, Python's own, and all that is installed."""


def look_here() -> None:
    """Have modules found in the folder that the user works in."""
    if str(Path.cwd()) not in sys.path:
        sys.path.append(str(Path.cwd()))


def load_own(where: str, what: str) -> Any:
    """Return the class that is named as `module:Class`; `what` says in errors what it is to be.

    The module may lie in the folder that the user works in. Raises `TeamformerError`.
    """
    module_name, _, class_name = where.partition(":")
    look_here()
    try:
        with telling_where(f"{what} '{where}' cannot be imported"):
            module = importlib.import_module(module_name)
    except TeamformerError as error:
        if isinstance(error.__cause__, ImportError):
            error.hint = "run from the folder that holds the module"
        raise
    if not hasattr(module, class_name):
        raise TeamformerError(f"module '{module_name}' has no class '{class_name}'")
    return getattr(module, class_name)


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
    """Return the file and line that raised: the deepest of the user's own, else of a package's."""
    if isinstance(error, SyntaxError) and error.filename:
        return f" at {error.filename}:{error.lineno}"
    frames = traceback.extract_tb(error.__traceback__)[1:]  # without telling_where itself
    others = [frame for frame in frames if not frame.filename.startswith(OURS)]
    theirs = [frame for frame in others if not _is_installed(frame.filename)]
    packaged = [frame for frame in others if PACKAGES in frame.filename]
    return "".join(f" at {at.filename}:{at.lineno}" for at in (theirs or packaged)[-1:])


def _is_installed(file: str) -> bool:
    return file.startswith(("<", STANDARD)) or PACKAGES in file


def _spell(error: Exception) -> str:
    return f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
