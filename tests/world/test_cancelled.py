"""Tasks that are called off: nobody heads for them, what was begun ends, what comes after opens."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from coordinations import RandomPlans
from random_worlds import (
    random_decision,
    random_world,
    with_loads,
    with_precedence_and_windows,
    with_surprises,
)
from small_worlds import make, robot, task
from teamformer.base.errors import MissionError
from teamformer.methods.by_name import Player
from teamformer.methods.central.policy import Central
from teamformer.methods.coordinators.shared_plan import SharedPlan
from teamformer.methods.scripted.joining import JoinAll
from teamformer.mission.model import Absence, Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.mission.truth import draw_truth
from teamformer.planning.bounds.makespan import lower_bound
from teamformer.record.happenings import events
from teamformer.record.record import Record
from teamformer.record.referee import judge
from teamformer.record.task_times import cancelled_steps, done_steps, opening_steps
from teamformer.record.telling.whole import path_of_record
from teamformer.trials.trial import run_trial
from teamformer.world.env import TeamFormation
from twins import Twin


def with_cancelled(mission: Mission, rng: np.random.Generator) -> Mission:
    """Return the mission with more than half of its tasks called off."""
    tasks = (
        replace(task, cancelled=int(rng.integers(1, 10))) if rng.random() < 0.6 else task
        for task in mission.tasks
    )
    return replace(mission, tasks=tuple(tasks))


def played(mission: Mission, player: Player | None = None) -> Record:
    record = run_trial(mission, player or SharedPlan()).record
    assert judge(record).findings == ()
    return record


@pytest.mark.parametrize("is_plane", [False, True], ids=["grid", "plane"])
@pytest.mark.parametrize("kind", ["sure", "unsure", "loads", "after"])
@pytest.mark.thorough
def test_step_with_cancelled_tasks_is_what_the_plain_twin_does(is_plane: bool, kind: str) -> None:
    rng = np.random.default_rng(31 + is_plane)
    cancelled = freed = 0
    for number in range(60):
        mission = random_world(rng, is_plane=is_plane)
        if kind == "unsure":
            mission = with_surprises(mission, rng)
        if kind == "loads":
            mission = with_loads(mission, rng)
        if kind == "after":
            mission = with_precedence_and_windows(mission, rng)
        mission = with_cancelled(mission, rng)
        truth = draw_truth(mission, number)
        coordinator = [None, RandomPlans(number), SharedPlan()][number % 3]
        env = TeamFormation([mission], truths=[truth], coordinator=coordinator)
        twin = Twin(env)
        world = twin.world
        while env.is_running[0] and env.tally().steps < 40:
            view = env.view()
            serving = len(world.served)
            is_planned = coordinator is not None and rng.random() < 0.8
            decision = env.planned_decision(view) if is_planned else random_decision(view, rng)
            gone = len(world.cancelled)
            twin.step(view, decision)
            freed += serving > 0 and len(world.cancelled) > gone
        cancelled += len(world.cancelled)
    assert cancelled > 40
    assert freed > 2


@pytest.mark.parametrize("player", [SharedPlan(), JoinAll()], ids=["plan", "join-all"])
@pytest.mark.thorough
def test_records_of_missions_with_cancelled_tasks_are_legal(player: Player) -> None:
    rng = np.random.default_rng(8)
    cancelled = 0
    for number in range(40):
        mission = random_world(rng, is_plane=number % 2 == 0)
        mission = with_precedence_and_windows(mission, rng) if number % 3 else mission
        mission = with_loads(mission, rng) if number % 4 == 0 else mission
        record = played(with_cancelled(mission, rng), player)
        assert record.end.status in ("completed", "infeasible", "step limit")
        cancelled += len(cancelled_steps(record))
    assert cancelled > 30


def corridor(*tasks: Task, **changes: object) -> Mission:
    """Return a robot at 0 of a corridor of ten cells."""
    robots = (Robot("r", (0, 0), {"a": 1}),)
    return replace(Mission("corridor", Grid(10, 1), ("a",), robots, tasks), **changes)


def test_who_heads_for_it_turns_to_what_is_left() -> None:
    """By step 3 the robot is at 3 on its way to 9; it then turns back to 1, two steps away."""
    far = Task("far", (9, 0), {"a": 1}, cancelled=3)
    near = Task("near", (1, 0), {"a": 1}, appears=3)
    record = played(corridor(far, near))
    assert done_steps(record) == {1: 5}
    assert cancelled_steps(record) == {0: 3}
    assert (record.end.status, record.end.makespan, record.end.tasks_done) == ("completed", 5, 1)
    assert [plan.reasons for _, plan in record.plans] == [
        ("start",),
        ("task appeared", "task cancelled"),
    ]
    told = [event.text(record.mission) for event in events(record)]
    assert told == ["far called off", "near appears", "near done by r", "completed"]


def test_a_service_that_is_called_off_frees_who_serves() -> None:
    """It serves from step 3 on, for 9 steps; called off in step 5, it walks the 4 cells to 6."""
    long = Task("long", (2, 0), {"a": 1}, duration=9, cancelled=5)
    record = played(corridor(long, Task("next", (6, 0), {"a": 1}, appears=4)))
    assert done_steps(record) == {1: 9}


def test_what_is_done_in_time_is_not_called_off() -> None:
    record = played(corridor(Task("near", (2, 0), {"a": 1}, cancelled=3)))
    assert done_steps(record) == {0: 2}
    assert cancelled_steps(record) == {}


def test_what_would_be_done_in_the_same_step_is_called_off() -> None:
    """Tasks are called off before it is seen what is done."""
    record = played(corridor(Task("near", (2, 0), {"a": 1}, cancelled=2)))
    assert cancelled_steps(record) == {0: 2}
    assert (record.end.makespan, record.end.tasks_done) == (2, 0)
    assert path_of_record(record) == ()


def test_what_comes_after_it_waits_no_longer() -> None:
    """`second` opens when `first` is called off in step 4; the robot is at 4 then, and goes on."""
    first = Task("first", (9, 0), {"a": 1}, cancelled=4)
    second = Task("second", (6, 0), {"a": 1}, after=("first",))
    record = played(corridor(first, second))
    assert opening_steps(record) == [0, 4]
    assert done_steps(record) == {1: 6}


def test_what_is_called_off_before_it_appears_never_does() -> None:
    late = Task("late", (1, 0), {"a": 1}, appears=5, cancelled=5)
    record = played(corridor(late, Task("far", (9, 0), {"a": 1})))
    assert done_steps(record) == {1: 9}
    assert [steps for steps, _ in record.plans] == [0, 5]


def test_a_task_that_nobody_can_do_any_more_ends_no_mission_that_calls_it_off() -> None:
    """`b` is lost in step 2, and what needs it is called off in step 4."""
    mission = make([robot("a", 0), robot("b", 1)], [task("b", 9), task("a", 3)])
    lost = replace(mission.robots[1], absences=(Absence(2),))
    mission = replace(mission, robots=(mission.robots[0], lost))
    assert played(mission).end.status == "infeasible"
    tasks = (replace(mission.tasks[0], cancelled=4), mission.tasks[1])
    record = played(replace(mission, tasks=tasks))
    assert (record.end.status, record.end.makespan) == ("completed", 4)


def test_a_load_that_is_called_off_on_its_way_is_nobodys() -> None:
    """Taken up in step 2, at 5 in step 5; then free, 4 cells from 1."""
    load = Task("load", (2, 0), {"a": 1}, to=(9, 0), cancelled=5)
    back = Task("back", (1, 0), {"a": 1}, appears=5)
    record = played(corridor(load, back))
    assert done_steps(record) == {1: 9}
    assert [step.left for step in record.steps if step.left] == []


def test_the_bound_does_not_count_what_is_called_off() -> None:
    far, near = Task("far", (9, 0), {"a": 1}), Task("near", (2, 0), {"a": 1}, after=("far",))
    assert lower_bound(corridor(far, near)) == 9 + 7
    assert lower_bound(corridor(replace(far, cancelled=20), near)) == 2
    assert lower_bound(corridor(replace(far, cancelled=20))) == 0


def test_the_cost_is_of_what_was_done() -> None:
    """The mission ends in step 5; `near` ends in it, and weighs 3: (5 + 15) / 2."""
    far = Task("far", (9, 0), {"a": 1}, cancelled=3)
    near = Task("near", (1, 0), {"a": 1}, appears=3, weight=3)
    trial = run_trial(corridor(far, near, cost={"makespan": 1, "completion": 1}), SharedPlan())
    assert judge(trial.record).cost == 10


def test_who_plans_beforehand_says_that_it_cannot_know() -> None:
    with pytest.raises(
        MissionError, match="task 'far' is cancelled, which a plan made in advance cannot know"
    ):
        run_trial(corridor(Task("far", (9, 0), {"a": 1}, cancelled=3)), Central(time_limit=0.1))
