"""The command line as a whole: which verbs there are, and how many flags one has to know."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
import typer

from teamformer.cli.app import app

VERBS = (
    *("run", "compare", "generate", "import", "plan", "advise", "schema", "mcp", "live"),
    *("methods", "bench", "train", "check", "view", "learn", "export"),
    *("fleet start", "fleet add", "fleet cancel", "fleet agent", "fleet rehearse", "fleet watch"),
    *("robotarium fly", "robotarium deploy"),
)
MOST_FLAGS = 89


def verbs_of(command: Any, name: str = "") -> Iterator[tuple[str, Any]]:
    """Yield every verb with the words that call it."""
    for word, inner in getattr(command, "commands", {}).items():
        yield from verbs_of(inner, f"{name} {word}")
    if not hasattr(command, "commands"):
        yield name.strip(), command


def flags_of(verb: Any) -> list[str]:
    """Return the flags of a verb; hidden ones count too."""
    flags = [param.opts[-1] for param in verb.params if param.param_type_name == "option"]
    return [flag for flag in flags if flag != "--help"]


def test_these_are_the_verbs() -> None:
    assert {name for name, _ in verbs_of(typer.main.get_command(app))} == set(VERBS)


def test_there_are_no_more_flags_than_one_can_know() -> None:
    count = sum(len(flags_of(verb)) for _, verb in verbs_of(typer.main.get_command(app)))
    assert 60 < count <= MOST_FLAGS  # so that it cannot pass by counting nothing


@pytest.mark.parametrize("name", VERBS)
def test_what_others_scripts_rely_on_is_there(name: str) -> None:
    relied_on = {
        "generate": "--robots --tasks --capabilities --requirements --grid --seed --out",
        "run": "--method --seed --json --out",
        "compare": "--methods --seeds --json",
        "plan": "--time-limit --json",
        "check": "--mission --json",
        "advise": "--json",
        "fleet start": "--json",
        "fleet rehearse": "--seed --schedule --schedules --json",
    }
    verb = dict(verbs_of(typer.main.get_command(app)))[name]
    assert set(relied_on.get(name, "").split()) <= set(flags_of(verb))
    assert verb.help
