"""Advice: changes by hand, gains that running the changed mission confirms, noise that is luck."""

from __future__ import annotations

import itertools
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import teamformer as tf
from small_worlds import make, robot, task
from teamformer.base.errors import TeamformerError
from teamformer.files.mission_files import write_mission
from teamformer.mission.model import Absence, Mission
from teamformer.mission.orders import in_order
from teamformer.record.critical_path.stretches import Stretch
from teamformer.trials.advice.advise import advise_on
from teamformer.trials.advice.changes import changes_of
from teamformer.trials.advice.measuring import PlannedSearch, goes_as_planned, search, searched
from teamformer.trials.advice.suggestions import Advice
from teamformer.trials.noise import Noise
from teamformer.viewer.advice_page import advice_page
from typed import teamformer

PLENTY = 1000.0  # seconds


def two_far_tasks() -> Mission:
    """Robots r0 and r1 can a, r2 can b, all at 0; tasks: a at 10, a at 12 with 4 of work, b at 3.

    t1 takes 12 and 4: 16. r0 does t0, r1 t1, r2 t2.
    """
    robots = [robot("a", 0), robot("a", 0), robot("b", 0)]
    return make(robots, [task("a", 10), task("a", 12, duration=4), task("b", 3)])


def makespans(advice: Advice) -> dict[str, float]:
    return {it.change: it.makespan for it in advice.suggestions}


def test_changes_are_what_they_say() -> None:
    mission = replace(two_far_tasks(), teams=((0, 1),))
    changes = {change.what: change for change in changes_of(mission)}
    assert list(changes) == [
        "one more robot like r0",
        "one more robot like r2",
        "one fewer robot like r0",
        "without robot r2",
        "r0 at double speed",
        "r2 at double speed",
        "all robots like r0 at double speed",
        "robots like r0 can also b",
        "robots like r0 can also c",
        "r2 can also a",
        "r2 can also c",
        "without task t0",
        "without task t1",
        "without task t2",
    ]
    more = changes["one more robot like r0"].mission
    assert more is not None
    assert more.robots[3] == replace(mission.robots[0], name="r0-2")
    fewer = changes["one fewer robot like r0"].mission
    assert fewer is not None
    assert fewer.robots == (mission.robots[0], mission.robots[2])
    assert fewer.teams == ()  # the other one of the team is gone
    assert changes["without robot r2"].mission is None  # nobody else can b
    taught = changes["robots like r0 can also b"].mission
    assert taught is not None
    both = {"a": 1, "b": 1}
    assert [dict(one.can) for one in taught.robots] == [both, both, {"b": 1}]
    faster = changes["all robots like r0 at double speed"].mission
    assert faster is not None
    assert [one.speed for one in faster.robots] == [2, 2, 1]
    left = changes["without task t1"].mission
    assert left is not None
    assert [one.name for one in left.tasks] == ["t0", "t2"]


def test_missions_in_steps_that_have_a_cost_are_measured_by_it() -> None:
    """t2 is done after 3 steps, t0 after 10, t1 after 12 and 4 of work: the mean of 16 and 29."""
    mission = replace(two_far_tasks(), cost={"makespan": 1, "completion": 1})
    assert search(PlannedSearch(0, mission, "plan")).value == (16 + (3 + 10 + 16)) / 2


def test_a_robot_that_is_lost_could_be_kept() -> None:
    lost = replace(robot("a", 0), absences=(Absence(5, 9), Absence(20, 30)))
    changes = {
        it.what: it.mission for it in changes_of(make([robot("a", 0), lost], [task("a", 3)]))
    }
    assert "r0 is not lost" not in changes
    kept = changes["r1 is not lost"]
    assert kept is not None
    assert [one.absences for one in kept.robots] == [(), ()]


def test_who_has_shifts_works_for_longer() -> None:
    worker = replace(robot("a", 0), shifts=((0, 4), (6, 10)), every=10.5)
    clock = {"time": "continuous", "step_limit": 0}
    mission = replace(make([robot("a", 0)], [task("a", 3)]), robots=(worker,), **clock)
    found = {it.what: it.mission for it in changes_of(mission) if it.kind == "longer"}
    shifts = {what: it and it.robots[0].shifts for what, it in found.items()}
    assert shifts == {
        f"{worker.name} works 0.5 longer in the last shift": ((0, 4), (6, 10.5)),
        f"{worker.name} works without breaks": ((0, 10),),
    }
    once = replace(mission, robots=(replace(worker, shifts=((0, 8),), every=0.0),))
    [longer] = [it for it in changes_of(once) if it.kind == "longer"]
    assert longer.mission is not None
    assert longer.mission.robots[0].shifts == ((0, 10),)


def test_a_new_robot_is_not_lost_as_the_one_that_it_is_like() -> None:
    mission = make([replace(robot("a", 0), absences=(Absence(5, 9),))], [task("a", 3)])
    more = next(iter(changes_of(mission))).mission
    assert more is not None
    assert more.robots[1].absences == ()


def test_who_waits_for_a_task_that_is_left_out_waits_for_what_that_waited_for() -> None:
    mission = make([robot("a", 0)], [task("a", 1), task("a", 2), task("a", 3)])
    first, second, third = mission.tasks
    tasks = (first, replace(second, after=("t0",)), replace(third, after=("t1",)))
    changes = {it.what: it.mission for it in changes_of(replace(mission, tasks=tasks))}
    without = changes["without task t1"]
    assert without is not None
    assert [it.after for it in without.tasks] == [(), ("t0",)]


def test_orders_are_the_same_mission_written_otherwise() -> None:
    mission = make(
        [robot("a", 0), robot("b", 0), robot("c", 3), robot("a", 5), robot("b", 3)],
        [task("ab", 7), task("bc", 1), task("a", 9, duration=2), task("abc", 15)],
        teams=((0, 1), (2, 4)),
    )
    assert in_order(mission, 0) is mission
    other = in_order(mission, 3)
    assert other != mission
    assert sorted(other.robots, key=lambda it: it.name) == sorted(
        mission.robots, key=lambda it: it.name
    )
    assert {it.name for it in other.tasks} == {it.name for it in mission.tasks}
    named = {frozenset(other.robots[robot].name for robot in team) for team in other.teams}
    assert named == {
        frozenset(mission.robots[robot].name for robot in team) for team in mission.teams
    }


def test_gains_are_what_hand_arithmetic_says_and_running_confirms() -> None:
    """16 as it is. Without t1, t0 takes 10. Double speed of r0, which then does t1: 6 and 4."""
    mission = two_far_tasks()
    advice = advise_on(mission, PLENTY)
    assert advice.makespan == advice.written == tf.run(mission).makespan == 16
    takes = makespans(advice)
    assert takes["without task t1"] == 10
    assert takes["r0 at double speed"] == 10
    assert takes["one more robot like r0"] == 16
    assert takes["one fewer robot like r0"] == 16  # both are on one way: 10, then 2 and 4
    assert [it.what for it in advice.impossible] == ["without robot r2"]
    assert [it.change for it in advice.spare] == ["one fewer robot like r0"]
    gains = [it.gain for it in advice.suggestions]
    assert gains == sorted(gains, reverse=True)
    assert {(it.noise, it.searches) for it in advice.suggestions} == {(0, 7)}
    for it in (advice.suggestions[0], advice.suggestions[-1]):
        assert tf.run(it.mission).makespan == it.makespan == 16 - it.gain
    assert {it.change for it in advice.helpful} >= {"without task t1", "r0 at double speed"}


@pytest.mark.thorough
def test_in_continuous_time_plans_are_compared_and_costs_where_there_are_any() -> None:
    """At 2.5 each of work t1 takes 12 and 2.5; as cost the ways count, 12 to t1 by t0 and 3."""
    mission = replace(two_far_tasks(), time="continuous")
    tasks = tuple(replace(it, duration=2.5 if it.name == "t1" else 0) for it in mission.tasks)
    mission = replace(mission, tasks=tasks)
    advice = advise_on(mission, PLENTY)
    assert advice.makespan == 14.5
    assert makespans(advice)["without task t1"] == 10
    costly = advise_on(replace(mission, cost={"travel": 1.0}), 0.0)
    assert costly.row["measure"] == "cost"
    assert costly.makespan == 15


def test_luck_is_no_advice() -> None:
    """Fair coins: of 50 changes that change nothing, the best is above the noise in 5 of 100."""
    rng = np.random.default_rng(1)
    wrong = 0
    for _ in range(60):
        own, others = rng.normal(50, 3, 21), rng.normal(50, 3, (50, 7))
        noise = Noise([own, *others]).of_gain(7, 21, 50)
        wrong += np.median(own) - min(np.median(others, axis=1)) > noise
        assert noise > 1
    assert wrong <= 9


def test_what_there_was_no_time_for_is_told() -> None:
    advice = advise_on(two_far_tasks(), 0.0)
    assert advice.searches == 3  # the mission itself
    assert advice.suggestions == ()
    assert len(advice.unmeasured) == 13
    assert [it.what for it in advice.impossible] == ["without robot r2"]


def test_it_ends_in_time_and_says_how_long_it_goes_on() -> None:
    """By a clock that goes on by a second whenever it is looked at: 24 s are for 12 searches."""
    ticks = itertools.count()
    told: list[tuple[int, float]] = []
    advice = advise_on(
        two_far_tasks(), 24.0, 1, lambda *seen: told.append(seen), lambda: float(next(ticks))
    )
    seconds = [23.0, 21.0, 20.0, 18.0, 16.0, 14.0, 12.0, 10.0, 8.0, 6.0, 4.0, 2.0]
    assert told == list(enumerate(seconds, start=1))
    assert (advice.searches, len(advice.suggestions), len(advice.unmeasured)) == (3, 9, 4)


def test_what_the_end_hangs_on_is_measured_first() -> None:
    """t1 takes all 16 steps, by a robot like r0."""
    path = [Stretch(0, 12, "walking", 1, 1), Stretch(12, 16, "serving", 1, 1)]
    share = {it.what: it.share_of(path) for it in changes_of(two_far_tasks())}
    assert {what for what, steps in share.items() if steps} == {
        "one more robot like r0",
        "one fewer robot like r0",
        "all robots like r0 at double speed",
        "robots like r0 can also b",
        "robots like r0 can also c",
        "without task t1",
    }
    assert set(share.values()) == {0, 16}


def test_a_mission_that_is_not_done_is_refused() -> None:
    mission = make([robot("a", 0, lost=2)], [task("a", 5)])
    with pytest.raises(TeamformerError, match="nothing to compare"):
        advise_on(mission, PLENTY)


@pytest.mark.slow
def test_the_first_advice_on_the_warehouse_is_confirmed_by_running_it() -> None:
    mission = tf.load(Path(__file__).parents[2] / "examples" / "warehouse.yaml")
    advice = advise_on(mission, PLENTY)
    first, own = advice.suggestions[0], tf.run(mission).makespan
    assert first.is_sure
    assert own == advice.written
    found = tf.run(first.mission).makespan
    assert found is not None
    assert found < own
    assert abs(found - first.makespan) <= advice.most - advice.least


@pytest.mark.slow  # each process loads everything
def test_processes_find_the_same() -> None:
    jobs = [
        PlannedSearch(number, change.mission, "plan", order)
        for number, change in enumerate(changes_of(two_far_tasks()))
        if change.mission is not None
        for order in (0, 1)
    ]
    found = {(job.about, job.order): result.value for job, result in searched(jobs, 2)}
    assert found == {(job.about, job.order): search(job).value for job in jobs}


@pytest.mark.thorough
def test_the_command_prints_and_draws_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file, page = tmp_path / "mission.yaml", tmp_path / "advice.html"
    write_mission(two_far_tasks(), file)
    assert teamformer("advise", str(file), str(page), "--json") == 0
    row = json.loads(capsys.readouterr().out)
    assert row["makespan"] == 16
    assert row["advice"][0]["gain"] == 6
    assert row["advice"][0].keys() >= {"change", "makespan", "gain", "noise"}
    text = page.read_text(encoding="utf-8")
    assert text == advice_page(row)
    assert text.count('class="wins"') == sum(it["gain"] > it["noise"] for it in row["advice"])
    assert "Impossible: without robot r2." in text
    assert teamformer("advise", str(file), "--time-limit", "60") == 0
    said = capsys.readouterr().out
    assert "small: takes 16 steps by plan, the median of 21 searches (16 to 16)" in said
    assert "could be spared: one fewer robot like r0 (then it takes 16)" in said
    assert teamformer("advise", str(tmp_path / "none.yaml")) == 2
    capsys.readouterr()
    assert teamformer("advise", str(file), "--time-limit", "0", "--json") == 0
    printed = capsys.readouterr()
    assert "no time for 13 changes; a longer --time-limit measures more" in printed.err
    assert len(json.loads(printed.out)["unmeasured"]) == 13


@pytest.mark.thorough
def test_the_command_advises_on_missions_whose_tasks_are_called_off(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    mission = two_far_tasks()
    gone = replace(mission.tasks[0], name="gone", cancelled=3)
    write_mission(replace(mission, tasks=(*mission.tasks, gone)), tmp_path / "mission.yaml")
    assert teamformer("advise", str(tmp_path / "mission.yaml"), "--json") == 0
    row = json.loads(capsys.readouterr().out)
    assert "without task gone" in [change["change"] for change in row["advice"]]


def test_the_command_writes_no_page_over_a_mission(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "mission.yaml"
    write_mission(two_far_tasks(), file)
    before = file.read_bytes()
    assert teamformer("advise", str(file), str(file)) == 2
    assert "mission.yaml: the advice is a page" in capsys.readouterr().err
    assert file.read_bytes() == before


def test_a_mission_in_continuous_time_to_which_something_happens_is_run() -> None:
    """One of two is lost at 2 on its way to the task at 9: the other comes from 0, at 9 + 1.

    Planned beforehand it would take 4: nobody foresees a loss.
    """
    robots = (
        tf.Robot("far", (0, 0), {"a": 1}),
        tf.Robot("near", (5, 0), {"a": 1}, absences=(Absence(2.0),)),
    )
    tasks = (tf.Task("t", (9, 0), {"a": 1}, duration=1.0),)
    mission = Mission("lost", tf.Grid(20, 1), ("a",), robots, tasks, time="continuous")
    assert not goes_as_planned(mission)
    assert goes_as_planned(replace(mission, robots=robots[:1]))
    advice = advise_on(mission, PLENTY)
    assert (advice.makespan, advice.written) == (12.0, 12.0)  # it sets out once the other is lost
    gains = {it.change: it.gain for it in advice.suggestions}
    assert gains["near is not lost"] == 7.0


def test_what_is_not_known_in_continuous_time_is_luck_of_what_is_drawn() -> None:
    """A robot at its task of 2 to 6: so long each search takes, and no change is sure to help."""
    tasks = (tf.Task("t", (0, 0), {"a": 1}, duration=4.0, lasts=(2.0, 6.0)),)
    mission = Mission(
        "unsure",
        tf.Grid(9, 1),
        ("a",),
        (tf.Robot("r", (0, 0), {"a": 1}),),
        tasks,
        time="continuous",
    )
    advice = advise_on(mission, PLENTY)
    assert 2 <= advice.least < advice.makespan < advice.most <= 6
    assert advice.helpful == ()
