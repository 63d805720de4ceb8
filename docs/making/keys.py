"""Writes what the tables of keys and of kinds of events say into the reference, and the schemas.

`python docs/making/keys.py` after a change of `src/teamformer/mission/keys`, of the kinds in
`world/continuous/events.py`, or of `live/serving`.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import Path

from teamformer.files.schema import schema_text
from teamformer.live.serving.openapi import openapi_text
from teamformer.mission.keys.charging_keys import BATTERY_KEYS, CHARGER_KEYS
from teamformer.mission.keys.key import FIRST_VERSION, REQUIRED, Key
from teamformer.mission.keys.mission_keys import COST_KEYS, MISSION_KEYS
from teamformer.mission.keys.robot_keys import ROBOT_KEYS
from teamformer.mission.keys.task_keys import TASK_KEYS
from teamformer.mission.keys.world_keys import PLANE_KEYS
from teamformer.mission.keys.zone_keys import ZONE_KEYS
from teamformer.world.continuous.events import KINDS

ROOT = Path(__file__).parents[2]
REFERENCE = ROOT / "docs" / "reference"
PAGES = [
    *(REFERENCE / name for name in ("mission.md", "record-in-time.md")),
    *sorted(REFERENCE.glob("mission/*.md")),
]
SCHEMA = ROOT / "mission.schema.json"
OPENAPI = ROOT / "live.openapi.json"


def rows(keys: Sequence[Key], before: str = "") -> Iterator[str]:
    """Yield a row for each key: what it means, and what holds if it is left out."""
    for key in keys:
        without = REQUIRED if key.is_required else key.without or said(key.default)
        since = "" if key.since == FIRST_VERSION else f" (since {key.since})"
        yield f"| `{before}{key.name}` | {key.means}{since} | {without} |"


def said(default: object) -> str:
    """Return a default as the page shows it."""
    return f"`{default}`" if isinstance(default, str) else f"{default:g}"


def tables() -> dict[str, list[str]]:
    """Return the lines of each table, by the name between its markers."""
    head = ["| key | means | if left out |", "|---|---|---|"]
    cost = [f"| `{key.name}` | {key.means} |" for key in COST_KEYS]
    return {
        "mission": [*head, *rows(MISSION_KEYS)],
        "robots": [*head, *rows(ROBOT_KEYS)],
        "tasks": [*head, *rows(TASK_KEYS)],
        "batteries": [*head, *rows(BATTERY_KEYS, "battery."), *rows(CHARGER_KEYS, "chargers.")],
        "zones": [*head, *rows(ZONE_KEYS)],
        "planes": [*head, *rows(PLANE_KEYS, "world.")],
        "events": ["| kind | its fields | says |", "|---|---|---|", *kinds_of_events()],
        "cost": ["| key | what it measures |", "|---|---|", *cost],
    }


def kinds_of_events() -> Iterator[str]:
    """Yield a row for each kind of event in a record in continuous time."""
    for name, kind in KINDS.items():
        fields = (f"`{it}`" + ("?" if it in kind.may_lack else "") for it in kind.fields)
        yield f"| `{name}` | {', '.join(fields)} | {kind.says} |"


def page(text: str) -> str:
    """Return the text of a page with its tables as the keys have them now."""
    for name, lines in tables().items():
        begin, end = f"<!-- keys: {name} -->", "<!-- end of keys -->"
        table = "\n".join([begin, "", *lines, "", end])
        text = re.sub(f"{begin}.*?{end}", lambda _, table=table: table, text, flags=re.DOTALL)
    return text


if __name__ == "__main__":
    for path in PAGES:
        path.write_text(page(path.read_text(encoding="utf-8")), encoding="utf-8")
    SCHEMA.write_text(schema_text(), encoding="utf-8")
    OPENAPI.write_text(openapi_text(), encoding="utf-8")
