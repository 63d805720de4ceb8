"""What docs/reference/mission.md tells about the file format is what the reader knows."""

from __future__ import annotations

import re
import runpy
from pathlib import Path

from test_broken_files import CASES, GOOD, problems_of

from teamformer.files.mission_files import read_mission
from teamformer.mission.model import Breakdown
from teamformer.mission.parts.roads import Roads

DOCS = Path(__file__).parents[2] / "docs" / "reference" / "mission.md"
MAKING = Path(__file__).parents[2] / "docs" / "making" / "keys.py"


def test_the_tables_of_keys_are_as_the_keys_are_now() -> None:
    making = runpy.run_path(str(MAKING))
    for page in making["PAGES"]:
        assert page.read_text() == making["page"](page.read_text())
    assert making["SCHEMA"].read_text() == making["schema_text"]()
    rows = re.findall(
        r"^\| `([\w.\[\]]+)` \| .* \| must be there \|$", DOCS.read_text(), re.MULTILINE
    )
    wanted = ["teamformer", "world", "capabilities", "robots", "robots[].at", "robots[].can"]
    assert rows == [*wanted, "tasks", "tasks[].at", "tasks[].needs", "world.plane"]


def test_the_example_is_read(tmp_path: Path) -> None:
    examples = re.findall(r"```yaml\n(.*?)```", DOCS.read_text(), re.DOTALL)
    text, loads, heavy, other, roads, uncertain, survey = examples
    path = tmp_path / "example.yaml"
    path.write_text(text)
    mission = read_mission(path)
    assert mission.teams == ((1, 2),)
    assert mission.tasks[1].needs == {"lift": 2, "weld": 1}
    path.write_text(loads)
    grand = read_mission(path).tasks[0]
    assert (grand.to, grand.duration, grand.unload) == ((10, 1), 3, 2)
    path.write_text(heavy)
    piano = read_mission(path)
    assert piano.units == {"lift": 250, "steer": 1000}
    assert piano.in_units(piano.tasks[0].needs) == {"lift": 1231, "steer": 1}
    path.write_text(other)
    errands = read_mission(path)
    assert [robot.name for robot in errands.robots] == ["cart-1", "cart-2", "cart-3", "eye"]
    assert errands.tasks[2].between == (10, 40)
    [table] = re.findall(r"```\n(from, depot.*?)```", DOCS.read_text(), re.DOTALL)
    (tmp_path / "clinic.csv").write_text(table)
    (tmp_path / "clinic-air.csv").write_text(table.replace("7", "1"))
    path.write_text(roads)
    clinic = read_mission(path)
    assert isinstance(clinic.world, Roads)
    assert clinic.world.times["ground"][0] == (0, 4, 7.5)
    assert clinic.world.times["air"][2] == (1, 3, 0)
    assert [clinic.world.name_of(task.at) for task in clinic.tasks] == ["lab", "ward"]
    path.write_text(uncertain)
    storm = read_mission(path)
    assert storm.tasks[0].lasts == (2, 9)
    assert storm.tasks[1].may_need == {"weld": 0.4, "power": 0.2}
    assert storm.tasks[1].within == 3
    assert storm.robots[2].breaks == Breakdown(0.004, (10, 40))
    path.write_text(survey)
    assert [robot.flies for robot in read_mission(path).robots] == [True, False]


def test_what_is_refused_is_told_in_these_words(tmp_path: Path) -> None:
    table = DOCS.read_text().split("| told |\n|---|---|---|\n")[1].split("\n\n")[0]
    documented = [row.rsplit(" | ", 1)[1].strip("` |") for row in table.splitlines()]
    assert len(documented) >= 40
    files = [GOOD.replace(old, new, 1) for old, new, *_ in CASES] + [""]
    told = {
        line.split(": ", 1)[1].removeprefix(f"{tmp_path}/")
        for text in files
        for line in problems_of(tmp_path, text)
    }
    assert [message for message in documented if message not in told] == []
