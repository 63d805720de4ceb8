"""The coordinator that the documents show, in every verb, and what is said of faults."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from teamformer.base.errors import TeamformerError
from teamformer.files.drawn.named_settings import world_of
from teamformer.files.mission_files import read_mission
from teamformer.live.running.incidents import LostRobot, NewTask
from teamformer.live.steps.mission_with_past import RunningMission
from teamformer.methods.by_name import load_method
from teamformer.mission.model import Task
from teamformer.record.referee import judge
from teamformer.trials.trial import run_trial
from typed import teamformer

ROOT = Path(__file__).parents[2]
WAREHOUSE = ROOT / "examples" / "warehouse.yaml"


@pytest.fixture(autouse=True)
def own_module(own_folder: Path) -> None:
    """The class of the documents in a folder that the user works in."""
    page = (ROOT / "docs" / "reference" / "coordinators.md").read_text(encoding="utf-8")
    code = page.split('```python title="mine.py"\n')[1].split("```")[0]
    assert len(code.splitlines()) <= 45
    (own_folder / "mine_of_docs.py").write_text(code, encoding="utf-8")
    (own_folder / "faulty_plans.py").write_text(FAULTY, encoding="utf-8")


NAME = "mine_of_docs:Soonest"

FAULTY = """
class Silent:
    def update(self, known, plan):
        pass


class Hasty:
    def update(self, known, plan):
        return known.mission.robots[99]
"""


def rows_of(capsys: pytest.CaptureFixture[str], *words: str) -> list[dict[str, object]]:
    assert teamformer(*words, "--json") == 0
    return [json.loads(line) for line in capsys.readouterr().out.splitlines()]


@pytest.mark.thorough
def test_run_compare_and_a_fleet_take_it(capsys: pytest.CaptureFixture[str]) -> None:
    mission = str(WAREHOUSE)
    [row] = rows_of(capsys, "run", mission, "--method", NAME)
    assert (row["method"], row["status"], row["tasks_done"]) == (NAME, "completed", 14)
    rows = rows_of(capsys, "compare", mission, "--methods", f"{NAME},crews")
    assert [row["makespan"] for row in rows if row["method"] == NAME] == [row["makespan"]]
    [fleet] = rows_of(capsys, "fleet", "rehearse", mission, "--method", NAME, "--schedules", "2")
    assert (fleet["blocked"], fleet["violations"]) == (0, [])
    [by_plan] = rows_of(capsys, "fleet", "rehearse", mission, "--schedules", "2")
    assert fleet["undisturbed"] != by_plan["undisturbed"]  # it is its plan that they go by


def test_a_live_mission_goes_by_it_and_leaves_a_legal_record() -> None:
    run = RunningMission(read_mission(WAREHOUSE), lambda: load_method(NAME), seed=0)
    for step in range(500):
        if not run.is_running:
            break
        if step == 4:
            run.happen(NewTask(Task("extra", (1, 1), {"scan": 1})))
        if step == 9:
            run.happen(LostRobot(run.source.robots[1].name))
        run.step()
    record = run.record()
    assert judge(record).findings == ()
    assert record.method == NAME
    assert [made for made, _ in record.plans][:1] == [0]
    assert {why for _, plan in record.plans for why in plan.reasons} >= {
        "start",
        "task appeared",
        "robot lost",
    }


@pytest.mark.parametrize(
    "setting", ["4N9T-C4", "sparse", "real", "warehouse-lost", "sparse-needs", "real-places"]
)
def test_it_ends_what_families_of_missions_bring(setting: str) -> None:
    record = run_trial(world_of(setting, 0), load_method(NAME)).record
    assert record.end.status == "completed"
    assert judge(record).findings == ()


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("Silent", r"update\(\) returned NoneType, not a Plan"),
        ("Hasty", r"failed at \S*faulty_plans.py:9: IndexError"),
    ],
)
def test_its_faults_are_told(name: str, message: str) -> None:
    method = load_method(f"faulty_plans:{name}")
    with pytest.raises(TeamformerError, match=message):
        run_trial(world_of("4N4T-C4", 0), method)
