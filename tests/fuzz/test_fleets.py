"""Fleets of agents keep every promise, whatever befalls network and robots."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from hypothesis import strategies as st

from clock_missions import draw_mission
from missions import continuous_missions, missions
from schedules import schedules
from teamformer.files.mission_files import mission_from_tree, mission_to_tree
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.rehearsal.checking.trace import Trace
from teamformer.fleet.rehearsal.records.of_rehearsal import record_of
from teamformer.fleet.rehearsal.rehearse import play, set_stage
from teamformer.mission.checks.rules import rules_of_rehearsals
from teamformer.record.files.reading import read_record
from teamformer.record.files.writing import save_record
from teamformer.record.referee import judge as judge_record
from watching import fuzzed, noted

NO_FLEETS = {"robots": ("battery",), "tasks": ("starts",)}
"""Keys of robots and tasks that fleets refuse; others are a mission's `chargers` and `zones`."""


def for_fleets(tree: Any) -> Any:
    """Return a mission in continuous time without what fleets refuse."""
    tree = {key: value for key, value in tree.items() if key not in ("chargers", "zones")}
    for part, keys in NO_FLEETS.items():
        tree[part] = [{k: v for k, v in it.items() if k not in keys} for it in tree[part]]
    return tree


IN_TIME = st.integers(0, 10**6).map(lambda seed: mission_to_tree(draw_mission(seed)))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("rehearsals")


@fuzzed(
    8,
    "fleet rehearse FILE, with the faults below",
    mission=missions(is_for_fleets=True),
    data=st.data(),
)
def test_every_promise_is_kept(mission: Any, data: st.DataObject, folder: Path) -> None:
    keep(mission, data, folder)


@fuzzed(
    8,
    "fleet rehearse FILE, with the faults below",
    mission=st.one_of(continuous_missions(), IN_TIME).map(for_fleets),
    data=st.data(),
)
def test_every_promise_is_kept_in_continuous_time(
    mission: Any, data: st.DataObject, folder: Path
) -> None:
    keep(mission, data, folder)


def keep(mission: Any, data: st.DataObject, folder: Path) -> None:
    """Rehearse a mission twice alike; what was promised is kept, and its record is legal."""
    source = mission_from_tree(mission)
    if any(rules_of_rehearsals(source)):
        return  # loads that fly
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
