"""Fleets of agents keep every promise, whatever befalls network and robots."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from hypothesis import strategies as st

from missions import missions
from schedules import schedules
from teamformer.files.mission_files import mission_from_tree
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.rehearsal.records.of_rehearsal import record_of
from teamformer.fleet.rehearsal.rehearse import play, set_stage
from teamformer.fleet.rehearsal.trace import Trace
from teamformer.record.files.reading import read_record
from teamformer.record.files.writing import save_record
from teamformer.record.referee import judge as judge_record
from watching import fuzzed, noted


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("rehearsals")


@fuzzed(
    8,
    "rehearse FILE, with the faults below",
    mission=missions(is_for_fleets=True),
    data=st.data(),
)
def test_every_promise_is_kept(mission: Any, data: st.DataObject, folder: Path) -> None:
    source = mission_from_tree(mission)
    fleet = FleetMission(source, source.seconds_a_step)
    stage = set_stage(fleet)
    assert stage.undisturbed.status != "blocked"
    noted["faults"] = faults = data.draw(schedules(fleet))
    traces = []
    for _ in range(2):
        traces.append(Trace(with_messages=True))
        rehearsal, outcome, violations = play(fleet, stage.plan, faults, traces[-1])
        assert not violations, violations[0]
        assert outcome.status != "blocked", outcome.blocked_tasks
    assert traces[0].events == traces[1].events
    record = record_of(rehearsal, outcome, traces[1].events, faults.seed)
    save_record(record, folder / "record.json")
    read = read_record(folder / "record.json")
    assert read == record
    assert judge_record(read).findings == ()
