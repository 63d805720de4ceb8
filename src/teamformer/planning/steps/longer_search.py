"""A longer search for the shared plan from the present on, as `central` searches, by the clock."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial

from teamformer.mission.coordination import Known, Plan
from teamformer.planning.steps.shared_plan import kept_plan, shared_plan_of
from teamformer.planning.steps.situation import situation_of
from teamformer.planning.steps.solve import (
    begin_race,
    first_plan,
    from_best,
    from_coalitions,
    improve,
)
from teamformer.planning.steps.timed_plan import time_team_plan

CENTRAL = "central"
"""What such a plan is made from."""


def search_longer(
    known: Known,
    old: Plan,
    seconds: float,
    seed: int = 0,
    is_over: Callable[[], bool] = lambda: False,
) -> Plan:
    """Return the best plan found in some seconds on two threads; never worse than the old one.

    What is still to come in the mission is not looked at. It is no pure function of what is known,
    as what is found depends on the clock. `is_over` says that nobody waits for it any more.
    """
    begun = time.perf_counter()
    if not known.possible_tasks:
        return Plan(made_from="nothing")
    situation = situation_of(replace(known, open_tasks=known.possible_tasks))
    problem = situation.problem
    kept = time_team_plan(situation, kept_plan(situation, old))
    race = begin_race(kept, begun, begun + seconds, is_over)
    start = first_plan(situation)
    if start is not None:
        race.offer(start)
    coalitions = from_coalitions(problem, race, seed)
    jobs = [
        partial(improve, race, situation, from_best(race), seed),
        partial(improve, race, situation, coalitions, seed + 1),
    ]
    race.run(jobs, len(jobs))
    return shared_plan_of(situation, CENTRAL, race.plan)
