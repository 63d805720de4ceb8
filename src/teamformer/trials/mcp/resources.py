"""What programs may read before they draw up a mission: the schema, examples, the page on it."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

from teamformer.files.schema import schema_text
from teamformer.methods.listings import method_listings

SHIPPED = "shipped"
"""The folder of the installed package with the examples and the page; in a clone it is the root."""

PAGE = "docs/reference/mission.md"
EXAMPLES = "examples"


def _root() -> Path:
    shipped = Path(str(files("teamformer"))) / SHIPPED
    return shipped if shipped.is_dir() else Path(__file__).resolve().parents[4]


def schema() -> str:
    """Return the JSON Schema of the mission file."""
    return schema_text()


def mission_page() -> str:
    """Return the page on the mission file: every key, what it means, what holds without it."""
    return (_root() / PAGE).read_text(encoding="utf-8")


def methods() -> str:
    """Return the methods that a mission can be run by, a line each."""
    return "".join(f"{one.name}: {one.summary}\n" for one in method_listings())


def example_names() -> list[str]:
    """Return the names of the examples."""
    return sorted(path.stem for path in (_root() / EXAMPLES).glob("*.yaml"))


def example(name: str) -> str:
    """Return the text of an example that there is."""
    return (_root() / EXAMPLES / f"{name}.yaml").read_text(encoding="utf-8")
