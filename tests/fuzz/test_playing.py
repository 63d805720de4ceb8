"""Missions in steps are played to their end, legally, and the same way again."""

from __future__ import annotations

from typing import Any

import numpy as np
from hypothesis import strategies as st

from methods import METHODS, play
from missions import SEEDS, missions, optional_missions
from random_worlds import random_world, with_batteries
from teamformer.base.errors import MissionError
from teamformer.files.mission_files import mission_from_tree
from teamformer.mission.truth import draw_truth
from teamformer.planning.bounds.makespan import lower_bound
from teamformer.record.critical_path.words import why_so_late
from teamformer.record.referee import judge
from teamformer.record.telling.whole import path_of_record
from watching import fuzzed

RUN = "run FILE --method {method} --seed {seed}"


@fuzzed(45, RUN, mission=missions(), method=METHODS, seed=SEEDS)
def test_a_record_is_legal(mission: Any, method: str, seed: int) -> None:
    source = mission_from_tree(mission)
    record = play(source, method, seed).record
    findings = judge(record).findings
    assert not findings, findings[0].message
    assert record.end.illegal_decisions == 0


@fuzzed(25, RUN, mission=missions(), method=METHODS, seed=SEEDS)
def test_nothing_is_faster_than_its_bound(mission: Any, method: str, seed: int) -> None:
    source = mission_from_tree(mission)
    end = play(source, method, seed).record.end
    bound = lower_bound(draw_truth(source, seed))
    if end.makespan is not None:
        assert bound is not None
        assert bound <= end.makespan


@fuzzed(25, RUN, mission=missions(), method=METHODS, seed=SEEDS)
def test_the_critical_path_adds_up(mission: Any, method: str, seed: int) -> None:
    record = play(mission_from_tree(mission), method, seed).record
    path = path_of_record(record)
    if record.end.makespan is None or not record.steps[-1].done:  # the last task was called off
        assert path == ()
        return
    ends = [stretch.end for stretch in path]
    assert [stretch.begin for stretch in path] == [0, *ends[:-1]]
    assert ends[-1] == record.end.makespan
    assert len(why_so_late(record.true_mission, path)) > 1


@fuzzed(45, RUN, number=st.integers(0, 10_000), method=METHODS, seed=SEEDS)
def test_a_mission_with_batteries_is_legal(number: int, method: str, seed: int) -> None:
    rng = np.random.default_rng(number)
    try:
        source = with_batteries(random_world(rng, is_plane=number % 3 == 0), rng)
    except MissionError:  # a part of the map has no charger
        return
    record = play(source, method, seed).record
    findings = judge(record).findings
    assert not findings, findings[0].message
    ends = [stretch.end for stretch in path_of_record(record)]
    assert record.end.makespan is None or not ends or ends[-1] == record.end.makespan


@fuzzed(45, RUN, mission=optional_missions(is_in_steps=True), method=METHODS, seed=SEEDS)
def test_a_mission_that_is_over_at_a_step_is_legal(mission: Any, method: str, seed: int) -> None:
    source = mission_from_tree(mission)
    record = play(source, method, seed).record
    findings = judge(record).findings
    assert not findings, findings[0].message
    assert source.until is not None
    assert record.end.steps <= source.until
    ends = [stretch.end for stretch in path_of_record(record)]
    assert record.end.makespan is None or not ends or ends[-1] == record.end.makespan
    if record.end.makespan is not None:
        assert lower_bound(draw_truth(source, seed)) <= record.end.makespan
