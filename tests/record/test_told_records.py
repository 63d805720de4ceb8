"""What is told of a record: by hand, step by step as whole, and only of the steps that it has."""

from __future__ import annotations

import copy
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from random_worlds import random_world, with_precedence_and_windows, with_surprises
from small_worlds import make, robot, task
from teamformer.files.drawn.named_settings import world_of
from teamformer.methods.by_name import load_method
from teamformer.mission.model import Absence
from teamformer.record.export.moments import moments
from teamformer.record.files.reading import record_from_tree
from teamformer.record.files.writing import record_to_tree
from teamformer.record.phases import CARRYING, LOADING, LOST, PHASES, SERVING, UNLOADING
from teamformer.record.record import Record
from teamformer.record.referee import judge
from teamformer.record.telling.latest import LatestTold
from teamformer.record.telling.teller import Teller
from teamformer.record.telling.whole import told_of
from teamformer.record.told.told_record import ToldService
from teamformer.record.told.trees import news_to_tree
from teamformer.trials.trial import run_trial
from teamformer.world.rules.constants import NOBODY

WALKS, FORMS, SERVES, IDLE = (PHASES.index(it) for it in ("walking", "forming", "serving", "idle"))


def record_of(seed: int, method: str) -> Record:
    rng = np.random.default_rng(seed)
    mission = random_world(rng, is_plane=seed % 3 == 0)
    mission = with_precedence_and_windows(mission, rng) if seed % 2 else mission
    return run_trial(with_surprises(mission, rng), load_method(method), seed).record


def test_two_robots_do_a_task() -> None:
    """a..T.b: a walks 3, b walks 3, they form one team, then serve for two steps."""
    mission = make([robot("a", 0), robot("b", 6)], [task("ab", 3, duration=2)])
    told = record_to_tree(run_trial(mission, load_method("plan")).record)["told"]
    assert told["services"] == [[0, SERVES, 4, 6, 0]]
    assert told["phases"] == [
        [[0, WALKS, 0, 0], [3, FORMS, 0], [4, SERVES, 0, 1]],
        [[0, WALKS, 0, 0], [3, None, 0]],
    ]
    assert told["texts"] == [
        "the plan has r0, r1 do it together",
        "its team brings all that the task needs, and stays until that is done",
    ]
    assert told["path"] == [[0, 3, WALKS, 0, 0], [3, 4, FORMS, 0, 0], [4, 6, SERVES, 0, 0]]


@pytest.mark.parametrize("method", ["plan", "heuristic", "join-all"])
def test_robots_do_one_thing_at_a_time_from_the_first_step_to_the_last(method: str) -> None:
    """Each robot's runs follow one another; they are what `moments` say, and team mates agree."""
    lost = 0
    for seed in range(12):
        record = record_of(seed, method)
        told = told_of(record)
        by_robot = [
            [run for end, run in told.runs_of(r) for _ in range(run.begun, end)]
            for r in range(len(record.mission.robots))
        ]
        for number in range(len(by_robot)):
            deeds = [run[1:3] for _, run in told.runs_of(number)]
            assert all(one != other for one, other in pairwise(deeds))
        for moment in list(moments(record))[1:]:
            runs = [row[moment.step - 1] for row in by_robot]
            assert [run.phase for run in runs] == list(moment.phase)
            assert [run.task for run in runs] == list(moment.pursued)
            lost += moment.phase.count(LOST)
        assert all(len(row) == len(record.steps) for row in by_robot)
    assert lost > 10


def test_services_end_as_the_record_says() -> None:
    """A task that is done has one that ended then, and takes as long as it really takes."""
    done = 0
    for seed in range(12):
        record = record_of(seed, "plan")
        rows = told_of(record).services
        tasks = record.true_mission.tasks
        ends = [(k, n) for n, step in enumerate(record.steps, 1) for k, _ in step.done]
        for k, step in ends:
            [last] = [it for it in rows if (it.task, it.ended) == (k, step)][-1:]
            assert last.robots == last.begun_by
            if last.doing == SERVING:
                assert step - last.begun == tasks[k].duration
        done += len(ends)
    assert done > 20


def test_a_service_that_is_broken_off_ends_then_and_begins_anew() -> None:
    """They begin in step 1; b is lost from step 3 to 6, and joins a again in step 7."""
    away = replace(robot("b", 0), absences=(Absence(3, 6),))
    mission = make([robot("a", 0), away], [task("ab", 0, duration=4)], teams=((0, 1),))
    told = told_of(run_trial(mission, load_method("plan")).record)
    assert [it[:6] for it in told.services] == [
        (0, SERVING, 1, 3, (0, 1), (0, 1)),
        (0, SERVING, 7, 11, (0, 1), (0, 1)),
    ]


def test_a_load_is_loaded_carried_and_unloaded() -> None:
    """Each part begins where the one before ended, and unloading takes what the mission says."""
    record = run_trial(world_of("carry", 1), load_method("crews")).record
    rows = told_of(record).services
    loads = [k for k, wanted in enumerate(record.mission.tasks) if wanted.to is not None]
    assert loads
    for k in loads:
        parts = [it for it in rows if it.task == k]
        assert [it.doing for it in parts[:2]] == [LOADING, CARRYING]
        assert [it.begun for it in parts[1:]] == [it.ended for it in parts[:-1]]
        unloading = [it for it in parts if it.doing == UNLOADING]
        assert _spent(unloading) == record.mission.tasks[k].unload


def _spent(services: list[ToldService]) -> int:
    return sum((it.ended or 0) - it.begun for it in services)


@pytest.mark.parametrize("method", ["plan", "heuristic"])
def test_what_steps_add_comes_to_what_is_told_of_all(method: str) -> None:
    """Whoever has been told of the first steps, and then of each, knows what the record tells."""
    for seed in range(6):
        record = record_of(seed, method)
        told: Any = {"services": [], "phases": [[] for _ in record.mission.robots], "texts": []}
        teller = Teller(record)
        for _ in record.steps:
            news = news_to_tree(teller.go_on(record))
            for row, service in news["services"]:
                told["services"][row : row + 1] = [service]
            for number, run in news["phases"]:
                told["phases"][number].append(run)
            told["texts"] += news["texts"]
        whole = record_to_tree(record)["told"]
        assert told == {key: value for key, value in whole.items() if key != "path"}


def test_the_latest_step_is_told_whatever_was_told_before() -> None:
    record = record_of(2, "plan")
    latest, teller = LatestTold(), Teller(record)
    news = [teller.go_on(record) for _ in record.steps]
    assert latest.of(record) == news[-1]
    latest.forget()
    assert latest.of(record) == news[-1]


def test_what_is_told_must_be_what_the_steps_tell() -> None:
    tree = record_to_tree(record_of(1, "plan"))
    assert judge(record_from_tree(tree, "r.json")).is_legal
    forged = copy.deepcopy(tree)
    forged["told"]["phases"][0][0][1] = (forged["told"]["phases"][0][0][1] + 1) % len(PHASES)
    assert [finding.message for finding in judge(record_from_tree(forged, "r.json")).findings] == [
        "what is told of phases is not what happened"
    ]
    del tree["told"]
    assert told_of(record_from_tree(tree, "r.json")).length == len(tree["steps"])


def test_nobody_is_about_a_task_while_lost() -> None:
    record = record_of(0, "plan")
    for robot_number in range(len(record.mission.robots)):
        runs = [run for _, run in told_of(record).runs_of(robot_number)]
        assert all(run.task == NOBODY for run in runs if run.phase == LOST and run.begun > 0)
