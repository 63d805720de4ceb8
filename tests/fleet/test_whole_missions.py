"""Fleets take the keys of the mission file: each by hand, undisturbed and under faults."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import pytest

from fleets import PLANNER, agents_of, opened, plan_of, standing, walked
from small_worlds import make, robot, task
from teamformer.fleet.agent.knowledge import Knowledge, Remembered
from teamformer.fleet.agent.planning import FleetPlan, PlanKeeper
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.messages import (
    EVERYBODY,
    OPERATOR,
    READY,
    CallOff,
    FactsNote,
    Notice,
    PlanNote,
    Receipt,
    TaskFact,
)
from teamformer.fleet.rehearsal.checking.checker import Checker
from teamformer.fleet.rehearsal.checking.trace import (
    OFF,
    Event,
    Finished,
    Noticed,
    Said,
    Trace,
    Walked,
    Worked,
)
from teamformer.fleet.rehearsal.faults import Crash, Cut, Faults, Order, Withdrawal
from teamformer.fleet.rehearsal.outcome import Outcome
from teamformer.fleet.rehearsal.play import Rehearsal
from teamformer.fleet.rehearsal.records.of_rehearsal import record_of
from teamformer.fleet.rehearsal.rehearse import judge, play, set_stage
from teamformer.mission.checks.rules import rules_of_fleets
from teamformer.mission.model import Mission
from teamformer.mission.parts.grid import Grid
from teamformer.record.referee import judge as judge_record
from teamformer.world.rules.constants import NOBODY


def changed(mission: Mission, number: int, **keys: Any) -> Mission:
    """Return a mission in which a task has other values."""
    tasks = list(mission.tasks)
    tasks[number] = replace(tasks[number], **keys)
    return replace(mission, tasks=tuple(tasks), step_limit=0)


CALM = Faults()


def rehearse(mission: Mission, faults: Faults = CALM) -> tuple[Rehearsal, Outcome, Trace]:
    fleet, trace = FleetMission(mission), Trace()
    rehearsal, outcome, violations = play(fleet, plan_of(fleet), faults, trace)
    assert violations == []
    return rehearsal, outcome, trace


def keep(mission: Mission, schedules: int = 12) -> None:
    """Play a mission under random schedules; every promise is kept, and nothing blocks."""
    stage = set_stage(FleetMission(mission))
    verdicts = [judge(stage, 5, number) for number in range(schedules)]
    assert [verdict for verdict in verdicts if not verdict.is_good] == []


def in_order() -> Mission:
    """Return robots that can do `a` at 5 and `b` at 10; t0 at 5 comes after t1, 4 cells from b."""
    tasks = [task("a", 5, duration=2), task("b", 14, duration=3)]
    return changed(make([robot("a", 5), robot("b", 10)], tasks), 0, after=("t1",))


def test_a_task_waits_for_the_one_that_it_comes_after() -> None:
    """Four steps to walk, three and two to serve; and word of the first gets round."""
    _, outcome, trace = rehearse(in_order())
    assert [event.task for event in trace.events if isinstance(event, Finished)] == [1, 0]
    assert outcome.makespan is not None
    assert 9.0 <= outcome.makespan <= 9.3
    keep(in_order())


def test_what_waits_for_a_task_that_cannot_be_done_is_left_and_said() -> None:
    _, outcome, _ = rehearse(in_order(), Faults(crashes=(Crash(1, 2.0),)))
    assert (outcome.status, outcome.tasks_done) == ("infeasible", 0)
    assert sorted(outcome.blocked_tasks) == ["t0", "t1"]


def test_who_waits_for_a_task_that_a_lost_robot_did_goes_to_see_it() -> None:
    """Robot 1 does t1 while nobody hears it, and is lost; robot 0 finds that it is done."""
    cut = Cut(frozenset({1}), frozenset({0}), 0.0, 400.0)
    _, outcome, trace = rehearse(in_order(), Faults(cuts=(cut,), crashes=(Crash(1, 9.0),)))
    assert (outcome.status, outcome.tasks_done) == ("ended", 2)
    ways = [e.journey.goal for e in trace.events if isinstance(e, Walked) and e.robot == 0]
    assert (14, 0) in ways


def test_what_comes_after_a_task_that_is_called_off_may_begin() -> None:
    mission = changed(in_order(), 1, cancelled=6)  # as step 6 begins, 5 s after the start
    _, outcome, trace = rehearse(mission)
    assert outcome.status == "ended"
    assert [event.task for event in trace.events if isinstance(event, Finished)] == [0]
    assert outcome.makespan == pytest.approx(7.0, abs=0.1)
    keep(mission)


@pytest.mark.parametrize("drift", [(0.0,), (0.02,), (-0.02,)])
def test_a_window_opens_by_the_time_of_the_world(drift: tuple[float, ...]) -> None:
    """Robots begin by their own clocks, 2% early at most; the service itself does not."""
    mission = changed(make([robot("a", 3)], [task("a", 5, duration=2)]), 0, between=(50.0, 60.0))
    _, outcome, trace = rehearse(mission, Faults(drift=drift))
    assert outcome.makespan == pytest.approx(52.0, abs=1.1 if drift < (0.0,) else 0.03)
    [begun] = [e.at for e in trace.events if isinstance(e, Worked) and e.task != NOBODY]
    assert begun == pytest.approx(50 / (1 + drift[0]), abs=0.1)
    keep(mission)


def flown() -> Mission:
    """Return a wall from top to bottom with a task on either side: f flies, g does not."""
    walled = Grid(7, 3, ("...@...", "...@...", "...@..."))
    flyer, walker = replace(robot("ab", 1, 1), moves="air"), robot("a", 0, 0)
    tasks = [task("ab", 5, 1, duration=1), task("aa", 2, 2, duration=1)]
    return make([flyer, walker], tasks, walled)


def test_who_flies_goes_over_walls_and_meets_who_walks() -> None:
    fleet = FleetMission(flown())
    assert dict(plan_of(fleet).stops) == {0: (0,), 1: (0, 1)}
    rehearsal, outcome, trace = rehearse(flown())
    assert outcome.status == "ended"
    assert judge_record(record_of(rehearsal, outcome, trace.events, 0)).findings == ()
    flights = [
        [p.place for p in e.journey.way]
        for e in trace.events
        if isinstance(e, Walked) and e.robot == 0
    ]
    assert any((3, 1) in points for points in flights)
    assert all(
        e.robot == 0 or (3, 1) not in [p.place for p in e.journey.way]
        for e in trace.events
        if type(e) is Walked
    )
    assert rehearsal.world.done[1].robots == (0, 1)
    keep(flown())


def long_one() -> Mission:
    """Return a task of twenty steps where two robots stand, and one beside it."""
    tasks = [task("aa", 5, duration=20), task("a", 6)]
    return make([robot("a", 5), robot("a", 5)], tasks, teams=((0, 1),))


@pytest.mark.parametrize(
    ("mission", "faults"),
    [
        (changed(long_one(), 0, cancelled=9), Faults()),
        (long_one(), Faults(withdrawals=(Withdrawal(8.0, 0),))),
        (long_one(), Faults(loss=0.5, withdrawals=(Withdrawal(8.0, 0),))),
    ],
)
def test_a_service_is_broken_off_when_its_task_is_called_off(
    mission: Mission, faults: Faults
) -> None:
    rehearsal, outcome, trace = rehearse(mission, faults)
    assert (outcome.status, outcome.tasks_done) == ("ended", 1)
    assert 0 not in rehearsal.world.done
    heard = {e.robot: e.at for e in trace.events if isinstance(e, Noticed) and e.what == OFF}
    assert set(heard) == {0, 1}
    assert all(8.0 <= at <= 8.0 + (4.0 if faults.loss else 0.3) for at in heard.values())
    record = record_of(rehearsal, outcome, trace.events, 0)
    assert record.mission.tasks[0].cancelled == 9
    assert judge_record(record).findings == ()
    assert [task for step in record.steps for task, _ in step.done] == [1]


def test_schedules_with_tasks_called_off_keep_every_promise() -> None:
    keep(changed(long_one(), 0, cancelled=9), 25)


def test_what_an_operator_calls_off_is_held_told_on_and_remembered() -> None:
    fleet = FleetMission(long_one())
    agent, other = agents_of(fleet)
    called = opened(fleet, OPERATOR, [Notice(EVERYBODY, CallOff(0))])
    before = agent.memory_version
    _, notices = agent.tick(0.1, standing(agent, 1), called)
    assert Notice(OPERATOR, Receipt(0, is_called_off=True)) in notices
    assert agent.memory_version != before
    assert agent.remember(1.0).called_off == (0,)
    [facts] = [notice.body for notice in notices if isinstance(notice.body, FactsNote)]
    assert facts.called_off == (0,)
    other.tick(0.1, standing(other, 1), opened(fleet, 0, [Notice(EVERYBODY, facts)]))
    assert (other.knowledge.called_off, other.knowledge.digest) == ({0}, agent.knowledge.digest)
    unknown = opened(fleet, OPERATOR, [Notice(EVERYBODY, CallOff(77))])
    _, notices = agent.tick(0.2, standing(agent, 2), unknown)
    assert not any(isinstance(notice.body, Receipt) for notice in notices)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_task_takes_what_it_really_takes(seed: int) -> None:
    mission = changed(make([robot("a", 3)], [task("a", 5)]), 0, lasts=(2, 30))
    truth = FleetMission(mission).truth(seed).tasks[0].duration
    rehearsal, outcome, trace = rehearse(mission, Faults(seed=seed))
    assert outcome.makespan == pytest.approx(2 + truth, abs=0.1)
    record = record_of(rehearsal, outcome, trace.events, seed)
    assert record.true_mission.tasks[0].duration == truth
    assert record.mission.tasks[0].lasts == (2, 30)


def test_another_robot_is_called_where_a_task_turns_out_to_need_more() -> None:
    """Nobody expects b, which is needed one time in ten; it comes once robot 0 has looked."""
    mission = make([robot("a", 4), robot("b", 9), robot("a", 19)], [task("a", 5, duration=2)])
    mission = changed(mission, 0, may_need={"b": 0.1})
    fleet = FleetMission(mission)
    needs = [dict(fleet.truth(seed).tasks[0].needs) for seed in range(40)]
    needed, spared = needs.index({"a": 1, "b": 1}), needs.index({"a": 1})
    assert plan_of(fleet).stops == ((0, (0,)),)
    rehearsal, outcome, trace = rehearse(mission, Faults(seed=needed))
    assert rehearsal.world.done[0].robots == (0, 1)
    record = record_of(rehearsal, outcome, trace.events, needed)
    assert [number for number, step in enumerate(record.steps, 1) if step.shown] == [2]
    rehearsal, outcome, _ = rehearse(mission, Faults(seed=spared))
    assert rehearsal.world.done[0].robots == (0,)
    assert outcome.makespan == pytest.approx(3.0, abs=0.1)
    keep(mission, 25)


def found(mission: Mission, events: Sequence[Event]) -> str:
    fleet = FleetMission(mission)
    tasks = {task.key: task for task in fleet.tasks}
    return "\n".join(Checker(fleet, tasks).check(events, ()))


def served(at: float, key: int = 0) -> list[Event]:
    """Return how a robot begins to serve a task where it stands, and ends after two seconds."""
    ready, begin = Said(at - 0.1, 0, 0, key, READY, 2.6), Worked(at, 0, key, 0)
    return [ready, begin, Finished(at + 2, key), Worked(at + 2.1, 0, NOBODY, NOBODY)]


def test_the_checker_finds_who_begins_too_early() -> None:
    stand = make([robot("a", 5)], [task("a", 5, duration=2), task("a", 6)])
    late = changed(stand, 0, between=(20.0, 90.0))
    assert found(late, served(20.0)) == ""
    assert "serves 't0' 10.00 s before its window" in found(late, served(10.0))
    assert "task 't0' is done without its service" in found(late, served(19.0))
    after = changed(stand, 0, after=("t1",))
    assert "serves 't0' before 't1' is over" in found(after, served(5.0))


def test_the_checker_finds_who_serves_what_it_knows_is_off_and_who_walks_through_walls() -> None:
    stand = make([robot("a", 5)], [task("a", 5, duration=2)])
    known: list[Event] = [Noticed(3.0, 0, 0, OFF)]
    assert found(stand, served(3.0)) == ""
    assert "serves 't0' and knows that it is called off" in found(stand, known + served(5.0))
    way = walked(0.0, 1, ((0, 0), (3, 0)), 0.0, 1.0)
    assert "walks through [(3, 0)]" in found(flown(), [way])
    assert found(flown(), [way._replace(robot=0)]) == ""


def somewhere() -> Mission:
    """Return a robot at 0 and a task within three cells of 5, that is seen from the next cell."""
    return changed(make([robot("a", 0)], [task("a", 5, duration=2)]), 0, within=3.0)


def test_a_task_is_looked_for_from_place_to_place() -> None:
    """From 5 one sees 4 and 6, from 3 one sees 2, from 7 one sees 8."""
    fleet = FleetMission(somewhere())
    assert fleet.hidden == {0: ((5, 0), (3, 0), (7, 0))}
    places = [fleet.truth(seed).tasks[0].at[0] for seed in range(60)]
    for at, walks in ((5, 5), (6, 6), (8, 5 + 2 + 4 + 1)):
        seed = places.index(at)
        rehearsal, outcome, trace = rehearse(somewhere(), Faults(seed=seed))
        assert outcome.makespan == pytest.approx(walks + 2, abs=0.2)
        record = record_of(rehearsal, outcome, trace.events, seed)
        assert [step.found for step in record.steps if step.found] == [(0,)]
        assert record.true_mission.tasks[0].at == (at, 0)
        assert judge_record(record).findings == ()
    keep(somewhere(), 20)


def test_where_a_task_was_found_is_told_and_holds() -> None:
    mission = make([robot("a", 0), robot("b", 19)], [task("ab", 5, duration=2)])
    mission = changed(mission, 0, within=3.0)
    agent, other = agents_of(FleetMission(mission))
    assert agent.knowledge.rule_out(0)
    assert agent.knowledge.place_of(0) == (3, 0)
    assert agent.knowledge.find(0, (8, 0))
    assert not agent.knowledge.rule_out(0)
    other.knowledge.merge(agent.knowledge.note(), 1.0)
    assert other.knowledge.place_of(0) == (8, 0)
    assert other.knowledge.digest == agent.knowledge.digest
    keep(mission, 20)


def test_what_fleets_refuse_is_told_with_what_to_do() -> None:
    both = changed(somewhere(), 0, to=(9, 0))
    [problem] = rules_of_fleets(both)
    assert problem.where == ("tasks", 0, "within")
    assert problem.message.startswith("task 't0' has a load within a region, which fleets of proc")
    assert "drop within, or use `run`" in problem.message
    assert list(rules_of_fleets(somewhere())) == []


def test_who_has_looked_in_vain_is_free_to_meet_others() -> None:
    """Robot 0 looks at t1, which t0 comes after: robot 1, out of hearing, may have done it."""
    fleet = FleetMission(in_order())
    knowledge = Knowledge(fleet, 0, Remembered())
    looks = PlanNote(1, 0, (0,), (1,), ((0,),), left_out=(0, 1))
    keeper = PlanKeeper(knowledge, FleetPlan(looks), PLANNER)
    assert keeper.next_task(0) == 1
    keeper.note_look(1)
    assert keeper.next_task(0) == NOBODY
    keeper.take(PlanNote(2, 0, (0, 1), (1, 0), ((1,), (0,))), 5.0)
    keeper.note_look(0)  # it is to do that, not to look
    assert keeper.next_task(0) == 0


def test_a_record_leaves_out_what_nobody_has_accepted() -> None:
    """All but one of five robots are lost at once: the operator's task is held by too few."""
    robots = [robot("a", 0) for _ in range(5)]
    source = make(robots, [task("a", 0)])
    crashes = tuple(Crash(number, 0.0) for number in range(1, 5))
    order = Order(0.5, TaskFact(1 << 24, "order", 1.0, 0.0, (1,)))
    rehearsal, outcome, trace = rehearse(source, Faults(crashes=crashes, orders=(order,)))
    record = record_of(rehearsal, outcome, trace.events, 0)
    assert judge_record(record).findings == ()
    assert outcome.status == "ended"
    assert [task.name for task in record.mission.tasks] in (["t0"], ["t0", "order"])
