"""Libraries that not everybody has installed: what to type to have them."""

from __future__ import annotations

import json
import os
import sys
from importlib.metadata import PackageNotFoundError, distribution
from importlib.util import find_spec
from pathlib import Path
from urllib.parse import unquote, urlparse

from teamformer.base.errors import TeamformerError


def how_to_install(*extras: str) -> str:
    """Return the command that installs this package, with extras, for the current folder.

    In a clone of the repository it is an editable install by the Python that runs. Elsewhere it
    names the folder or wheel that the package was installed from, because no index has it.
    """
    named = f"[{','.join(extras)}]" if extras else ""
    root = Path(__file__).resolve().parents[3]
    if not (root / "pyproject.toml").is_file():
        return f"pip install '{_installed_from()}{named}'"
    pip, here = Path(sys.executable).with_name("pip"), Path.cwd()
    shown = pip.relative_to(here) if pip.is_relative_to(here) else pip
    return f"{shown} install -e '{os.path.relpath(root)}{named}'"


def _installed_from() -> str:
    """Return the file or folder that pip installed the package from, else its name."""
    try:
        written = distribution("teamformer").read_text("direct_url.json")
    except PackageNotFoundError:
        written = None
    url = urlparse(json.loads(written)["url"] if written else "")
    return unquote(url.path) if url.scheme == "file" else "teamformer"


LIBRARIES = {"live": ("starlette", "uvicorn", "websockets"), "robotarium": ("daqp", "scipy")}
"""Of extras that are needed whole or not at all."""


def require(extra: str, *libraries: str) -> None:
    """Raise `TeamformerError` with what to install if a library of an extra is missing.

    An extra that is needed whole is asked for without naming its libraries.
    """
    for library in libraries or LIBRARIES[extra]:
        if find_spec(library) is None:
            raise missing(extra, library)


def missing(extra: str, library: str) -> TeamformerError:
    """Return the error for a library of an extra that is not installed."""
    what = f"this needs a library that is not installed: {library}"
    return TeamformerError(what, how_to_install(extra))
