"""The referee on records with plans: what is legal is left alone, whoever planned."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from coordinations import RandomPlans
from random_worlds import random_world
from small_worlds import make, robot, task
from teamformer.methods.coordinators.crews import Crews
from teamformer.record.record import Ending, Record, SharedPlanMade
from teamformer.record.referee import judge
from teamformer.record.referee.plans.planned_tasks import PlannedTasks
from teamformer.record.referee.rules.completion import Tasks
from teamformer.record.referee.rules.lifecycle import start_fleet
from teamformer.record.referee.rules.verdict import Notes
from teamformer.trials.trial import run_trial
from test_forged_fields import wild_record


def test_legal_records_are_left_alone() -> None:
    """Random worlds with losses and late tasks, by plans of any kind and by random decisions."""
    rng = np.random.default_rng(5)
    for number in range(120):
        world = random_world(rng, is_plane=number % 4 == 0)
        coordinator = RandomPlans(number) if number % 2 else Crews()
        if number % 3:
            record = run_trial(world, coordinator).record
        else:
            record = wild_record(world, coordinator, number, rng)
        assert judge(record).findings == ()


def crossed(order: tuple[int, int], is_one_team: bool) -> Record:
    """Return a record before its first step, by a plan that gives T to r1 and U to r0.

    T . A . U     A has two robots that can do both
    """
    teams = ((0, 1),) if is_one_team else ()
    mission = make([robot("a", 2), robot("a", 2)], [task("a", 0), task("a", 4)], teams=teams)
    who = {0: (1,), 1: (0,)}
    plan = SharedPlanMade(("start",), tuple(who[number] for number in order))
    start = ((0, (0, 1), 2, 0),) if is_one_team else ((0, (0,), 2, 0), (1, (1,), 2, 0))
    end = Ending("interrupted", None, 1, 0, 0, 0, 0)
    return Record(mission, "by hand", 0, ((0, order),), start, (), end, plans=((0, plan),))


def test_a_team_is_due_at_the_task_that_comes_first_in_the_order() -> None:
    """Not at the one with the lower number, nor at the one of its lowest robot alone."""
    for order, due in (((1, 0), 1), ((0, 1), 0)):
        record = crossed(order, is_one_team=True)
        fleet = start_fleet(record, Notes())
        lists = PlannedTasks(record)
        lists.begin_step(0)
        lists.give_tasks(fleet, Tasks(record.mission), 0)
        assert fleet.teams[0].due == due


def test_a_union_made_on_the_way_is_due_at_the_earlier_task_if_both_have_one() -> None:
    for order, due in (((1, 0), 1), ((0, 1), 0)):
        record = crossed(order, is_one_team=False)
        lists, fleet = PlannedTasks(record), start_fleet(record, Notes())
        lists.begin_step(0)
        lists.give_tasks(fleet, Tasks(record.mission), 0)
        assert [fleet.teams[slot].due for slot in (0, 1)] == [1, 0]
        assert lists.tasks_of_unions(fleet, [(0, 1)]) == {frozenset({0, 1}): due}
        fleet.teams[1].due = None
        assert lists.tasks_of_unions(fleet, [(0, 1)]) == {frozenset({0, 1}): None}


def test_a_plan_may_leave_a_task_for_later_but_not_to_robots_that_cannot_do_it() -> None:
    mission = make([robot("a", 0), robot("b", 0)], [task("a", 2), task("b", 4)])
    record = run_trial(mission, Crews()).record
    assert judge(record).findings == ()
    [(made, plan)] = record.plans
    swapped = plan._replace(coalitions=plan.coalitions[::-1])
    found = [
        finding.message for finding in judge(replace(record, plans=((made, swapped),))).findings
    ]
    assert any("has a coalition for task" in message for message in found)
