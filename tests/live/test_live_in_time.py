"""Missions in continuous time to which things happen: the present is forked, nothing is replayed.

What comes out must be what `run` makes of the mission with all that has happened to it.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from live_server import serving_session
from teamformer.base.errors import TeamformerError
from teamformer.files.mission_files import mission_from_tree, mission_to_tree
from teamformer.live.continuous import running_course
from teamformer.live.continuous.running_course import RunningCourse, nice
from teamformer.live.drawing.drafts import Draft
from teamformer.live.keeping.autosave import NAME, Autosave, Identity
from teamformer.live.keeping.resuming import play_again, read_autosave
from teamformer.live.running import forecasts
from teamformer.live.running.alarm import troubles_of
from teamformer.live.running.forecasts import Forecast, forecast
from teamformer.live.running.incidents import (
    CancelledTask,
    Happening,
    LostRobot,
    NewTask,
    NewWeight,
    PlanTakenOver,
    RobotBack,
    search_plan,
)
from teamformer.live.running.page_trees import news_of_move, record_so_far
from teamformer.live.running.what_if import luck_of, what_if
from teamformer.live.session import Session
from teamformer.methods.by_name import load_method
from teamformer.methods.coordinators.shared_plan import SharedPlan
from teamformer.mission.coordination import Known, Plan
from teamformer.mission.model import Absence, Breakdown, Delays, Mission, Task
from teamformer.mission.truth import draw_truth
from teamformer.record.files.reading import read_record
from teamformer.record.referee import judge
from teamformer.record.telling.latest import LatestTold
from teamformer.trials.trial import run_trial

Tree = dict[str, Any]

ROADS = "place,yard,hall,dock\nyard,0,3,5.5\nhall,4,0,2.5\ndock,6,2,0\n"
"""How long ways take; back they take longer or less."""


def mission(robots: Sequence[Tree], tasks: Sequence[Tree], **keys: Any) -> Mission:
    """Return a mission in continuous time: in a corridor of 20 cells, or elsewhere."""
    tree = {"teamformer": 1, "name": "small", "time": "continuous", "world": {"grid": [20, 1]}}
    return mission_from_tree(
        tree | {"capabilities": ["a", "b"], "robots": list(robots), "tasks": list(tasks)} | keys
    )


def one_walker(**keys: Any) -> Mission:
    """A robot at 0 walks to a task at 4, where it stays 1.5, and on to one at 10."""
    tasks = [{"name": "near", "at": [4, 0], "needs": ["a"], "duration": 1.5}]
    tasks += [{"name": "far", "at": [10, 0], "needs": ["a"]}]
    return mission([{"name": "r", "at": [0, 0], "can": ["a"]}], tasks, **keys)


def on_a_grid() -> Mission:
    """Pairs round a wall, one of them with a load, and one task after another."""
    rows = ["........", ".@@@@@..", "........"]
    robots = [{"name": f"r{n}", "at": [n, 0], "can": ["a"], "speed": 1 + n / 3} for n in range(3)]
    robots += [{"name": "s", "at": [7, 2], "can": ["b"]}]
    tasks = [
        {"name": "load", "at": [0, 2], "to": [7, 0], "needs": {"a": 2}, "duration": 1, "unload": 1},
        {"name": "pair", "at": [4, 2], "needs": ["a", "b"], "duration": 2.5},
        {"name": "then", "at": [0, 0], "needs": ["b"], "after": ["pair"]},
        {"name": "single", "at": [7, 1], "needs": ["a"]},
    ]
    return mission(robots, tasks, world={"rows": rows}, ends="home", forming=0.5)


def on_a_plane() -> Mission:
    robots = [{"name": f"r{n}", "at": [n, 0.5], "can": ["a"]} for n in range(3)]
    tasks = [
        {"name": f"t{n}", "at": [9.5 - n, 3 + n % 2], "needs": {"a": 1 + n % 2}, "duration": 0.7}
        for n in range(5)
    ]
    return mission(robots, tasks, world={"plane": [12, 8]})


def on_roads() -> Mission:
    robots = [{"name": f"r{n}", "at": "yard", "can": ["a"]} for n in range(3)]
    robots += [{"name": "s", "at": "dock", "can": ["b"]}]
    tasks = [
        {"name": "pair", "at": "hall", "needs": ["a", "b"], "duration": 2},
        {"name": "window", "at": "dock", "needs": ["a"], "between": [8, 30]},
        {"name": "haul", "at": "yard", "needs": {"a": 2}, "duration": 1},
        {"name": "look", "at": "hall", "needs": ["b"]},
    ]
    return mission(robots, tasks, world={"roads": ROADS})


def running(source: Mission, seed: int = 0, plans: Sequence[tuple[float, Plan]] = ()) -> Any:
    return RunningCourse(source, lambda: load_method("plan"), seed, plans)


def play(run: RunningCourse, deeds: Sequence[tuple[float, Happening]] = ()) -> RunningCourse:
    """Play a mission to its end; deeds come at their times, or once it is over."""
    for when, deed in deeds:
        if run.is_running and run.now < when:
            run.move(when - run.now)
        run.happen(deed)
    while run.is_running:
        run.move()
    return run


def as_run(run: RunningCourse) -> None:
    """Assert that the record is what `run` makes of the mission with all its incidents."""
    again = run_trial(run.source, load_method("plan"), run.seed).record
    assert run.record().events == again.events
    assert run.record() == again


def test_the_clock_passes_moments_and_what_happens_happens_at_its_time() -> None:
    """4 cells, 1.5 of service, 6 cells: all over at 11.5."""
    run = running(one_walker())
    run.move(3.0)
    assert (run.now, run.latest) == (3.0, {"now": 3.0, "events": []})
    run.move(1.0)
    assert [(at, kind) for at, kind, _ in run.latest["events"]] == [(4, "arrive"), (4, "serve")]
    run.move()  # until something happens
    assert (run.now, run.ends()) == (5.5, {0: 5.5})
    run.move(100.0)
    assert (run.now, run.status, run.ends()) == (11.5, "completed", {0: 5.5, 1: 11.5})
    as_run(run)


def test_an_incident_may_leave_no_time_for_an_optional_task() -> None:
    """Both are done at 11.5; with 2 more on the way the far one is not by 12."""
    source = one_walker(until=12)
    source = replace(source, tasks=(source.tasks[0], replace(source.tasks[1], optional=True)))
    assert play(running(source)).record().end.missed == ()
    run = play(running(source), [(1.0, NewTask(Task("extra", (4, 0), {"a": 1}, duration=2)))])
    assert (run.now, run.status, run.record().end.missed) == (7.5, "completed", ("far",))
    as_run(run)


def test_a_mission_that_is_looked_at_is_as_it_was_until_a_move_is_made(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """What others see in the middle of a move, and what is left if a coordinator fails."""
    run, seen = running(one_walker()), list[float]()

    def fail(self: SharedPlan, known: Known, plan: Plan | None) -> Plan:
        seen.append(run.now)
        raise TeamformerError("no plan today")

    run.happen(NewTask(Task("extra", (8, 0), {"a": 1})))
    before = run.record()
    monkeypatch.setattr(SharedPlan, "update", fail)
    with pytest.raises(TeamformerError, match="no plan today"):
        run.happen(NewTask(Task("more", (9, 0), {"a": 1})))
    assert seen == [0.001]
    assert run.record() == before
    assert len(run.incidents) == 1


DEEDS: Sequence[Sequence[tuple[float, Happening]]] = [
    [(2.5, LostRobot("r0"))],
    [(2.5, LostRobot("r0")), (3.25, RobotBack("r0"))],
    [(0.0, LostRobot("r1")), (0.0, RobotBack("r1")), (7.0, LostRobot("r0"))],
    [(1.2345, CancelledTask("pair"))],
]


def test_weights_of_optional_tasks_say_which_is_missed() -> None:
    """By 12 one robot can go to 8 on the one side or on the other, not to both."""
    weights = {"optional": True, "needs": ["a"]}
    tasks: list[Tree] = [weights | {"name": "left", "at": [2, 0], "weight": 1}]
    tasks += [weights | {"name": "right", "at": [18, 0], "weight": 2}]
    live = running(mission([{"name": "r", "at": [10, 0], "can": ["a"]}], tasks, until=12))
    live.move(1.0)
    incident = NewWeight("left", 5.0)
    found = what_if(live, incident, lambda: False).found
    assert found.ends == (10.0,)  # back over where it began
    live.happen(incident)
    while live.is_running:
        live.move(20.0)
    assert live.record().end.missed == ("right",)
    assert judge(live.record()).findings == ()


@pytest.mark.parametrize("source", [on_a_grid(), on_a_plane(), on_roads()])
@pytest.mark.parametrize("deeds", DEEDS)
def test_incidents_leave_a_record_that_run_makes_too(
    source: Mission, deeds: Sequence[tuple[float, Happening]]
) -> None:
    names = {task.name for task in source.tasks}
    cancelled = CancelledTask(source.tasks[1].name)
    given = [
        (at, cancelled if isinstance(it, CancelledTask) and it.task not in names else it)
        for at, it in deeds
    ]
    extra = NewTask(Task("extra", source.robots[0].at, {"a": 1}, 0.25))
    as_run(play(running(source), [*given, (max(at for at, _ in deeds), extra)]))


def test_a_forecast_is_what_then_comes() -> None:
    run = running(on_a_grid())
    run.move(3.7)
    lose = LostRobot("r0")
    undisturbed, disturbed = forecast(run.past()), forecast(run.past_with(lose))
    assert run.now == 3.7
    plain = play(running(on_a_grid()))
    assert undisturbed == Forecast(1, (plain.now,), done_at=done_at(plain))
    play(run, [(3.7, lose)])
    assert disturbed == Forecast(1, (run.now,), done_at=done_at(run))
    assert run.now > plain.now


def done_at(run: RunningCourse) -> tuple[float | None, ...]:
    return tuple(run.ends().get(task) for task in range(len(run.source.tasks)))


def test_an_incident_is_just_after_what_has_happened_at_this_moment() -> None:
    """What comes from outside is first of what happens at one moment, so it cannot be that one."""
    run = running(one_walker())
    run.happen(CancelledTask("far"))  # the plan was made at 0
    assert run.incidents[-1][0] == 0.001
    run.undo()
    run.move(2.5)
    run.happen(CancelledTask("far"))  # nothing has happened at 2.5
    assert run.incidents[-1][0] == 2.5
    run.undo()
    run.move(1 / 3)
    run.happen(CancelledTask("far"))  # 2.8333 is written in fewer places
    assert run.incidents[-1][0] == 2.834
    run.undo()
    run.move(3.9995 - run.now)
    run.happen(CancelledTask("far"))  # at 4 the robot arrives
    assert run.incidents[-1][0] == 3.9995
    assert run.source.tasks[1].cancelled == 3.9995
    run.happen(NewTask(Task("late", (1, 0), {"a": 1})))  # between this and 4
    assert 3.9995 < run.incidents[-1][0] < 4
    as_run(play(run))


def test_an_incident_that_is_undone_has_not_happened() -> None:
    plain, run = running(on_roads()), running(on_roads())
    for one in (plain, run):
        one.move(2.0)
        one.happen(NewTask(Task("late", (1, 0), {"b": 1})))
        one.move(1.0)
    run.happen(LostRobot("r0"))
    run.move(1.0)
    assert isinstance(run.undo(), LostRobot)
    assert (run.now, run.incidents) == (plain.now, plain.incidents) == (3.001, plain.incidents)
    assert play(run).record() == play(plain).record()
    run.undo()
    assert (run.now, run.source) == (2.0, on_roads())
    assert play(run).record() == play(running(on_roads())).record()
    with pytest.raises(TeamformerError, match="nothing has happened"):
        run.undo()


def test_a_mission_anew_is_as_it_was_drawn() -> None:
    run = play(running(on_roads()), [(1.0, LostRobot("r0"))])
    again = run.anew()
    assert (again.now, again.incidents, again.source) == (0.0, [], on_roads())
    assert play(again).record() == play(running(on_roads())).record()


def test_a_task_can_come_after_all_is_done() -> None:
    """All is over at 11.5 at cell 10; the task at 8 is known at 11.501, and 2 cells away."""
    run = play(running(one_walker()))
    run.happen(NewTask(Task("late", (8, 0), {"a": 1})))
    assert (run.is_running, run.now) == (True, 11.501)
    play(run)
    assert (run.status, run.now) == ("completed", pytest.approx(13.501))
    assert [event.kind for event in run.record().events].count("over") == 1
    as_run(run)


def test_a_mission_that_was_given_up_goes_on_when_a_robot_is_back() -> None:
    """Lost at 2 at cell 2, back at 2.001: 8 cells more and 1.5 of service."""
    run = running(one_walker())
    run.move(2.0)
    run.happen(LostRobot("r"))
    assert (run.status, run.now) == ("infeasible", 2.0)
    assert [trouble.what for trouble in troubles_of(run)] == ["r is lost", "not done: near, far"]
    assert next(trouble.why for trouble in troubles_of(run)) == "since 2"
    run.happen(RobotBack("r"))
    play(run)
    assert (run.status, run.now) == ("completed", pytest.approx(11.501))
    assert run.source.robots[0].absences == (Absence(2.0, 2.001),)
    as_run(run)


def test_calling_off_what_can_never_be_done_lets_the_mission_end() -> None:
    robots = [{"name": "r", "at": [0, 0], "can": ["a"]}, {"name": "s", "at": [0, 0], "can": ["b"]}]
    tasks = [
        {"name": "x", "at": [5, 0], "needs": ["a"]},
        {"name": "y", "at": [9, 0], "needs": ["b"]},
    ]
    run = running(mission(robots, tasks))
    run.move(1.0)
    run.happen(LostRobot("s"))
    assert run.status == "infeasible"
    run.happen(CancelledTask("y"))
    play(run)
    assert (run.status, run.now, run.ends()) == ("completed", 5.0, {0: 5.0})
    as_run(run)


@pytest.mark.parametrize(
    ("incident", "why"),
    [
        (CancelledTask("near"), "task 'near' was done at 5.5"),
        (CancelledTask("nowhere"), "there is no task 'nowhere'"),
        (NewWeight("near", 2.0), "task 'near' was done at 5.5"),
        (NewWeight("far", 2.0), "weights change nothing"),
        (LostRobot("nobody"), "there is no robot 'nobody'"),
        (RobotBack("r"), "robot 'r' is not lost"),
        (NewTask(Task("t", (99, 0), {"a": 1})), r"task 't' is at \[99, 0\], outside the map"),
    ],
)
def test_what_cannot_happen_is_refused_and_changes_nothing(incident: Happening, why: str) -> None:
    run = running(one_walker())
    run.move(6.0)
    before = run.record()
    with pytest.raises(TeamformerError, match=why):
        run.happen(incident)
    assert (run.incidents, run.record()) == ([], before)


def test_who_is_lost_is_not_lost_again_nor_back_twice() -> None:
    run = running(on_a_plane())
    run.move(1.5)
    run.happen(LostRobot("r0"))
    with pytest.raises(TeamformerError, match=r"was lost at 1\.5 already"):
        run.happen(LostRobot("r0"))
    run.move(0.5)
    run.happen(RobotBack("r0"))
    with pytest.raises(TeamformerError, match="came back at 2 already"):
        run.happen(RobotBack("r0"))
    as_run(play(run))


def test_who_plans_with_everything_is_not_surprised() -> None:
    run = RunningCourse(one_walker(), lambda: load_method("central", 0.2), 0)
    with pytest.raises(TeamformerError, match="run it by another method"):
        run.happen(LostRobot("r"))
    assert play(run).now == 11.5


def test_who_decides_step_by_step_is_refused() -> None:
    with pytest.raises(TeamformerError, match="step by step, which continuous time does not have"):
        RunningCourse(one_walker(), lambda: load_method("join-all"), 0)


def swapped(run: RunningCourse) -> Plan:
    """Return the plan that holds with two robots exchanged."""
    plan, other = run.past().course.rest(), {0: 1, 1: 0}
    coalitions = tuple(tuple(sorted(other.get(r, r) for r in robots)) for robots in plan.coalitions)
    return replace(plan, coalitions=coalitions, ends=())


def two_ways() -> Mission:
    """Robots at 5 and 15, and a task two cells from each."""
    robots = [{"name": f"r{n}", "at": [x, 0], "can": ["a"]} for n, x in enumerate((5, 15))]
    tasks = [{"name": f"t{n}", "at": [x, 0], "needs": ["a"]} for n, x in enumerate((3, 17))]
    return mission(robots, tasks, cost={"tardiness": 1, "makespan": 1})


def test_a_plan_that_is_taken_over_is_what_robots_go_by_and_the_record_says_so() -> None:
    """After 1 each robot is 1 from its task; then they go for that of the other, 13 away."""
    run = running(two_ways())
    run.move(1.0)
    worse = forecast(run.past().with_plan(swapped(run)))
    assert worse.ends == (14.0,)
    run.happen(PlanTakenOver(swapped(run), worse, forecast(run.past())))
    assert run.incidents[-1][1].text(run.source) == (
        "plan of central taken over: done after 14; before: done after 2"
    )
    plan = [event.plan for event in run.record().events if event.plan is not None][-1]
    assert plan.reasons == ("taken over",)
    found = search_plan(run.past(), 0.3)
    assert found.forecast.ends == (2.0,)
    run.happen(found)
    assert play(run).now == 2.0


def test_a_weight_that_is_raised_makes_another_plan() -> None:
    """From 5, both late: the heavy one first. Two steps on, the other one becomes heavier."""
    tasks = [
        {"name": name, "at": [x, 0], "needs": ["a"], "between": [0, 1], "weight": weight}
        for name, x, weight in (("left", 0, 3), ("right", 10, 1))
    ]
    robots = [{"name": "r", "at": [5, 0], "can": ["a"]}]
    run = running(mission(robots, tasks, cost={"tardiness": 1}))
    run.move(2.0)
    run.happen(NewWeight("right", 99.0))
    play(run)
    assert run.ends() == {1: 9.0, 0: 19.0}
    assert dict(run.record().end.late) == {"right": 8.0, "left": 18.0}


def test_what_an_incident_would_cost_is_what_it_costs_and_luck_is_told() -> None:
    run = running(on_a_plane())
    run.move(2.0)
    before = run.record()
    weighed = what_if(run.as_it_stands(), LostRobot("r0"), lambda: False)
    luck = luck_of(weighed, lambda: False)
    assert luck is not None
    assert luck >= 0
    assert weighed.to_tree()["at"] == 2.0
    assert run.record() == before
    play(run, [(2.0, LostRobot("r0"))])
    assert weighed.found.ends == (run.now,)
    assert weighed.without.ends == (play(running(on_a_plane())).now,)


def unsure(**changes: Any) -> Mission:
    """A robot with two tasks of 1 to 9 at cell 4, one after the other."""
    tasks = [{"name": f"t{n}", "at": [4, 0], "needs": ["a"], "duration": [1, 9]} for n in range(2)]
    robot = {"name": "r", "at": [0, 0], "can": ["a"]} | changes
    return mission([robot], tasks)


def test_an_uncertain_mission_is_forecast_as_a_band_that_narrows() -> None:
    """4 to walk, then two services of 1 to 9: done between 6 and 22."""
    run = running(unsure(), seed=4)
    early = forecast(run.past())
    assert early.futures == 40
    assert 6 <= early.ends[0] < early.ends[-1] <= 22
    run.move(9.0)
    assert run.has_shown_more == any(
        event.kind in ("overdue", "done") for event in run.record().events
    )
    later = forecast(run.past())
    assert later.ends[0] >= 9
    assert later.band[1] - later.band[0] < early.band[1] - early.band[0]
    play(run)
    assert early.ends[0] <= run.now <= early.ends[-1]
    assert forecast(run.past()).ends == (run.now,) * 40


def test_futures_agree_with_what_has_been_seen() -> None:
    run = running(unsure(), seed=4)
    real = draw_truth(run.source, 4)
    while run.is_running:
        run.move(0.5)
        world = run.past().course.world
        for seed in range(20):
            drawn = run.past().possible_truth(seed)
            for number, task in enumerate(drawn.tasks):
                if number in world.done:
                    assert task.duration == real.tasks[number].duration
                elif number in world.works:
                    assert run.now - world.works[number].begun <= task.duration <= 9
    for seed in range(5):
        course = run.past().future(seed).course  # nothing is open any more
        assert course.world.events == run.past().course.world.events


@pytest.mark.parametrize("when", [2.0, 20.0, 60.0])
def test_breakdowns_in_futures_are_those_seen_or_later(when: float) -> None:
    source = unsure()
    lame = replace(source.robots[0], breaks=Breakdown(0.05, (5.0, 30.0)))
    tasks = tuple(replace(task, lasts=None, duration=99.0) for task in source.tasks)
    run = running(replace(source, robots=(lame,), tasks=tasks), seed=3)
    real = draw_truth(run.source, 3).robots[0].absences
    run.move(when)
    been = [away for away in real if away.lost <= when]
    for seed in range(20):
        drawn = run.past().possible_truth(seed).robots[0].absences
        for one, other in zip(drawn, been, strict=False):
            assert one.lost == other.lost
            assert (one.back == other.back) if other.back <= when else (one.back > when)  # type: ignore[operator]
        assert all(away.lost > when for away in drawn[len(been) :])


def test_nobody_foresees_when_a_robot_stands_still() -> None:
    """16 cells at one a unit, in half of which it stands still: about 32 units."""
    source = unsure()
    slow = replace(source.robots[0], delays=Delays(0.5))
    tasks = (replace(source.tasks[0], at=(16, 0), lasts=None, duration=0.0),)
    run = running(replace(source, robots=(slow,), tasks=tasks), seed=3)
    run.move(3.0)
    early = forecast(run.past())
    assert early.ends[-1] - early.ends[0] > 8
    walked = run.past().course.world.next_place(0)
    left = 16 - walked.place[0]
    assert early.mean == pytest.approx(walked.at + 2 * left, abs=4)
    assert play(run).now <= early.ends[-1] + 10


def test_what_appears_at_random_appears_whatever_else_happens(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(forecasts, "SAMPLES", 5)
    source = replace(one_walker(arrivals={"rate": 0.2, "until": 30}), step_limit=0)
    plain = play(running(source, seed=2))
    calls = [(it.name, it.appears) for it in plain.truth.tasks[2:]]
    first = calls[0][1]
    run = running(source, seed=2)
    run.move(first + 0.5)
    assert forecast(run.past()).futures == 5
    extra = NewTask(Task("extra", (0, 0), {"a": 1}))
    play(run, [(first + 0.5, extra), (first + 3.5, NewTask(Task("other", (1, 0), {"a": 1})))])
    appeared = [(it.name, it.appears) for it in run.truth.tasks[2:]]
    assert [row for row in appeared if row[0] not in ("extra", "other")] == calls
    as_run(run)


def kept_while(folder: Path, deeds: Sequence[Happening | float | str]) -> RunningCourse:
    """Return a mission to which deeds were done, each kept: incidents, times that pass, undo."""
    run = running(on_roads())
    autosave = Autosave(folder / NAME, Identity("its own", Draft({"name": "small"}, "small.yaml")))
    autosave.begin(run)
    for deed in deeds:
        if deed == "undo":
            run.undo()
            autosave.undo()
        elif isinstance(deed, float):
            run.move(deed)
            autosave.move(run)
        else:
            assert not isinstance(deed, str | int)
            run.happen(deed)
            autosave.happen(run)
    autosave.release()
    return run


HISTORY: Sequence[Happening | float | str] = (
    *(0.7, NewTask(Task("extra", (1, 0), {"b": 1})), NewTask(Task("more", (2, 0), {"a": 1}, 2.5))),
    *(1 / 3, LostRobot("r0"), 0.9, CancelledTask("look"), 1.1, RobotBack("r0"), 0.2),
    *(LostRobot("r1"), 1.0, "undo", 1.0),
)


def test_a_mission_that_was_cut_off_goes_on_as_if_nothing_had_been(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """No plan is made again that was kept."""
    before = kept_while(tmp_path, HISTORY)
    kept = read_autosave(tmp_path / NAME)
    assert kept.text() == "mission 'small', time 4.235 and 5 incidents"
    update = SharedPlan.update
    monkeypatch.setattr(SharedPlan, "update", lambda *_: pytest.fail("planned"))
    again = play_again(kept, lambda source, plans: running(source, 0, plans))
    monkeypatch.setattr(SharedPlan, "update", update)
    assert (again.now, again.record()) == (before.now, before.record())
    assert again.incidents == before.incidents
    assert play(again).record() == play(before).record()  # type: ignore[arg-type]
    again.undo()
    before.undo()
    assert play(again).record() == play(before).record()  # type: ignore[arg-type]


def test_plans_of_an_operator_are_kept(tmp_path: Path) -> None:
    run = running(two_ways())
    autosave = Autosave(tmp_path / NAME, Identity("", Draft({})))
    autosave.begin(run)
    for happening in (search_plan(run.past(), 0.1), NewWeight("t1", 99.0)):
        run.move(0.5)
        autosave.move(run)
        run.happen(happening)
        autosave.happen(run)
    autosave.release()
    again = play_again(
        read_autosave(tmp_path / NAME), lambda *given: running(given[0], 0, given[1])
    )
    assert again.record() == run.record()
    told = [[it.text(one.source) for _, it in one.incidents] for one in (again, run)]
    assert told[0] == told[1]


def test_what_comes_out_otherwise_is_refused(tmp_path: Path) -> None:
    kept_while(tmp_path, [1.0, 2.0])
    header, first, second = (tmp_path / NAME).read_text().splitlines()
    changed = json.loads(second) | {"events": []}
    (tmp_path / NAME).write_text("\n".join([header, first, json.dumps(changed), ""]))
    with pytest.raises(TeamformerError, match="time 3 comes out otherwise than it did"):
        play_again(read_autosave(tmp_path / NAME), lambda *given: running(given[0], 0, given[1]))


def grown(tree: Tree, news: Tree) -> None:
    """Take a message of a moment in, as a page does."""
    assert news["from"] == len(tree["events"])
    tree["events"] += news["events"]
    told, more = tree["told"], news.get("told")
    if more is None:
        return
    for row, service in more["services"]:
        told["services"][row : row + 1] = [service]
    for robot, run in more["phases"]:
        told["phases"][robot].append(run)
    told["texts"] += more["texts"]
    told["path"] = more.get("path", told["path"])


@pytest.mark.parametrize("source", [on_a_grid(), on_a_plane(), on_roads()])
def test_what_pages_are_told_of_each_moment_adds_up_to_the_record(source: Mission) -> None:
    run, latest = running(source), LatestTold()
    tree = record_so_far(run.record(), run.is_running)
    while run.is_running:
        run.move(0.4)
        kind, news = news_of_move(run, latest)
        grown(tree, news)
        assert (kind, news["now"]) == ("moment", run.now)
        whole = record_so_far(run.record(), run.is_running)
        assert (tree["events"], tree["told"]) == (whole["events"], whole["told"])
    assert news["end"]["makespan"] == run.now
    assert tree["told"]["path"]


def test_the_speed_at_first_has_the_mission_take_about_a_minute() -> None:
    assert [nice(number) for number in (0.19, 0.5, 1.99, 7.0, 43.0)] == [0.1, 0.5, 1, 5, 20]
    assert running(one_walker()).usual_speed(4.0) == 0.1  # 11.5 by 60
    assert pytest.approx(running(one_walker()).beat(0.1)[1]) == running_course.BEAT * 0.1


def test_the_mission_with_its_incidents_is_a_file() -> None:
    run = play(running(on_roads()), [(2.5, LostRobot("r0")), (3.25, RobotBack("r0"))])
    assert mission_from_tree(mission_to_tree(run.source)) == run.source


def test_a_server_lets_time_pass_and_tells_everybody(tmp_path: Path) -> None:
    """Lost at 4.001 in its service, which begins anew at 4.002: 1.5 of it, and 6 cells more."""
    client = pytest.importorskip("websockets.sync.client")
    run = running(one_walker())
    with serving_session(Session(run, tmp_path, speed=100.0)) as served:
        origin = f"http://{served.address}"
        with client.connect(f"ws://{served.address}/socket", origin=origin) as line:

            def hear(kind: str, *asks: Tree) -> Tree:
                for ask in asks:
                    line.send(json.dumps(ask))
                while (told := json.loads(line.recv(timeout=30)))["kind"] != kind:
                    assert told["kind"] != "refused", told
                return dict(told)

            whole = hear("mission")
            assert (whole["now"], whole["speed"]) == (0, 100)
            assert [kind for _, kind, _ in whole["record"]["events"]] == ["plan", "walk"]
            first = hear("moment", {"do": "step"})
            assert (first["now"], first["from"]) == (4, 2)
            lost = hear("incident", {"do": "happen", "lost": "r"})
            assert lost["text"] == "time 4.001: robot r lost"
            assert lost["incidents"] == [[4.001, "robot r lost"]]
            assert lost["record"]["events"][-1][1] == "over"
            back = hear("incident", {"do": "happen", "back": "r"})
            assert (back["now"], back["text"]) == (4.002, "time 4.002: robot r back")
            last = hear("moment", {"do": "play"})
            while "end" not in last:
                last = hear("moment")
            assert last["end"]["status"] == "completed"
            assert last["now"] == pytest.approx(4.002 + 1.5 + 6)
            saved = hear("saved", {"do": "save"})
    record = read_record(Path(saved["paths"][0]))
    assert record == run.record()
    assert judge(record).is_legal
