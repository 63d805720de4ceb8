"""The central planner is never worse than the default, and tiny missions have no better play."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from hypothesis import strategies as st

from methods import DEFAULT, play
from missions import SEEDS, missions
from plain_search import fewest_steps
from teamformer.base.errors import UndoableError
from teamformer.files.mission_files import mission_from_tree
from teamformer.methods.central.policy import Central
from teamformer.mission.checks.costs import judged_by, weighed
from teamformer.planning.bounds.makespan import lower_bound
from teamformer.record.referee import judge
from teamformer.trials.planned import PlannedMission, plan_mission, rules_not_planned
from teamformer.trials.start_plan import read_start_plan
from teamformer.trials.trial import PlayedTrial, run_trial
from tiny import count_plans, gap_in_steps, played_worth
from watching import fuzzed

MOST_PLANS, ENOUGH_SECONDS = 300, 3.0
"""Of so few plans `central` has looked at all long before that."""

SECONDS = st.sampled_from([0.0, 0.05, 0.2])
RUN = "run FILE --method central --seed {seed} --time-limit {seconds}"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("plans")


def play_centrally(mission: Any, seed: int, seconds: float) -> PlayedTrial:
    central = Central(seconds, workers=1)
    return run_trial(mission_from_tree(mission), central, seed)


@fuzzed(6, RUN, mission=missions(has_cancelled=False), seed=SEEDS, seconds=SECONDS)
def test_central_is_never_worse_than_the_default(mission: Any, seed: int, seconds: float) -> None:
    played = play(mission_from_tree(mission), DEFAULT, seed).record
    usual = played.end
    trial = play_centrally(mission, seed, seconds)
    best = trial.record.end
    assert not judge(trial.record).findings
    assert best.illegal_decisions == 0
    if usual.makespan is None:
        assert best.tasks_done >= usual.tasks_done or best.status == "infeasible"
        return
    assert best.status == "completed"
    assert best.makespan is not None
    assert played_worth(trial.record) <= played_worth(played)
    bound = trial.record.lower_bound
    assert bound is None or bound <= best.makespan


@fuzzed(4, "plan FILE --from PLAN", mission=missions(has_cancelled=False), seconds=SECONDS)
def test_what_begins_with_a_plan_is_never_worse(mission: Any, seconds: float, folder: Path) -> None:
    """What is handed in is what `plan` printed: its routes are read, and played by the mission."""
    source = mission_from_tree(mission)
    if list(rules_not_planned(source)):
        return
    try:
        made = plan_mission(source, "central", seconds)
    except UndoableError:
        return
    if made is None:
        return
    file = folder / "plan.json"
    file.write_text(json.dumps(made.row))
    again = plan_mission(source, "central", 0.0, read_start_plan(file, source))
    assert again is not None
    assert worth_of(again) <= worth_of(made)


def worth_of(made: PlannedMission) -> float:
    """Return what a plan is judged by, as `played_worth` does what was played."""
    weights = judged_by(made.mission)
    if weights is None:
        return made.makespan
    ends = {stop.task: stop.end for route in made.routes for stop in route.stops}
    return weighed(made.mission, weights, ends, made.makespan)


@fuzzed(6, RUN, mission=missions(is_sure=True, is_tiny=True), seed=SEEDS, seconds=SECONDS)
def test_nothing_is_faster_than_every_play_of_a_tiny_mission(
    mission: Any, seed: int, seconds: float
) -> None:
    source = mission_from_tree(mission)
    fewest = fewest_steps(source)
    if fewest is None:
        return
    assert lower_bound(source) <= fewest
    end = play_centrally(mission, seed, seconds).record.end
    assert end.makespan is None or end.makespan >= fewest


@fuzzed(4, "run FILE --method central", mission=missions(is_sure=True, has_cancelled=False))
def test_no_plan_of_a_tiny_mission_is_played_better(mission: Any) -> None:
    """Orders, and coalitions with robots to spare or without."""
    source = mission_from_tree(mission)
    if 1 < count_plans(source) <= MOST_PLANS:
        assert gap_in_steps(source, ENOUGH_SECONDS) == 0.0
