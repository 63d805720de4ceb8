"""Coordinators: what crews do, what is asked when, and what is refused of plans."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pytest

from coordinations import play_by_plan
from small_worlds import done_at, make, robot, task
from teamformer.base.errors import TeamformerError
from teamformer.files.drawn.generate import Spec, generate
from teamformer.methods.coordinators.crews import Crews
from teamformer.methods.coordinators.on_command import OnCommand
from teamformer.methods.coordinators.replayed import Replayed
from teamformer.methods.coordinators.shared_plan import SharedPlan
from teamformer.methods.scripted.joining import JoinAll
from teamformer.mission.coordination import NEWS, Known, Plan
from teamformer.mission.model import Absence, Mission
from teamformer.record.referee import judge
from teamformer.trials.trial import run_trial, run_trials
from teamformer.world.env import Decision, TeamFormation


@dataclass
class Told:
    """A shared plan that remembers what it was told."""

    heeds: tuple[str, ...] = NEWS
    known: list[Known] = field(default_factory=list)
    old: list[Plan | None] = field(default_factory=list)

    def update(self, known: Known, plan: Plan | None) -> Plan:
        self.known.append(known)
        self.old.append(plan)
        return SharedPlan().update(known, plan)


def two_sides() -> Mission:
    """
    T . . A . . . U     A has two robots that can do both, r1 is lost in step 2; V appears after 1
    """
    robots = [robot("a", 3), replace(robot("a", 3), absences=(Absence(2),))]
    return make(robots, [task("a", 0), task("a", 7), task("a", 9, appears=1)])


def test_a_coordinator_is_told_what_happened_and_what_everybody_knows() -> None:
    told = Told()
    record = run_trial(two_sides(), told).record
    assert [(known.step, known.news) for known in told.known[:3]] == [
        (0, ("start",)),
        (1, ("task appeared",)),
        (2, ("robot lost",)),
    ]
    assert told.old[0] is None
    assert told.known[0].open_tasks == (0, 1)
    assert told.known[1].open_tasks == (0, 1, 2)
    assert told.known[2].robots == (0,)
    assert told.known[2].teams == ((0,),)
    done = [known.step for known in told.known if "task done" in known.news]
    ended = [n for n, step in enumerate(record.steps, 1) if step.done]
    assert done == ended[:-1]  # after the last there is nothing to plan


def chain() -> Mission:
    """
    A T . U . V . . .    A begins there; U comes after T, V after U, and T takes two steps
    """
    tasks = [task("a", 1, duration=2), task("a", 3), task("a", 5)]
    tasks[1] = replace(tasks[1], after=("t0",))
    tasks[2] = replace(tasks[2], after=("t1",))
    return make([robot("a", 0), robot("a", 8)], tasks)


def test_a_coordinator_is_told_what_tasks_come_after_that_is_not_over() -> None:
    told = Told()
    record = run_trial(chain(), told).record
    assert [known.step for known in told.known] == [0, 3, 5]
    assert told.known[0].open_tasks == told.known[0].possible_tasks == (0, 1, 2)
    assert [known.mission.tasks[2].after for known in told.known] == [("t1",), ("t1",), ()]
    assert [known.mission.tasks[1].after for known in told.known] == [("t0",), (), ()]
    assert record.end.makespan == 6  # 1 to T, 2 there, 2 to U; the other waits at V by then


def test_what_comes_after_others_is_possible_if_these_are_or_are_under_way() -> None:
    mission = chain()
    known = Known(mission, 0, (0, 1, 2), ((0, 0), (8, 0)), ((0,), (1,)), (0, 0))
    assert known.possible_tasks == (0, 1, 2)
    assert replace(known, open_tasks=(1, 2)).possible_tasks == ()  # the first has not appeared
    assert replace(known, open_tasks=(1, 2), under_way=((0, 3),)).possible_tasks == (1, 2)
    joint = replace(mission.tasks[1], needs={"a": 2})
    mission = replace(mission, tasks=(mission.tasks[0], joint, mission.tasks[2]))
    assert replace(known, mission=mission, teams=((0,),)).possible_tasks == (0,)


@dataclass(frozen=True)
class InThisOrder:
    """Has everybody who is there do tasks together, in an order of its own."""

    order: tuple[int, ...]
    heeds: tuple[str, ...] = ("task appeared",)

    def update(self, known: Known, plan: Plan | None) -> Plan:
        order = tuple(task for task in self.order if task in known.open_tasks)
        if plan is not None:
            order = known.open_tasks
        return Plan(order, (known.robots,) * len(order))


def test_tasks_are_moved_behind_those_that_they_come_after() -> None:
    record = run_trial(chain(), InThisOrder((2, 1, 0))).record
    assert [order for _, order in record.orders] == [(0, 1, 2)]
    assert record.end.status == "completed"
    assert judge(record).findings == ()


def test_so_they_are_where_a_task_between_them_is_left_out() -> None:
    """V comes after T by way of U, which is for nobody until V could begin otherwise."""
    record = run_trial(chain(), InThisOrder((2, 0))).record
    assert record.orders[0] == (0, (0, 2, 1))
    assert record.end.status == "completed"
    assert judge(record).findings == ()


def test_crews_keep_what_may_not_begin_yet_for_nobody() -> None:
    told = Told()
    run_trial(chain(), told)
    plan = Crews().update(told.known[0], None)
    assert plan.order == (0, 1, 2)
    assert plan.coalitions[1:] == ((), ())
    assert len(plan.coalitions[0]) == 1


def test_it_is_news_when_a_task_may_begin_that_the_plan_leaves_out() -> None:
    """V may begin when U is done, and nobody is to do it."""
    record = run_trial(chain(), InThisOrder((1, 0))).record
    done = {task: n for n, step in enumerate(record.steps, 1) for task, _ in step.done}
    assert [(steps, plan.reasons) for steps, plan in record.plans] == [
        (0, ("start",)),
        (done[1], ("task appeared",)),
    ]
    assert [order for _, order in record.orders] == [(0, 1, 2), (2,)]
    assert judge(record).findings == ()
    forged = replace(record, plans=record.plans[:1], orders=record.orders[:1])
    assert f"there is no plan made after {done[1]} steps" in str(judge(forged).findings)


def test_a_coordinator_hears_only_of_what_it_heeds() -> None:
    told = Told(heeds=("task appeared",))
    run_trial(two_sides(), told)
    assert [known.step for known in told.known] == [0, 1]


def test_crews_go_on_when_a_robot_is_lost() -> None:
    """One of two is lost on its way; the other does both tasks: 3 to T, 7 to U, 2 to V."""
    env = TeamFormation([two_sides()], coordinator=Crews())
    play_by_plan(env)
    assert env.tally().status == "completed"
    assert env.tally().steps <= 14
    assert done_at(env).count(None) == 0


def test_crews_do_large_missions_far_sooner_than_one_order_for_all() -> None:
    rng = np.random.default_rng(3)
    worlds = [generate(Spec(20, 60, 4), rng) for _ in range(6)]
    by_crews = sum(tally.steps for tally in run_trials(worlds, Crews()))
    by_order = sum(tally.steps for tally in run_trials(worlds, JoinAll()))
    assert by_crews < 0.6 * by_order


def test_on_command_teams_stay_where_no_task_is_named() -> None:
    env = TeamFormation([make([robot("a", 0)], [task("a", 3)])], coordinator=OnCommand())
    env.step(env.planned_decision(env.view()))
    assert env.worlds.teams["x"][0, 0] == 0
    env.step(Decision(env.view().counts, np.array([0])))
    assert env.worlds.teams["x"][0, 0] == 1


def test_replayed_plans_are_not_made_again_and_new_ones_only_where_something_else_happens() -> None:
    mission = two_sides()
    env = TeamFormation([mission], coordinator=SharedPlan())
    play_by_plan(env)
    told = Told()
    again = TeamFormation([mission], coordinator=Replayed(env.plans(), told))
    play_by_plan(again)
    assert again.tally() == env.tally()
    assert [known.step for known in told.known if known.news != ("task done",)] == []
    more = replace(
        mission, tasks=(*mission.tasks, replace(mission.tasks[0], name="new", appears=3))
    )
    told = Told(heeds=NEWS[:-1])
    other = TeamFormation([more], coordinator=Replayed(env.plans(), told))
    play_by_plan(other)
    assert [known.step for known in told.known] == [3]
    assert other.tally().status == "completed"


BY_NAME: Any = ("r0",)
"""A coalition as someone without a type checker may write it."""


@pytest.mark.parametrize(
    ("plan", "complaint"),
    [
        (Plan((0, 0), ((0,), (0,))), "has a task twice"),
        (Plan((0,), ()), "has 1 tasks and 0 coalitions"),
        (Plan((7,), ((0,),)), "has a task 7, which is none"),
        (Plan((0,), ((1,),)), "gives task 't0' to r1, who there together lack a"),
        (Plan((0,), ((5,),)), "to 5, which is lost or no robot; robots are numbers, from 0 to 1"),
        (Plan((0,), (BY_NAME,)), "to 'r0', which is lost or no robot"),
        (Plan((0,), ((0, 0),)), "gives task 't0' to a robot twice"),
        (Plan(scouts=((5, 0),)), "has a scout that is not there"),
    ],
)
def test_plans_that_robots_cannot_go_by_are_refused(plan: Plan, complaint: str) -> None:
    class Fixed:
        def update(self, known: Known, old: Plan | None) -> Plan:
            return plan

    mission = make([robot("a", 0), robot("b", 0)], [task("a", 2), task("b", 4)])
    with pytest.raises(TeamformerError, match=complaint):
        TeamFormation([mission], coordinator=Fixed())
