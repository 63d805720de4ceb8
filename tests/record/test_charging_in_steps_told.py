"""What is told of robots with batteries in missions in steps: who charges, who queues, how full."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from small_worlds import make, robot, task
from teamformer.files.mission_files import write_mission
from teamformer.methods.by_name import load_method
from teamformer.mission.parts.charging import Battery, Charger
from teamformer.record.critical_path.words import why_so_late
from teamformer.record.export.csv_tables import write_tables
from teamformer.record.happenings import events
from teamformer.record.record import Record
from teamformer.record.referee import judge
from teamformer.record.telling.whole import told_of
from teamformer.trials.trial import run_trial
from typed import teamformer


@pytest.fixture(scope="module")
def record() -> Record:
    """Two robots go from 0 and 5 to 9 by a charger at 3 that has room for one.

    Each has 6 of 15 and charges 3 a step.
    """
    robots = [robot("b", 0), robot("a", 5)]
    mission = make(robots, [task("ab", 9)])
    own = tuple(replace(one, battery=Battery(15, 5, 0.4)) for one in mission.robots)
    charged = replace(mission, robots=own, chargers=(Charger((3, 0)),), step_limit=0)
    return run_trial(charged, load_method("plan"), seed=0).record


def test_a_record_tells_who_charges_and_who_queues(record: Record) -> None:
    """The one from 5 is there after two steps with 4 and is full after four, in step 6."""
    said = {number: step.charge for number, step in enumerate(record.steps, 1) if step.charge}
    assert said == {
        3: ((1, "charging"),),
        4: ((0, "queueing"),),
        7: ((0, "charging"), (1, "")),
        11: ((0, ""),),
    }
    assert judge(record).findings == ()


def test_the_referee_sees_who_is_said_to_charge_too_soon(record: Record) -> None:
    steps = list(record.steps)
    steps[1] = replace(steps[1], charge=((0, "charging"),))
    finding = judge(replace(record, steps=tuple(steps))).findings[0]
    told = "the record says that robot r0 charges, but by the rules it is not so"
    assert finding.message == f"step 2: {told}"


def test_robots_are_told_to_charge_and_the_path_has_it(record: Record) -> None:
    told = told_of(record)
    done = [[(run.begun, run.phase) for run in row] for row in told.runs]
    assert done[0][:4] == [(0, "walking"), (3, "queueing"), (6, "charging"), (10, "walking")]
    assert done[1][:3] == [(0, "walking"), (2, "charging"), (6, "walking")]
    assert why_so_late(record.mission, told.path)[0] == (
        "why so late: 17 steps are 9 walking, 1 forming, 4 charging, 3 waiting for chargers"
    )


def test_it_is_told_how_full_batteries_are(record: Record, tmp_path: Path) -> None:
    """It comes to the charger with 3 of 15, is full after step 10, and walks six steps more."""
    levels = [(row.begun, row.full, row.rate) for row in told_of(record).levels[0]]
    expected = [(0, 6, -1), (3, 3, 0), (6, 3, 3), (10, 15, -1), (16, 9, 0)]
    assert levels == [pytest.approx((at, full / 15, rate / 15)) for at, full, rate in expected]
    write_tables(record, tmp_path)
    header, *rows = (tmp_path / "robots.csv").read_text().splitlines()
    column = header.split(",").index("charge_left")
    assert [row.split(",")[column] for row in rows] == ["0.6", "0.6"]


def test_who_runs_dry_is_said_to_in_the_words_of_continuous_time(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """It waits for the other from step 5 on, and has five left: dry in the sixth step, the 11th."""
    pair = make([robot("a", 0), robot("b", 19)], [task("ab", 5)])
    slow = replace(pair.robots[1], speed=0.1)
    own = replace(pair.robots[0], battery=Battery(15, 0, starts=10 / 15, waiting=1))
    mission = replace(pair, robots=(own, slow), chargers=(Charger((0, 0)),), step_limit=0)
    record = run_trial(mission, load_method("plan"), seed=0).record
    logged = [(entry.at, entry.text(mission)) for entry in events(record) if entry.robots]
    assert (11, "r0 has run dry") in logged
    write_tables(record, tmp_path)
    header, *rows = (tmp_path / "robots.csv").read_text().splitlines()
    column = header.split(",").index("lost_in_step")
    assert [row.split(",")[column] for row in rows] == ["11", ""]
    path = tmp_path / "dry.yaml"
    write_mission(mission, path)
    teamformer("run", str(path))
    assert "has run dry: r0 in step 11" in capsys.readouterr().out
