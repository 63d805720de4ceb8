"""Missions to which things happen: what comes out must be what `run` makes of their mission."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import pytest

from small_worlds import late_pair, make, robot, task
from teamformer.base.errors import TeamformerError
from teamformer.files.mission_files import mission_from_tree, read_mission
from teamformer.live.running import forecasts
from teamformer.live.running.forecasts import Forecast, Unfinished, forecast
from teamformer.live.running.incidents import (
    CancelledTask,
    Incident,
    LostRobot,
    NewTask,
    NewWeight,
    PlanTakenOver,
    RobotBack,
    search_plan,
)
from teamformer.live.steps.mission_with_past import RunningMission
from teamformer.methods.by_name import Method, load_method
from teamformer.methods.central.policy import Central
from teamformer.methods.scripted.join_fitting import JoinFitting
from teamformer.mission.coordination import Plan
from teamformer.mission.model import Absence, Breakdown, Delays, Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.mission.truth import draw_truth
from teamformer.record.export.reasons import explain
from teamformer.record.referee import judge
from teamformer.trials.trial import run_trial

EXAMPLES = Path(__file__).parents[2] / "examples"


def mission(example: str = "late-tasks", method: str = "join-fitting") -> RunningMission:
    mission = read_mission(EXAMPLES / f"{example}.yaml")
    return RunningMission(mission, lambda: load_method(method), seed=0)


def play(run: RunningMission, incidents: dict[int, Incident]) -> None:
    """Play a mission to its end; the keys are the steps made when incidents happen."""
    while run.is_running:
        if run.steps in incidents:
            run.happen(incidents.pop(run.steps))
        run.step()


@pytest.fixture
def carried() -> Mission:
    """A robot on a ring around a wall; the load at its left is brought to the right."""
    return mission_from_tree(
        {
            "teamformer": 1,
            "world": {"rows": [".......", ".@@@@@.", "......."]},
            "capabilities": ["lift"],
            "robots": [{"at": [3, 2], "can": ["lift"]}],
            "tasks": [{"at": [1, 0], "needs": ["lift"], "to": [5, 0]}],
        }
    )


def test_a_mission_with_loads_is_as_it_was_after_it_was_played_ahead(carried: Mission) -> None:
    run = RunningMission(carried, lambda: load_method("plan"), seed=0)
    assert forecast(run.past()) == forecast(run.past())
    play(run, {})
    assert run.record().steps == run_trial(carried, load_method("plan")).record.steps


@pytest.mark.parametrize("method", ["join-fitting", "heuristic", "teamformer", "crews", "plan"])
def test_incidents_leave_a_record_that_run_makes_too(method: str) -> None:
    run = mission(method=method)
    play(
        run,
        {4: NewTask(Task("extra", (0, 0), {"lift": 1})), 9: LostRobot(run.source.robots[0].name)},
    )
    record = run.record()
    assert judge(record).findings == ()
    again = run_trial(run.source, load_method(method))
    assert again.record.steps == record.steps
    assert again.record.end == record.end
    assert run.source.tasks[-1].appears == 4
    assert run.source.robots[0].absences == (Absence(10),)


def test_a_forecast_is_what_then_comes() -> None:
    run = mission()
    for _ in range(5):
        run.step()
    lose = LostRobot(run.source.robots[0].name)
    undisturbed, disturbed = forecast(run.past()), forecast(run.past_with(lose))
    assert run.steps == 5
    play(run, {})
    assert undisturbed == Forecast(1, (run.steps,), done_at=ends_of_tasks(run))
    other = mission()
    play(other, {5: lose})
    assert other.tally().status == "infeasible"
    assert disturbed == Forecast(1, (), Unfinished("infeasible", other.steps), ends_of_tasks(other))
    assert None in disturbed.done_at


def ends_of_tasks(run: RunningMission) -> tuple[int | None, ...]:
    """Return by task the step in which the record has it done."""
    ends = {task: n for n, it in enumerate(run.record().steps, 1) for task, _ in it.done}
    return tuple(ends.get(task) for task in range(len(run.source.tasks)))


@pytest.mark.parametrize("method", ["plan", "join-fitting", "crews"])
def test_an_incident_that_is_undone_has_not_happened(method: str) -> None:
    """What comes then is what had come without it: the same record, and the other incident's."""
    plain, run = mission(method=method), mission(method=method)
    for one in (plain, run):
        for _ in range(3):
            one.step()
        one.happen(NewTask(Task("late", (2, 2), {"lift": 1})))
        one.step()
    run.happen(LostRobot(run.source.robots[0].name))
    run.step()
    assert isinstance(run.undo(), LostRobot)
    assert (run.steps, [it for _, it in run.incidents]) == (4, [it for _, it in plain.incidents])
    for one in (plain, run):
        play(one, {})
    assert run.record() == plain.record()
    run.undo()
    assert (run.steps, run.source) == (3, mission(method=method).source)
    play(run, {})
    assert run.record().steps == run_to_its_end(mission(method=method)).record().steps
    with pytest.raises(TeamformerError, match="nothing has happened"):
        run.undo()


def test_a_mission_anew_is_as_it_was_drawn() -> None:
    run = mission()
    run.step()
    run.happen(LostRobot(run.source.robots[0].name))
    run.step()
    again = run.anew()
    assert (again.steps, again.incidents, again.source) == (0, [], mission().source)
    assert run_to_its_end(again).record() == run_to_its_end(mission()).record()


def run_to_its_end(run: RunningMission) -> RunningMission:
    play(run, {})
    return run


def test_a_task_can_come_after_all_is_done() -> None:
    run = mission()
    play(run, {})
    made = run.steps
    assert run.tally().status == "completed"
    run.happen(NewTask(Task("late", (0, 0), {"lift": 1})))
    assert run.is_running
    play(run, {})
    assert run.tally().status == "completed"
    assert run.steps > made


@pytest.mark.parametrize(
    ("incident", "message"),
    [
        (NewTask(Task("t6", (99, 0), {"lift": 1})), r"task 't6' is at \[99, 0\], outside the map"),
        (NewTask(Task("t6", (0, 0), {"fly": 1})), "needs 'fly', which is not under capabilities"),
        (NewTask(Task("t6", (0, 0), {"lift": 99})), "but all robots together have"),
        (NewTask(Task("t6", (0, 0), {})), "needs nothing"),
        (LostRobot("nobody"), "there is no robot 'nobody'"),
    ],
)
def test_what_cannot_happen_is_refused_and_changes_nothing(
    incident: Incident, message: str
) -> None:
    run = mission()
    run.step()
    before = run.source
    with pytest.raises(TeamformerError, match=message):
        run.happen(incident)
    assert run.source is before
    assert run.incidents == []


def test_who_is_lost_is_not_lost_again() -> None:
    run = mission()
    name = run.source.robots[0].name
    run.happen(LostRobot(name))
    run.step()
    with pytest.raises(TeamformerError, match="was lost in step 1 already"):
        run.happen(LostRobot(name))


def test_a_lost_robot_is_brought_back_and_lost_again() -> None:
    run = mission()
    name = run.source.robots[0].name
    with pytest.raises(TeamformerError, match=f"robot '{name}' is not lost"):
        run.happen(RobotBack(name))
    run.happen(LostRobot(name))
    run.step()
    assert run.tally().status == "infeasible"
    run.happen(RobotBack(name))
    assert run.step().back == (0,)
    with pytest.raises(TeamformerError, match="came back in step 2 already"):
        run.happen(RobotBack(name))
    run.happen(LostRobot(name))
    assert run.step().lost == (0,)
    assert run.tally().status == "infeasible"
    run.happen(RobotBack(name))
    play(run, {})
    assert run.source.robots[0].absences == (Absence(1, 2), Absence(3, 4))
    assert run.tally().status == "completed"
    record = run.record()
    assert judge(record).findings == ()
    again = run_trial(run.source, load_method("join-fitting"))
    assert (again.record.steps, again.record.end) == (record.steps, record.end)


def test_who_is_not_back_after_all_stays_lost() -> None:
    run = mission()
    name = run.source.robots[0].name
    run.happen(LostRobot(name))
    run.step()
    run.happen(RobotBack(name))
    run.happen(LostRobot(name))
    assert run.source.robots[0].absences == (Absence(1),)
    with pytest.raises(TeamformerError, match="was lost in step 1 already"):
        run.happen(LostRobot(name))


STORM = read_mission(EXAMPLES / "storm.yaml")


def called(method: str) -> RunningMission:
    """A mission in which tasks appear at random: after steps 3, 14 and 38."""
    return RunningMission(STORM, lambda: load_method(method), seed=4)


@pytest.mark.parametrize("method", ["join-fitting", "plan"])
def test_what_appears_at_random_appears_whatever_else_happens(method: str) -> None:
    """An operator's task comes before those that are yet to appear, which come as they would."""
    run = called(method)
    extra = NewTask(Task("extra", (0, 0), {"scan": 1}))
    play(run, {10: extra, 14: CancelledTask("call-2"), 20: LostRobot("kite")})
    assert [it.name for it in run.source.tasks[6:]] == ["call-1", "extra", "call-2"]
    assert run.source.arrivals == replace(STORM.arrivals, since=20)
    record = run.record()
    assert judge(record).findings == ()
    told = [(it.name, it.appears) for it in record.true_mission.tasks[6:]]
    assert told == [("call-1", 3), ("extra", 10), ("call-2", 14), ("call-3", 38)]
    again = run_trial(run.source, load_method(method), run.seed)
    assert again.record.steps == record.steps


def test_what_appears_at_random_is_forecast_by_what_is_known(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """What has appeared is the same in all futures, and what is yet to appear is not."""
    run = called("join-fitting")
    assert [run.has_shown_more for _ in range(3) if run.step()][-1]  # as a call comes
    for _ in range(9):
        run.step()
    known, now = run.past().env.truths[0], run.past()
    futures = [now.possible_truth(seed) for seed in range(30)]
    for future in futures:
        calls = [it for it in future.tasks if it.has_arrived]
        assert [it for it in calls if it.appears <= 12] == [
            it for it in known.tasks if it.has_arrived and it.appears <= 12
        ]
        assert len({it.name for it in future.tasks}) == len(future.tasks)
    assert len({len(future.tasks) for future in futures}) > 2
    monkeypatch.setattr(forecasts, "SAMPLES", 10)
    monkeypatch.setattr(forecasts, "SECONDS", 600.0)
    told = forecast(now)
    assert 1 < told.futures <= 10
    assert len(told.done_at) == len(now.env.missions[0].tasks)


def test_who_plans_with_everything_is_not_surprised() -> None:
    class KnowsEverything(JoinFitting):
        needs_everything = True

    run = RunningMission(
        mission().source, lambda: Method("knows", policy=KnowsEverything()), seed=0
    )
    with pytest.raises(TeamformerError, match="run it by another method"):
        run.happen(NewTask(Task("late", (0, 0), {"lift": 1})))


@pytest.mark.parametrize("seed", range(4))
def test_who_plans_with_everything_knows_what_an_uncertain_mission_is(seed: int) -> None:
    """Who stands still when, and how long tasks take: it does in so many steps what it planned."""
    robots = [replace(robot("a", x), delays=Delays(0.5)) for x in (0, 9)]
    tasks = [replace(task("aa", x), lasts=(0, 9)) for x in (2, 7)]
    central = Central(time_limit=0.0)
    run = RunningMission(make(robots, tasks), lambda: Method("central", policy=central), seed)
    play(run, {})
    assert (run.tally().status, run.steps) == ("completed", central.plans[0].makespan)
    assert judge(run.record()).findings == ()


def planned(policy: str = "plan") -> RunningMission:
    """Return a mission of two lifters and five tasks whose robots go by a shared plan."""
    robots = [robot("a", 0), robot("a", 9)]
    tasks = [task("a", x, duration=2) for x in (1, 3, 5, 7, 8)]
    mission = make(robots, tasks)
    return RunningMission(mission, lambda: load_method(policy), seed=0)


def swapped(run: RunningMission) -> Plan:
    """Return the plan that holds with its robots exchanged."""
    old = run.past().env.plan()
    return replace(old, coalitions=tuple(tuple(1 - r for r in robots) for robots in old.coalitions))


def test_a_plan_that_is_taken_over_is_what_robots_go_by_and_the_record_says_so() -> None:
    run = planned()
    for _ in range(3):
        run.step()
    better, worse = forecast(run.past()), forecast(run.past().with_plan(swapped(run)))
    assert worse.ends > better.ends
    plan = swapped(run)
    run.happen(PlanTakenOver(plan, worse, better))
    play(run, {})
    assert run.steps == worse.ends[0]
    record = run.record()
    assert judge(record).findings == ()
    assert [(steps, made.reasons) for steps, made in record.plans] == [
        (0, ("start",)),
        (3, ("taken over",)),
    ]
    assert record.plans[1][1].coalitions == plan.coalitions
    assert any("an operator took over a longer search" in it.why for it in explain(record, 0))


def test_what_happens_after_a_plan_was_taken_over_leaves_the_past_as_it_was() -> None:
    run = planned()
    for _ in range(3):
        run.step()
    run.happen(PlanTakenOver(swapped(run), Forecast(1, (9,)), Forecast(1, (9,))))
    run.happen(NewTask(Task("extra", (2, 0), {"a": 1})))  # at the same moment
    run.step()
    run.happen(LostRobot(run.source.robots[0].name))
    play(run, {})
    record = run.record()
    assert judge(record).findings == ()
    assert (record.end.status, record.end.tasks_done) == ("completed", 6)
    assert record.plans[1][1].reasons == ("task appeared", "taken over")
    assert [steps for steps, _ in record.plans][:3] == [0, 3, 5]


def test_a_longer_search_is_never_worse_and_its_gain_is_what_comes() -> None:
    run = planned()
    run.step()
    run.happen(PlanTakenOver(swapped(run), Forecast(1, (9,)), Forecast(1, (9,))))
    found = search_plan(run.past(), seconds=0.2)
    assert found.forecast.ends[0] <= found.without.ends[0]
    assert found.without == forecast(run.past())
    run.happen(found)
    play(run, {})
    assert found.forecast.ends == (run.steps,)


def test_a_search_that_nobody_waits_for_ends_at_once() -> None:
    found = search_plan(planned().past(), seconds=3600, is_over=lambda: True)
    assert found.forecast.otherwise is not None
    assert (found.forecast.ends, found.forecast.otherwise.end) == ((), 0)  # nor is it played


def test_only_a_shared_plan_can_be_another() -> None:
    past = mission(method="join-all").past()
    with pytest.raises(TeamformerError, match="with this method robots follow no plan that could"):
        search_plan(past, 0.1)


def uncertain() -> RunningMission:
    """Return a mission of one robot with four tasks in its place, of one to nine steps each."""
    tasks = [replace(task("a", 0), name=f"t{n}", lasts=(1, 9)) for n in range(2)]
    tasks += [task("a", 1)]
    mission = make([robot("a", 0)], tasks)
    return RunningMission(mission, lambda: load_method("plan"), seed=4)


def test_an_uncertain_mission_is_forecast_as_a_band_that_narrows() -> None:
    """Two services at once of 1 to 9 steps from step 2 on, and a step to or from the last task."""
    run = uncertain()
    early = forecast(run.past())
    low, high = early.band
    assert early.futures == 40
    assert 3 <= early.ends[0] <= low < high <= early.ends[-1] <= 11
    for _ in range(3):
        run.step()
    assert forecast(run.past()).ends[0] > 3
    play(run, {})
    assert early.ends[0] <= run.steps <= early.ends[-1]
    assert forecast(run.past()).ends == (run.steps,) * 40


def test_futures_agree_with_what_has_been_seen() -> None:
    run = uncertain()
    for _ in range(4):
        run.step()
    past = run.past()
    real, seen = past.env.truths[0], past.env.worlds.tasks[0]
    for seed in range(30):
        truth = past.possible_truth(seed)
        for drawn, true, state in zip(truth.tasks, real.tasks, seen, strict=True):
            if state["done_at"] >= 0:
                assert drawn.duration == true.duration
            elif drawn.lasts is None and true.duration:
                assert drawn.duration > state["served"]


def test_in_futures_a_task_is_where_nobody_has_looked_yet() -> None:
    """It is within 4 of 10 in a corridor; the robot comes from 0 and sees a cell ahead."""
    hidden = replace(task("a", 10), within=4)
    mission = make([robot("a", 0)], [hidden])
    run = RunningMission(mission, lambda: load_method("plan"), seed=1)
    (real,) = draw_truth(mission, 1).tasks
    before: set[float] = set(range(6, 15))
    while run.is_running:
        past = run.past()
        found = {past.possible_truth(seed).tasks[0].at[0] for seed in range(60)}
        assert real.at[0] in found
        assert found <= before
        before = found
        run.step()
    assert found == {real.at[0]}


@pytest.mark.parametrize("steps", [2, 20, 40])
def test_breakdowns_in_futures_are_those_seen_or_later(steps: int) -> None:
    lame = replace(robot("a", 0), breaks=Breakdown(0.05, (5, 30)))
    mission = make([lame, robot("a", 0)], [task("a", 60)], Grid(70, 1))
    run = RunningMission(mission, lambda: load_method("join-fitting"), seed=3)
    real = draw_truth(mission, 3).robots[0].absences
    while run.steps < steps:
        run.step()
    been = [away for away in real if away.lost <= steps]
    for seed in range(30):
        drawn = run.past().possible_truth(seed).robots[0].absences
        seen, later = drawn[: len(been)], drawn[len(been) :]
        assert [away.lost for away in seen] == [away.lost for away in been]
        for one, other in zip(seen, been, strict=True):
            is_over = (other.back or 0) <= steps
            assert one.back == other.back if is_over else (one.back or 0) > steps
        assert all(away.lost > steps for away in later)
        assert all(two.lost > (one.back or 0) for one, two in pairwise(drawn))


def test_in_futures_nobody_breaks_down_after_the_trial() -> None:
    """A robot that is repaired for a billion steps is sound again when no step is left."""
    lame = replace(robot("a", 0), breaks=Breakdown(1.0, (10**9, 10**9)))
    mission = make([lame, robot("a", 0)], [task("a", 15)], step_limit=10**9)
    run = RunningMission(mission, lambda: load_method("join-fitting"), seed=3)
    for _ in range(3):
        run.step()
    for seed in range(3):
        drawn = run.past().possible_truth(seed).robots[0].absences
        assert drawn == (Absence(1, 10**9 + 1),)


def test_nobody_foresees_when_a_robot_stands_still() -> None:
    slow = replace(robot("a", 0), delays=Delays(0.5))
    mission = make([slow], [task("a", 15)])
    run = RunningMission(mission, lambda: load_method("plan"), seed=3)
    for _ in range(3):
        run.step()
    early = forecast(run.past())
    assert early.futures == 40
    assert early.ends[-1] - early.ends[0] > 8
    x = int(run.past().env.worlds.teams["x"][0, 0])
    assert early.mean == pytest.approx(3 + 2 * (15 - x), abs=4)


def test_incidents_make_sure_what_was_not() -> None:
    lame = replace(robot("a", 0), breaks=Breakdown(0.05, (5, 30)))
    mission = make([lame, robot("a", 0)], [task("a", 60)], Grid(70, 1))
    run = RunningMission(mission, lambda: load_method("join-fitting"), seed=3)
    play(run, {2: LostRobot("r0"), 4: RobotBack("r0")})
    assert run.source.robots[0].breaks is None
    assert run.source.robots[0].absences == (Absence(3, 5),)
    assert judge(run.record()).findings == ()


def test_a_load_on_its_way_is_set_down_by_an_incident_and_the_forecast_is_what_comes() -> None:
    """Three of five robots have the upright up; one is lost, and another takes its place."""
    run = mission("piano", "plan")
    while run.steps < 85:
        run.step()
    lose = LostRobot("dolly-3")
    undisturbed, disturbed = forecast(run.past()), forecast(run.past_with(lose))
    run.happen(lose)
    assert run.step().left[0][0] == 1
    play(run, {})
    assert undisturbed.ends == (104,)
    assert disturbed.ends == (run.steps,)
    assert run.steps > 104
    assert judge(run.record()).is_legal


@pytest.mark.parametrize("method", ["join-fitting", "plan"])
def test_a_task_that_is_called_off_is_in_the_record_that_run_makes_too(method: str) -> None:
    run = mission(method=method)
    for _ in range(3):
        run.step()
    undone = next(k for k in range(len(run.source.tasks)) if k not in run.ends())
    called_off = CancelledTask(run.source.tasks[undone].name)
    foreseen = forecast(run.past_with(called_off))
    run.happen(called_off)
    run_to_its_end(run)
    record = run.record()
    assert judge(record).findings == ()
    assert foreseen.ends == (record.end.makespan,)
    assert record.end.tasks_done == len(run.source.tasks) - 1
    assert run.source.tasks[undone].cancelled == 4
    again = run_trial(run.source, load_method(method))
    assert again.record.steps == record.steps
    assert again.record.end == record.end
    if method == "plan":
        assert "task cancelled" in dict(record.plans)[4].reasons


def test_calling_off_what_can_never_be_done_lets_the_mission_end() -> None:
    """One of two tasks needs `b`, who is lost in step 2, so that the mission is given up."""
    mission = make([robot("a", 0), robot("b", 1)], [task("b", 9), task("a", 5)])
    run = RunningMission(mission, lambda: load_method("plan"), seed=0)
    run.step()
    run.happen(LostRobot(mission.robots[1].name))
    run.step()
    assert run.tally().status == "infeasible"
    run.happen(CancelledTask(mission.tasks[0].name))
    assert run.is_running
    run_to_its_end(run)
    assert (run.tally().status, run.tally().steps, run.tally().tasks_done) == ("completed", 5, 1)
    assert judge(run.record()).findings == ()


def test_a_weight_that_is_raised_makes_another_plan() -> None:
    """From 5 the heavy one first; two steps to it, the other becomes heavier: 7 to it, 10 back."""
    mission = late_pair((3.0, 1.0), cost={"tardiness": 1})
    run = RunningMission(mission, lambda: load_method("plan"), seed=0)
    for _ in range(2):
        run.step()
    run.happen(NewWeight("right", 99.0))
    run.step()
    run.happen(
        NewTask(Task("between", (6, 0), {"a": 1}))
    )  # played again with the plan that was made
    run_to_its_end(run)
    record = run.record()
    assert judge(record).findings == ()
    assert {run.source.tasks[k].name: step for k, step in run.ends().items()} == {
        "between": 5,
        "right": 9,
        "left": 19,
    }
    assert dict(record.plans)[2].reasons == ("taken over",)


@pytest.mark.parametrize("later", [0, 1])
def test_a_weight_counts_for_crews_also_where_tasks_come_after_others(later: int) -> None:
    """`last` may begin when `near` is done; just then, or a step later, `far` becomes dear."""
    tasks = (
        Task("first", (10, 0), {"a": 1}),
        Task("next", (8, 0), {"a": 1}, after=("first",)),
        Task("near", (6, 0), {"a": 1}),
        Task("far", (20, 0), {"a": 1}, between=(0, 15)),
        Task("last", (0, 0), {"a": 1}, after=("near",)),
    )
    mission = Mission(
        "order",
        Grid(30, 1),
        ("a",),
        (Robot("r", (9, 0), {"a": 1}),),
        tasks,
        cost={"makespan": 1.0, "tardiness": 0.1},
    )
    run = RunningMission(mission, lambda: load_method("crews"), seed=0)
    for _ in range(3 + later):  # in the third step `near` is done: crews deal `last` out
        run.step()
    run.happen(NewWeight("far", 1000.0))
    run_to_its_end(run)
    record = run.record()
    assert judge(record).findings == ()
    assert dict(record.plans)[3 + later].reasons[-1] == "taken over"
    assert dict(record.orders)[3 + later] == (0, 3, 4, 1)


@pytest.mark.parametrize(
    ("incident", "why"),
    [
        (CancelledTask("near"), "task 'near' was done in step 3"),
        (CancelledTask("gone"), "task 'gone' was called off already"),
        (CancelledTask("nowhere"), "there is no task 'nowhere'"),
        (NewWeight("near", 2.0), "task 'near' was done in step 3"),
        (NewWeight("far", 2.0), "weights change nothing"),
    ],
)
def test_what_cannot_happen_to_a_task_is_refused(incident: Incident, why: str) -> None:
    tasks = (
        Task("near", (2, 0), {"a": 1}),
        Task("far", (9, 0), {"a": 1}),
        Task("gone", (8, 0), {"a": 1}, cancelled=3),
    )
    mission = replace(late_pair(), tasks=tasks)
    run = RunningMission(mission, lambda: load_method("plan"), seed=0)
    for _ in range(3):
        run.step()
    with pytest.raises(TeamformerError, match=why):
        run.happen(incident)
    assert run.incidents == []


def test_a_weight_counts_only_where_there_is_a_plan() -> None:
    mission = late_pair(cost={"tardiness": 1})
    run = RunningMission(mission, lambda: load_method("join-all"), seed=0)
    with pytest.raises(TeamformerError, match="with this method robots follow no plan"):
        run.happen(NewWeight("left", 2.0))
