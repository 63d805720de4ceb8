"""Missions to which things happen: what comes out must be what `run` makes of their scenario."""

from __future__ import annotations

from pathlib import Path

import pytest

from teamformer.errors import TeamformerError
from teamformer.live.incidents import Incident, LostRobot, NewTask, RobotBack
from teamformer.live.mission import Mission
from teamformer.model import Absence
from teamformer.policies import POLICIES
from teamformer.policies.scripted.join_fitting import JoinFitting
from teamformer.referee import judge
from teamformer.scenarios.files import read_scenario
from teamformer.trials.registry import load_policy
from teamformer.trials.trial import run_trial

EXAMPLES = Path(__file__).parents[2] / "examples"


def mission(example: str = "late-tasks", policy: str = "join-fitting") -> Mission:
    scenario = read_scenario(EXAMPLES / f"{example}.yaml")
    return Mission(scenario, lambda: load_policy(policy, POLICIES), policy, seed=0)


def play(run: Mission, incidents: dict[int, Incident]) -> None:
    """Play a mission to its end; the keys are the steps made when incidents happen."""
    while run.is_running:
        if run.steps in incidents:
            run.happen(incidents.pop(run.steps))
        run.step()


@pytest.mark.parametrize("policy", ["join-fitting", "heuristic", "teamformer"])
def test_incidents_leave_a_record_that_run_makes_too(policy: str) -> None:
    run = mission(policy=policy)
    play(run, {4: NewTask((0, 0), {"lift": 1}, "extra"), 9: LostRobot(run.scenario.robots[0].name)})
    record = run.record()
    assert judge(record).findings == ()
    again = run_trial(run.scenario, load_policy(policy, POLICIES), policy)
    assert again.replay.steps == record.steps
    assert again.replay.end == record.end
    assert run.scenario.tasks[-1].appears == 4
    assert run.scenario.robots[0].absences == (Absence(10),)


def test_a_forecast_is_what_then_comes() -> None:
    run = mission()
    for _ in range(5):
        run.step()
    lose = LostRobot(run.scenario.robots[0].name)
    undisturbed, disturbed = run.forecast(), run.forecast(lose)
    assert run.steps == 5
    play(run, {})
    assert run.tally() == undisturbed
    other = mission()
    play(other, {5: lose})
    assert other.tally() == disturbed


def test_a_task_can_come_after_all_is_done() -> None:
    run = mission()
    play(run, {})
    made = run.steps
    assert run.tally().status == "completed"
    run.happen(NewTask((0, 0), {"lift": 1}))
    assert run.is_running
    play(run, {})
    assert run.tally().status == "completed"
    assert run.steps > made


@pytest.mark.parametrize(
    ("incident", "message"),
    [
        (NewTask((99, 0), {"lift": 1}), r"task 't6' is at \[99, 0\], outside the map"),
        (NewTask((0, 0), {"fly": 1}), "needs 'fly', which is not under capabilities"),
        (NewTask((0, 0), {"lift": 99}), "but all robots together lack"),
        (NewTask((0, 0), {}), "needs nothing"),
        (LostRobot("nobody"), "there is no robot 'nobody'"),
    ],
)
def test_what_cannot_happen_is_refused_and_changes_nothing(
    incident: Incident, message: str
) -> None:
    run = mission()
    run.step()
    before = run.scenario
    with pytest.raises(TeamformerError, match=message):
        run.happen(incident)
    assert run.scenario is before
    assert run.incidents == []


def test_who_is_lost_is_not_lost_again() -> None:
    run = mission()
    name = run.scenario.robots[0].name
    run.happen(LostRobot(name))
    run.step()
    with pytest.raises(TeamformerError, match="was lost in step 1 already"):
        run.happen(LostRobot(name))


def test_a_lost_robot_is_brought_back_and_lost_again() -> None:
    run = mission()
    name = run.scenario.robots[0].name
    with pytest.raises(TeamformerError, match=f"robot '{name}' is not lost"):
        run.happen(RobotBack(name))
    run.happen(LostRobot(name))
    run.step()
    assert run.tally().status == "infeasible"
    run.happen(RobotBack(name))
    assert run.step().back == (0,)
    with pytest.raises(TeamformerError, match="is back since step 2"):
        run.happen(RobotBack(name))
    run.happen(LostRobot(name))
    assert run.step().lost == (0,)
    assert run.tally().status == "infeasible"
    run.happen(RobotBack(name))
    play(run, {})
    assert run.scenario.robots[0].absences == (Absence(1, 2), Absence(3, 4))
    assert run.tally().status == "completed"
    record = run.record()
    assert judge(record).findings == ()
    again = run_trial(run.scenario, load_policy("join-fitting", POLICIES), "join-fitting")
    assert (again.replay.steps, again.replay.end) == (record.steps, record.end)


def test_who_is_not_back_after_all_stays_lost() -> None:
    run = mission()
    name = run.scenario.robots[0].name
    run.happen(LostRobot(name))
    run.step()
    run.happen(RobotBack(name))
    run.happen(LostRobot(name))
    assert run.scenario.robots[0].absences == (Absence(1),)
    with pytest.raises(TeamformerError, match="was lost in step 1 already"):
        run.happen(LostRobot(name))


def test_who_plans_with_everything_is_not_surprised() -> None:
    class KnowsEverything(JoinFitting):
        needs_everything = True

    run = Mission(mission().scenario, KnowsEverything, "knows-everything", seed=0)
    with pytest.raises(TeamformerError, match="run it under another policy"):
        run.happen(NewTask((0, 0), {"lift": 1}))
