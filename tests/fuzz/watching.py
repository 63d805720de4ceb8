"""Properties: how often they are tried, and what is kept of the examples that break one.

What `make fuzz` finds becomes a file whose first line is a command that shows it. Hypothesis makes
an example that fails smaller and smaller, and each smaller one takes the place of the one before.
What has been found is passed over from the next round on, so that other things are found.
"""

from __future__ import annotations

import hashlib
import os
import re
import time
import traceback
from collections import Counter
from collections.abc import Callable, Mapping
from functools import wraps
from pathlib import Path
from typing import Any

from hypothesis import given, settings
from hypothesis.errors import HypothesisException

from texts import text_of

FOLDER, KNOWN, UNTIL = "FUZZ_FOLDER", "FUZZ_KNOWN", "FUZZ_UNTIL"
"""Where findings are kept, those that were before, and when to end: `fuzz.py` sets them."""

RUNNING = "running.yaml"
"""The example that is being tried: all that is left of one that ends the process."""

ROUND = 8
"""So many times the everyday examples are tried in a round of `make fuzz`."""

tried: Counter[str] = Counter()
"""Examples, by property."""

noted: dict[str, Any] = {}
"""What a property has drawn besides its arguments, for the file that is kept of it."""


def is_everyday() -> bool:
    """Say whether the same few examples are tried as every day."""
    return settings.get_current_profile_name() == "everyday"


def fuzzed(
    examples: int, command: str, **drawn: Any
) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Make a function a property of what is drawn, tried with so many examples every day.

    `command` shows a person what happens to an example; what stands in braces is filled in.
    """
    times = 1 if is_everyday() else ROUND

    def decorate(test: Callable[..., None]) -> Callable[..., None]:
        return settings(max_examples=examples * times)(given(**drawn)(_watched(test, command)))

    return decorate


def _watched(test: Callable[..., None], command: str) -> Callable[..., None]:
    @wraps(test)
    def watched(*fixtures: Any, **example: Any) -> None:
        if time.time() > float(os.environ.get(UNTIL, "inf")):
            return
        tried[test.__name__] += 1
        noted.clear()
        folder = os.environ.get(FOLDER)
        if folder:
            _keep(Path(folder, RUNNING), _file_of(example, command, "it ends the process"))
        try:
            test(*fixtures, **example)
        except HypothesisException:
            raise
        except Exception as error:
            text = _file_of(example, command, _first_line(error))
            if folder is None:
                error.add_note(text)
                raise
            name = f"{test.__name__.removeprefix('test_')}-{_kind(error)}.yaml"
            if name not in os.environ.get(KNOWN, "").split():
                _keep(Path(folder, name), text)
                raise
        finally:
            if folder:  # what comes next need not be an example, and may take long
                Path(folder, RUNNING).unlink(missing_ok=True)

    return watched


def _file_of(example: Mapping[str, Any], command: str, what: str) -> str:
    """Return a mission as a file; what is to be done with it stands above."""
    missions = example.get("mission", {})
    others = {key: value for key, value in example.items() if key not in ("mission", "data")}
    words = command.format(**others)
    heads = [
        f"teamformer {words}: {what}",
        *(f"{key} = {value!r}" for key, value in (others | noted).items()),
    ]
    parts = [_text_of(one) for one in (missions if isinstance(missions, list) else [missions])]
    return "".join(f"# {head}\n".replace("\r", " ") for head in heads) + "---\n".join(parts)


def _keep(path: Path, text: str) -> None:
    path.write_text(text, encoding="utf-8", errors="backslashreplace")


def _text_of(tree: Any) -> str:
    try:
        return text_of(tree)
    except Exception:  # an edit may be what no file can hold
        return f"# {tree!r}\n"


def _first_line(error: Exception) -> str:
    return f"{type(error).__name__}: {str(error).strip() or 'no message'}".splitlines()[0][:300]


def _kind(error: Exception) -> str:
    """Return a short name for what went wrong: where it did, without numbers and names."""
    said = re.sub(r"'[^']*'|\"[^\"]*\"|\[[^]]*\]|\{[^}]*\}|[\d.]+", "", _first_line(error))
    frames = traceback.extract_tb(error.__traceback__)
    ours = [frame.name for frame in frames if "teamformer" in frame.filename]
    return hashlib.sha256(f"{said} {ours[-1:]}".encode()).hexdigest()[:8]
