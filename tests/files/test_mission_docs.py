"""What the pages on the mission file tell about the format is what the reader knows."""

from __future__ import annotations

import re
import runpy
from pathlib import Path

from test_broken_files import CASES, GOOD, problems_of

from teamformer.files.mission_files import read_mission
from teamformer.mission.model import Breakdown, Mission
from teamformer.mission.parts.charging import Battery, Charger
from teamformer.mission.parts.roads import Roads

DOCS = Path(__file__).parents[2] / "docs"
PAGE = DOCS / "reference" / "mission.md"
PARTS = DOCS / "reference" / "mission"


def test_the_tables_of_keys_are_as_the_keys_are_now() -> None:
    making = runpy.run_path(str(DOCS / "making" / "keys.py"))
    assert making["PAGES"] == [
        PAGE,
        DOCS / "reference" / "record-in-time.md",
        *sorted(PARTS.iterdir()),
    ]
    text = "".join(page.read_text() for page in making["PAGES"])
    assert text == "".join(making["page"](page.read_text()) for page in making["PAGES"])
    assert making["SCHEMA"].read_text() == making["schema_text"]()
    wanted = re.findall(r"^\| `([\w.]+)` \| .* \| must be there \|$", text, re.MULTILINE)
    robots, tasks = ["at", "can"], ["at", "needs"]
    mission = ["teamformer", "world", "capabilities", "robots", "tasks"]
    charging = ["battery.lasts", "battery.fills", "chargers.at"]
    assert wanted == [*mission, *robots, *tasks, *charging, "world.plane"]


def examples_of(page: Path, folder: Path) -> list[Mission]:
    """Return the missions that a page shows, each read from a file."""
    texts = re.findall(r"```yaml\n(.*?)```", page.read_text(), re.DOTALL)
    files = [folder / f"{number}.yaml" for number in range(len(texts))]
    for file, text in zip(files, texts, strict=True):
        file.write_text(text)
    return [read_mission(file) for file in files]


def test_the_examples_are_read(tmp_path: Path) -> None:
    [shift] = examples_of(PAGE, tmp_path)
    assert shift.teams == ((1, 2),)
    assert shift.tasks[1].needs == {"lift": 2, "weld": 1}
    loads, heavy = examples_of(PARTS / "tasks.md", tmp_path)
    grand = loads.tasks[0]
    assert (grand.to, grand.duration, grand.unload) == ((10, 1), 3, 2)
    assert heavy.units == {"lift": 250, "steer": 1000}
    assert heavy.in_units(heavy.tasks[0].needs) == {"lift": 1231, "steer": 1}
    [errands] = examples_of(PARTS / "time.md", tmp_path)
    assert [robot.name for robot in errands.robots] == ["cart-1", "cart-2", "cart-3", "eye"]
    assert errands.tasks[2].between == (10, 40)
    [lifts] = examples_of(PARTS / "charging.md", tmp_path)
    assert lifts.robots[1].battery == Battery(60, 20, 0.5, 0.2)
    assert lifts.chargers == (Charger((20, 20), 2),)
    [dock] = examples_of(PARTS / "zones.md", tmp_path)
    assert [zone.tasks_in(dock.tasks) for zone in dock.zones] == [[0, 1], [2]]
    [storm] = examples_of(PARTS / "unknown.md", tmp_path)
    assert storm.tasks[0].lasts == (2, 9)
    assert storm.tasks[1].may_need == {"weld": 0.4, "power": 0.2}
    assert storm.tasks[1].within == 3
    assert storm.robots[2].breaks == Breakdown(0.004, (10, 40))


def test_the_examples_of_worlds_are_read(tmp_path: Path) -> None:
    page = PARTS / "world.md"
    [table] = re.findall(r"```\n(from, depot.*?)```", page.read_text(), re.DOTALL)
    (tmp_path / "clinic.csv").write_text(table)
    (tmp_path / "clinic-air.csv").write_text(table.replace("7", "1"))
    clinic, wards, survey = examples_of(page, tmp_path)
    assert isinstance(clinic.world, Roads)
    assert clinic.world.times["ground"][0] == (0, 4, 7.5)
    assert clinic.world.times["air"][2] == (1, 3, 0)
    assert [clinic.world.name_of(task.at) for task in clinic.tasks] == ["lab", "ward"]
    assert isinstance(wards.world, Roads)
    assert wards.world.times["ground"] == ((0, 4), (5, 0))
    assert [robot.flies for robot in survey.robots] == [True, False]


def test_what_is_refused_is_told_in_these_words(tmp_path: Path) -> None:
    tables = (PARTS / "refused.md").read_text().split("| message |\n|---|---|---|\n")[1:]
    rows = [row for table in tables for row in table.split("\n\n")[0].splitlines()]
    documented = [row.rsplit(" | ", 1)[1].strip("` |") for row in rows]
    assert len(documented) >= 40
    files = [GOOD.replace(old, new, 1) for old, new, *_ in CASES] + [""]
    told = {
        line.split(": ", 1)[1].removeprefix(f"{tmp_path}/")
        for text in files
        for line in problems_of(tmp_path, text)
    }
    assert [message for message in documented if message not in told] == []
