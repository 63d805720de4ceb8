"""The referee on records with plans: what is legal is left alone, whoever planned."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from coordinations import RandomPlans
from random_worlds import random_world
from small_worlds import make, robot, task
from teamformer.methods.coordinators.crews import Crews
from teamformer.record.referee import judge
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
