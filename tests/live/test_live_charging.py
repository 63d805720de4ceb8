"""Missions in steps whose robots have batteries that run while things happen to them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from random_worlds import random_world, with_batteries
from teamformer.base.errors import MissionError
from teamformer.live.running.forecasts import forecast
from teamformer.live.running.incidents import Incident, LostRobot, NewTask, RobotBack
from teamformer.live.steps.mission_with_past import RunningMission
from teamformer.methods.by_name import load_method
from teamformer.mission.model import Mission
from teamformer.record.phases import CHARGING
from teamformer.record.referee import judge
from teamformer.trials.trial import run_trial


def drawn(number: int) -> Mission:
    """Return a mission; of parts of a map without a charger another one is drawn."""
    rng = np.random.default_rng(number)
    while True:
        try:
            return with_batteries(random_world(rng, with_losses=False), rng)
        except MissionError:
            continue


@pytest.mark.parametrize("method", ["plan", "join-fitting"])
def test_a_mission_to_which_nothing_happens_is_what_run_makes_of_it(method: str) -> None:
    for number in range(4):
        run = RunningMission(drawn(number), lambda: load_method(method), seed=0)
        while run.is_running:
            run.step()
        assert run.record() == run_trial(drawn(number), load_method(method)).record


def test_robots_are_lost_and_tasks_appear_while_robots_charge() -> None:
    charges = 0
    for number in range(20, 30):
        mission = drawn(number)
        run = RunningMission(mission, lambda: load_method("plan"), seed=0)
        robot, task = mission.robots[0], mission.tasks[0]
        incidents: dict[int, Incident] = {
            1: LostRobot(robot.name),
            2: NewTask(replace(task, name="new", appears=0)),
            4: RobotBack(robot.name),
        }
        while run.is_running:
            if run.steps in incidents:
                run.happen(incidents.pop(run.steps))
                forecast(run.past())
            if run.is_running:
                run.step()
        record = run.record()
        assert judge(record).findings == ()
        charges += sum(doing == CHARGING for step in record.steps for _, doing in step.charge)
    assert charges > 1
