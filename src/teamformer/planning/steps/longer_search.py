"""A longer search for the shared plan from the present on, as `central` searches, by the clock."""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, wait
from dataclasses import replace

from teamformer.coordination import Known, Plan
from teamformer.planning.steps.initial import crew_plans
from teamformer.planning.steps.shared_plan import kept_plan, shared_plan_of
from teamformer.planning.steps.situation import situation_of
from teamformer.planning.steps.solve import (
    BestPlan,
    from_best,
    from_coalitions,
    improve,
    is_able,
)
from teamformer.planning.steps.timed_plan import time_team_plan

LOOK = 0.1
"""Seconds between two looks at whether anybody still waits."""

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
    problem, deadline = situation.problem, begun + seconds
    best = BestPlan(begun, time_team_plan(situation, kept_plan(situation, old)))
    for start in crew_plans(problem):
        if is_able(problem, start):
            best.offer(time_team_plan(situation, start))
    coalitions = from_coalitions(problem, best, seed)
    with ThreadPoolExecutor(2) as pool:
        work = [
            pool.submit(improve, best, situation, deadline, from_best(best), seed),
            pool.submit(improve, best, situation, deadline, coalitions, seed + 1),
        ]
        try:
            while wait(work, timeout=LOOK).not_done and not is_over():
                pass
        finally:
            best.stop()
        for done in work:
            done.result()
    return shared_plan_of(situation, CENTRAL, best.plan)
