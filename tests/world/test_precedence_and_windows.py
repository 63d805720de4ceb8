"""Tasks that come after others, and tasks that wait for their time, in steps."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from coordinations import RandomPlans
from random_worlds import random_decision, random_world, with_precedence_and_windows
from teamformer.methods.by_name import Player
from teamformer.methods.central.policy import Central
from teamformer.methods.coordinators.crews import Crews
from teamformer.methods.coordinators.shared_plan import SharedPlan
from teamformer.methods.scripted.heuristic import Heuristic
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.planning.bounds.makespan import lower_bound
from teamformer.record.happenings import events
from teamformer.record.record import Record
from teamformer.record.referee import judge
from teamformer.record.task_times import known_steps, lateness, opening_steps
from teamformer.trials.trial import run_trial
from teamformer.world.env import TeamFormation
from twins import Twin

CORRIDOR = Mission(
    "corridor",
    Grid(9, 1),
    ("a",),
    (Robot("r", (0, 0), {"a": 1}),),
    (
        Task("near", (2, 0), {"a": 1}, after=("far",)),
        Task("far", (8, 0), {"a": 1}, duration=1),
        Task("timed", (2, 0), {"a": 1}, between=(17.5, 18)),
    ),
)


def played(mission: Mission, player: Player | None = None) -> Record:
    return run_trial(mission, player or SharedPlan()).record


def test_what_comes_after_another_waits_for_it() -> None:
    """Past `near` to `far` in 8 steps and one of service, 6 back; `timed` opens after 18 steps."""
    record = played(CORRIDOR)
    done = {k: n for n, step in enumerate(record.steps, 1) for k, _ in step.done}
    assert done == {1: 9, 0: 15, 2: 19}
    assert known_steps(record) == [0, 0, 0]
    assert opening_steps(record) == [9, 0, 18]
    assert lateness(record) == {"timed": 1}
    assert [step for step, _ in record.plans] == [0]  # it is planned for, and no news
    assert not [event for event in events(record) if event.kind == "appears"]
    verdict = judge(record)
    assert verdict.is_legal
    assert verdict.late == {"timed": 1}


@pytest.mark.parametrize(
    ("player", "begin", "done"),
    [
        (SharedPlan(), 5, 8),  # it is under way when the window opens
        (SharedPlan(), 8, 9),  # it is there, and is done in the next step
        (SharedPlan(), 12, 13),  # it waits there
        (Crews(), 12, 13),
        (Central(0.5), 12, 13),
        (Heuristic(), 12, 20),  # the paper's order has it once it may begin
    ],
    ids=["on its way", "just there", "waits", "crews", "central", "heuristic"],
)
def test_plans_have_robots_there_when_a_window_opens(player: Player, begin: int, done: int) -> None:
    """8 steps to the task; the window ends in time for none of them to be late."""
    timed = Task("timed", (8, 0), {"a": 1}, between=(begin, 20))
    record = played(replace(CORRIDOR, tasks=(timed,)), player)
    assert record.end.makespan == done
    assert judge(record).findings == ()


def test_who_waits_for_a_window_forms_before_it_opens() -> None:
    """Both are there after 2 steps, are one in step 3, and wait for 7 more."""
    robots = Robot("r", (0, 0), {"a": 1}), Robot("s", (4, 0), {"a": 1})
    timed = Task("timed", (2, 0), {"a": 2}, between=(10, 11))
    record = played(replace(CORRIDOR, robots=robots, tasks=(timed,)))
    assert [n for n, step in enumerate(record.steps, 1) if step.joins] == [3]
    assert record.end.makespan == 11
    assert lateness(record) == {}
    assert judge(record).findings == ()


def test_a_window_that_has_not_begun_is_no_place_to_work() -> None:
    """A record that has the task done two steps too early is found."""
    timed = Task("timed", (2, 0), {"a": 1}, between=(10, 12))
    record = played(replace(CORRIDOR, tasks=(timed,)))
    early = replace(timed, between=(8, 12))
    forged = replace(played(replace(CORRIDOR, tasks=(early,))), mission=record.mission)
    told = [finding.message for finding in judge(forged).findings]
    assert "step 9: task timed cannot be done: it may begin after 10 steps" in told


def test_central_plans_what_cannot_but_be_late() -> None:
    """8 steps to `far`, which takes 4 and was to be done in 3; 6 back to `near`."""
    far = replace(CORRIDOR.tasks[1], duration=4, between=(0, 3))
    mission = replace(CORRIDOR, tasks=(CORRIDOR.tasks[0], far))
    record = played(mission, Central(time_limit=0.5))
    assert record.end.makespan == 18
    assert lateness(record) == {"far": 9}
    assert judge(record).findings == ()


def test_the_referee_finds_what_was_done_too_early() -> None:
    record = played(
        replace(CORRIDOR, tasks=(replace(CORRIDOR.tasks[0], after=()), *CORRIDOR.tasks[1:]))
    )
    forged = judge(replace(record, mission=replace(CORRIDOR, step_limit=record.mission.step_limit)))
    told = " ".join(finding.message for finding in forged.findings)
    assert "task near cannot be done: it comes after far" in told


@pytest.mark.parametrize("is_plane", [False, True], ids=["grid", "plane"])
def test_the_step_is_what_the_plain_twin_does(is_plane: bool) -> None:
    rng = np.random.default_rng(5)
    for number in range(40):
        mission = with_precedence_and_windows(random_world(rng, is_plane=is_plane), rng)
        coordinator = RandomPlans(number) if number % 3 else None
        env = TeamFormation([mission], coordinator=coordinator)
        twin = Twin(env)
        while env.is_running[0] and env.tally().steps < 60:
            view = env.view()
            twin.step(view, random_decision(view, rng))


@pytest.mark.parametrize(
    ("player", "worlds"),
    [(SharedPlan(), 20), (Crews(), 60), (Heuristic(), 60)],
    ids=["plan", "crews", "heuristic"],
)
@pytest.mark.thorough
def test_every_mission_ends_and_its_record_is_legal(player: Player, worlds: int) -> None:
    rng = np.random.default_rng(3)
    for number in range(worlds):
        mission = random_world(rng, is_plane=number % 3 == 0)
        mission = with_precedence_and_windows(mission, rng)
        record = played(mission, player)
        assert record.end.status in ("completed", "infeasible")
        verdict = judge(record)
        assert verdict.findings == ()
        assert verdict.late == lateness(record)


@pytest.mark.parametrize("player", [SharedPlan(), Central(0.5)], ids=["plan", "central"])
def test_robots_wait_for_what_comes_before_their_task(player: Player) -> None:
    """`pair` takes both robots: `s` waits there, and `r` brings what comes before it first."""
    mission = Mission(
        "before",
        Grid(9, 1),
        ("a", "b"),
        (Robot("r", (0, 0), {"a": 1}), Robot("s", (8, 0), {"b": 1})),
        (
            Task("pair", (6, 0), {"a": 1, "b": 1}, after=("first", "other")),
            Task("first", (2, 0), {"a": 1}, duration=2),
            Task("other", (7, 0), {"b": 1}),
        ),
    )
    record = run_trial(mission, player).record
    assert judge(record).is_legal
    assert record.end.makespan == 2 + 2 + 4 + 1  # the way, the service, the way, joining


def test_a_bound_counts_how_long_what_comes_before_takes() -> None:
    """8 steps to `far` and one there; another robot, that stands at `near`, may start next."""
    there = Robot("s", (2, 0), {"a": 1})
    mission = replace(CORRIDOR, robots=(*CORRIDOR.robots, there), tasks=CORRIDOR.tasks[:2])
    near, far = mission.tasks
    assert lower_bound(mission) == 6 + 1 + 1  # `s` can go to `far` as well
    assert lower_bound(replace(mission, tasks=(replace(near, after=()), far))) == 6 + 1


def test_a_record_with_a_task_planned_before_what_it_comes_after_is_found() -> None:
    record = played(replace(CORRIDOR, tasks=CORRIDOR.tasks[:2]))
    [(_, plan)] = record.plans
    forged = replace(record, orders=((0, (0, 1)),), plans=((0, plan),))
    assert "has task near before one that it comes after" in str(judge(forged).findings)


def test_central_is_never_slower_than_the_shared_plan() -> None:
    rng = np.random.default_rng(8)
    for _ in range(3):
        mission = with_precedence_and_windows(random_world(rng), rng)
        planned = run_trial(mission, Central(0.5)).record
        assert judge(planned).is_legal
        shared = played(mission).end
        if shared.makespan is not None:
            assert planned.end.makespan is not None
            assert planned.end.makespan <= shared.makespan
