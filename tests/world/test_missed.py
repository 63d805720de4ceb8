"""Missions that are over at a step: what is missed and when, who begins nothing any more."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

from coordinations import RandomPlans
from random_worlds import (
    random_decision,
    random_world,
    with_loads,
    with_optional,
    with_precedence_and_windows,
    with_surprises,
)
from teamformer.methods.by_name import Player
from teamformer.methods.coordinators.crews import Crews
from teamformer.methods.coordinators.shared_plan import SharedPlan
from teamformer.methods.scripted.heuristic import Heuristic
from teamformer.methods.scripted.joining import JoinAll
from teamformer.mission.coordination import Known, Plan
from teamformer.mission.model import Absence, Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.mission.truth import draw_truth
from teamformer.record.files.reading import record_from_tree
from teamformer.record.files.writing import record_to_tree
from teamformer.record.happenings import events
from teamformer.record.record import Record
from teamformer.record.referee.judge import judge
from teamformer.record.task_times import cost_of_record, missed_tasks
from teamformer.trials.trial import run_trial
from teamformer.world.env import TeamFormation
from twins import Twin

METHODS = {
    "plan": SharedPlan(),
    "crews": Crews(),
    "join-all": JoinAll(),
    "heuristic": Heuristic(),
    "random plans": RandomPlans(5),
}


def drawn(rng: np.random.Generator, kind: str, is_plane: bool) -> Mission:
    mission = random_world(rng, is_plane=is_plane)
    if kind == "unsure":
        mission = with_surprises(mission, rng)
    if kind == "loads":
        mission = with_loads(mission, rng)
    if kind == "after":
        mission = with_precedence_and_windows(mission, rng)
    return with_optional(mission, rng)


@pytest.mark.parametrize("is_plane", [False, True], ids=["grid", "plane"])
@pytest.mark.parametrize("kind", ["sure", "unsure", "loads", "after"])
def test_step_with_missed_tasks_is_what_the_plain_twin_does(is_plane: bool, kind: str) -> None:
    rng = np.random.default_rng(41 + is_plane)
    given_up = 0
    statuses = set()
    for number in range(25):
        mission = drawn(rng, kind, is_plane)
        truth = draw_truth(mission, number)
        coordinator = [None, RandomPlans(number)][number % 2]
        env = TeamFormation([mission], truths=[truth], coordinator=coordinator)
        twin = Twin(env)
        while env.is_running[0]:
            view = env.view()
            is_planned = coordinator is not None and rng.random() < 0.8
            decision = env.planned_decision(view) if is_planned else random_decision(view, rng)
            twin.step(view, decision)
        steps, until = env.tally().steps, mission.until
        assert until is not None
        assert steps <= until
        assert max(env.ends().values(), default=0) <= until
        given_up += env.tally().status == "completed" and steps < until and bool(env.missed())
        statuses.add(env.tally().status)
    assert {"completed", "too late"} <= statuses
    assert given_up > 0


@pytest.mark.parametrize("name", METHODS)
def test_records_of_missions_with_missed_tasks_are_legal_and_kept(name: str) -> None:
    rng = np.random.default_rng(9)
    missed = 0
    for number, kind in enumerate(("sure", "unsure", "loads", "after") * 4):
        record = run_trial(drawn(rng, kind, number % 3 == 0), METHODS[name]).record
        assert judge(record).findings == ()
        assert record.end.status in ("completed", "too late", "infeasible")
        assert record_from_tree(record_to_tree(record), "it") == record
        names = [record.mission.tasks[task].name for task in missed_tasks(record)]
        assert sorted(names) == sorted(record.end.missed)
        missed += len(names)
    assert missed > 10


def corridor(*tasks: Task, until: float = 10, **changes: object) -> Mission:
    """Return a robot at 0 of a corridor of twenty cells."""
    robots = (Robot("r", (0, 0), {"a": 1}),)
    mission = Mission("corridor", Grid(20, 1), ("a",), robots, tasks, until=until)
    return replace(mission, **changes)


def played(mission: Mission, player: Player) -> Record:
    record = run_trial(mission, player).record
    assert judge(record).findings == ()
    return record


@dataclass(frozen=True)
class InTurn(SharedPlan):
    """Plans all tasks but one, in their order, for the only robot."""

    left_out: str = ""

    def update(self, known: Known, plan: Plan | None) -> Plan:
        tasks = known.mission.tasks
        order = tuple(k for k in known.possible_tasks if tasks[k].name != self.left_out)
        return Plan(order, ((0,),) * len(order))


def test_nobody_begins_what_cannot_end_in_time() -> None:
    """A task of 4 steps that is begun in step 6 ends in step 10, one begun in step 7 in step 11."""
    ends = {at: Task("t", (at, 0), {"a": 1}, 4, optional=True) for at in (6, 7)}
    for at, status in ((6, "done"), (7, "missed")):
        record = played(corridor(ends[at]), InTurn())
        assert record.end.status == "completed"
        kinds = [(it.kind, it.at) for it in events(record) if it.kind in ("done", "missed")]
        assert kinds == [(status, 10 if status == "done" else 6)]


def test_what_must_be_done_and_is_not_fails_the_mission() -> None:
    must = Task("must", (9, 0), {"a": 1})
    may = Task("may", (1, 0), {"a": 1}, 3, optional=True)
    record = played(corridor(may, must), InTurn())
    assert (record.end.status, record.end.makespan) == ("too late", None)
    assert missed_tasks(record) == {1: (10, "too late")}
    other = played(corridor(may, must), InTurn(left_out="may"))
    assert other.end.status == "too late"  # who stands at a task that it can do does it


def test_what_the_plan_leaves_out_is_given_up_when_all_else_is_done() -> None:
    near, far = Task("near", (2, 0), {"a": 1}), Task("far", (5, 0), {"a": 1}, optional=True)
    record = played(corridor(near, far), InTurn(left_out="far"))
    assert (record.end.status, record.end.makespan) == ("completed", 2)
    assert missed_tasks(record) == {1: (2, "nobody free")}
    cost = {"makespan": 1.0, "missed": 3.0}
    priced = played(corridor(near, far, cost=cost), InTurn(left_out="far"))
    assert missed_tasks(priced) == {1: (2, "not worth it")}
    assert cost_of_record(priced) == pytest.approx((2 + 3) / 4)
    assert played(corridor(near, far), JoinAll()).end.makespan == 5


def test_a_task_that_was_to_be_called_off_later_is_missed() -> None:
    near = Task("near", (2, 0), {"a": 1})
    far = Task("far", (5, 0), {"a": 1}, optional=True, cancelled=8)
    record = played(corridor(near, far), InTurn(left_out="far"))
    assert (record.end.status, record.end.missed) == ("completed", ("far",))


def test_a_load_that_does_not_get_there_in_time_is_not_taken_up() -> None:
    """Taken up in step 3, carried 6 cells and unloaded for 1: done in step 10."""
    for goal, missed in ((9, ()), (10, ("load",))):
        load = Task("load", (3, 0), {"a": 1}, to=(goal, 0), unload=1, optional=True)
        record = played(corridor(load), InTurn())
        assert record.end.missed == missed
        assert record.end.steps == (10 if not missed else 3)
    load = Task("load", (3, 0), {"a": 1}, to=(9, 0), unload=1, optional=True)
    assert played(corridor(load, until=9), InTurn()).end.missed == ("load",)


def test_a_service_that_takes_longer_than_believed_is_under_way_at_the_end() -> None:
    task = Task("t", (2, 0), {"a": 1}, 3, optional=True, lasts=(1, 9))
    mission = corridor(task)
    truth = replace(mission, tasks=(task.once_known(task.at, task.needs, 9),))
    record = run_trial(mission, InTurn(), truth=truth).record
    assert judge(record).findings == ()
    assert missed_tasks(record) == {0: (10, "under way")}


def test_what_is_missed_is_not_blocked_when_robots_are_lost_later() -> None:
    """The first task could not end by 10 if it began in step 4; in step 5 the robot is lost."""
    robot = Robot("r", (0, 0), {"a": 1}, absences=(Absence(5),))
    late, other = Task("late", (9, 0), {"a": 1}, 7), Task("other", (9, 0), {"a": 1})
    record = played(corridor(late, other, robots=(robot,)), InTurn())
    assert (record.end.status, record.end.blocked_tasks) == ("infeasible", ("other",))
    assert missed_tasks(record) == {0: (3, "too far")}


def test_what_comes_after_a_missed_task_may_begin() -> None:
    long = Task("long", (0, 0), {"a": 1}, 9, optional=True, between=(2, 99))
    short = Task("short", (1, 0), {"a": 1}, optional=True, after=("long",))
    record = played(corridor(long, short), InTurn())
    assert missed_tasks(record) == {0: (1, "too far")}
    assert (record.end.status, record.end.makespan) == ("completed", 2)


def test_the_referee_finds_what_is_missed_too_early_or_not_at_all() -> None:
    near, far = Task("near", (2, 0), {"a": 1}), Task("far", (5, 0), {"a": 1}, optional=True)
    record = played(corridor(near, far), InTurn())
    steps = list(record.steps)
    steps[2] = replace(steps[2], missed=((1, "nobody free"),))
    found = judge(replace(record, steps=tuple(steps))).findings
    assert "task far is missed" in found[0].message
    given_up = played(corridor(near, far), InTurn(left_out="far"))
    bare = replace(given_up, steps=(given_up.steps[0], replace(given_up.steps[1], missed=())))
    assert judge(bare).findings
