"""Plans of missions in steps whose robots work in shifts: undisturbed, they take what they say."""

from __future__ import annotations

import pytest

from small_worlds import at_work, make, robot, task
from teamformer.files.drawn.named_settings import world_of
from teamformer.methods.by_name import load_method
from teamformer.mission.coordination import known_at_start
from teamformer.mission.model import Mission
from teamformer.planning.problem.coalition_plan import plan_of_lists
from teamformer.planning.steps.shared_plan import plan_mission
from teamformer.planning.steps.situation import situation_of
from teamformer.planning.steps.timed_plan import time_team_plan
from teamformer.record.referee import judge
from teamformer.trials.trial import run_trial


@pytest.mark.parametrize("setting", ["sparse-shifts", "carry-shifts", "deadlines-shifts"])
def test_a_plan_is_carried_out_in_the_steps_that_it_says(setting: str) -> None:
    mission = world_of(setting, 1)
    assert any(one.shifts for one in mission.robots)
    record = run_trial(mission, load_method("plan")).record
    assert record.end.makespan == plan_mission(known_at_start(mission)).makespan
    assert not judge(record).findings


def test_what_is_passed_is_done_if_it_fits_then_or_after_a_pause_there() -> None:
    """A task of two steps at 4: the robot comes past it at 4, and works until 5 and from 9 on.

    At 5 it pauses and goes on; a robot whose shift ends as it is there begins it at 9.
    """
    mission = make([robot("a", 0)], [task("a", 8), task("a", 4, duration=2)])
    past = at_work(mission, ((0, 5), (9, 30)))
    assert _ends(past) == [12, 18]  # there and back: four cells from 12 on, two steps of service
    assert _ends(at_work(mission, ((0, 4), (9, 30)))) == [15, 11]
    assert _ends(at_work(mission, ((0, 6), (9, 30)))) == [13, 6]


def _ends(mission: Mission) -> list[int]:
    situation = situation_of(known_at_start(mission))
    ends: list[int] = time_team_plan(situation, plan_of_lists([0, 1], [[0], [0]])).ends.tolist()
    return ends
