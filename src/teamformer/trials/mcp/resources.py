"""What programs may read before they draw up a mission: the schema, examples, the pages on it."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

from teamformer.files.schema import schema_text
from teamformer.methods.listings import method_listings

SHIPPED = "shipped"
"""The folder of the installed package with examples and pages; in a clone it is the root."""

PAGES = ("docs/reference/mission.md", "docs/reference/mission")
"""The page on the mission file, and the folder of those on its parts."""
EXAMPLES = "examples"


def _root() -> Path:
    shipped = Path(str(files("teamformer"))) / SHIPPED
    return shipped if shipped.is_dir() else Path(__file__).resolve().parents[4]


def schema() -> str:
    """Return the JSON Schema of the mission file."""
    return schema_text()


def mission_pages() -> str:
    """Return the pages on the mission file: every key, what it means, what holds without it."""
    page, folder = (_root() / path for path in PAGES)
    return "\n".join(path.read_text(encoding="utf-8") for path in (page, *sorted(folder.iterdir())))


def methods() -> str:
    """Return the methods that a mission can be run by, a line each."""
    return "".join(f"{one.name}: {one.summary}\n" for one in method_listings())


def example_names() -> list[str]:
    """Return the names of the examples."""
    return sorted(path.stem for path in (_root() / EXAMPLES).glob("*.yaml"))


def example(name: str) -> str:
    """Return the text of an example that there is."""
    return (_root() / EXAMPLES / f"{name}.yaml").read_text(encoding="utf-8")
