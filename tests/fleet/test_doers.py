"""Who is said to have done a task: in rehearsals, by onlookers, and beside the simulator."""

from __future__ import annotations

from pathlib import Path

import pytest

from fleets import PLANNER, Watched, pair, plan_of, trio
from small_worlds import make, robot, task
from teamformer.files.mission_files import read_mission
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.rehearsal.checking.trace import Trace
from teamformer.fleet.rehearsal.faults import Crash, Faults
from teamformer.fleet.rehearsal.play import Rehearsal
from teamformer.fleet.rehearsal.records.of_rehearsal import record_of
from teamformer.fleet.rehearsal.rehearse import faults_of, play, set_stage
from teamformer.methods.coordinators.shared_plan import SharedPlan
from teamformer.mission.model import Absence
from teamformer.record.happenings import events
from teamformer.record.record import Record
from teamformer.record.snapshots.teams_seen import team_changes
from teamformer.trials.trial import run_trial

EXAMPLES = Path(__file__).parents[2] / "examples"

Doers = dict[str, tuple[int, ...]]
"""The robots that did each task, by its name."""


def credited(record: Record) -> Doers:
    """Return whom the readers of a record hold to have done its tasks."""
    names = [task.name for task in record.mission.tasks]
    done = [event for event in events(record) if event.kind == "done"]
    return {names[event.task]: tuple(sorted(event.robots)) for event in done}


def really_did(rehearsal: Rehearsal) -> Doers:
    world = rehearsal.world
    return {world.tasks[key].name: done.robots for key, done in world.done.items()}


def relay() -> FleetMission:
    """Return two pairs that go on at once, in turns with one another: a.b.....T"""
    robots = [robot("a", 0), robot("a", 2), robot("b", 0), robot("b", 2)]
    tasks = [task("ab", 6), task("ab", 9, duration=3), task("a", 12), task("aabb", 16)]
    return FleetMission(make([*robots], [*tasks, task("b", 14, duration=1)]))


@pytest.mark.parametrize("mission", [pair(), trio(), relay()], ids=["pair", "trio", "relay"])
def test_over_a_perfect_network_it_is_who_does_it_in_the_simulator(mission: FleetMission) -> None:
    trace = Trace()
    rehearsal = Rehearsal(mission, PLANNER, plan_of(mission), Faults(), trace)
    record = record_of(rehearsal, rehearsal.run(300.0), trace.events, 0)
    done = credited(record)
    assert done == really_did(rehearsal)
    simulated = credited(run_trial(mission.source, SharedPlan()).record)
    assert done.keys() == simulated.keys()
    for number, wanted in enumerate(mission.source.tasks):
        trailing = set(simulated[wanted.name]) - set(done[wanted.name])  # in a fleet they only come
        assert set(done[wanted.name]) <= set(simulated[wanted.name]), number
        assert mission.covers(done[wanted.name], mission.tasks[number].needs) or not trailing


@pytest.mark.parametrize("schedule", [12, 0, 1, 2, 3])
@pytest.mark.thorough
def test_under_faults_it_is_who_did_it(schedule: int) -> None:
    """Schedule 12 of seed 7 had robot 0 do 13 of 16 tasks, since the doers had gone on."""
    mission = read_mission(EXAMPLES / "warehouse.yaml")
    stage = set_stage(FleetMission(mission, mission.seconds_a_step))
    faults, trace = faults_of(stage, 7, schedule), Trace()
    rehearsal, outcome, _ = play(stage.mission, stage.plan, faults, trace, stage.method)
    record = record_of(rehearsal, outcome, trace.events, 7)
    assert credited(record) == really_did(rehearsal)
    assert len(credited(record)) == outcome.tasks_done >= 10


def test_who_is_lost_after_several_tasks_in_a_step_did_them_all() -> None:
    """In step 1 robot 3 does the last task with 0, then the others alone; then it is lost.

    Fuzzing found it: what it did alone was shown in step 2, when it was there no longer.
    """
    robots = [robot("b", 0), robot("a", 0), robot("a", 0), robot("ab", 0)]
    tasks = [task("a", 0), task("a", 0), task("bb", 0)]
    mission, trace = FleetMission(make(robots, tasks, forming_steps=0)), Trace()
    crashes = Crash(1, 0.0, 1.0), Crash(2, 0.0, 1.0), Crash(3, 1.0, keeps_facts=False)
    rehearsal = Rehearsal(mission, PLANNER, plan_of(mission), Faults(crashes=crashes), trace)
    record = record_of(rehearsal, rehearsal.run(300.0), trace.events, 0)
    assert credited(record) == really_did(rehearsal) == {"t0": (3,), "t1": (3,), "t2": (0, 3)}
    assert [len(step.done) for step in record.steps] == [1, 2]
    assert record.mission.robots[3].absences == (Absence(3),)


def test_who_leaves_a_team_that_loses_its_lowest_robot_parts_from_it_before() -> None:
    """In a step robots join before others are lost: 7 was in team 3, and is in team 2 after."""
    changes = team_changes({2: (2,), 3: (3, 7)}, {2: (2, 7)}, [3])
    assert changes == ((((3,), (7,)),), ((7, 2),))


@pytest.mark.parametrize("mission", [pair(), trio(), relay()], ids=["pair", "trio", "relay"])
def test_who_hears_the_fleet_knows_who_did_it(mission: FleetMission) -> None:
    rehearsal = Watched(mission)
    rehearsal.run(300.0)
    rehearsal.watch.step()
    assert credited(rehearsal.watch.record()) == really_did(rehearsal)


def test_who_hears_a_fleet_of_an_example_knows_who_did_it() -> None:
    mission = read_mission(EXAMPLES / "warehouse.yaml")
    rehearsal = Watched(FleetMission(mission, mission.seconds_a_step))
    rehearsal.run(300.0)
    rehearsal.watch.step()
    assert credited(rehearsal.watch.record()) == really_did(rehearsal)
