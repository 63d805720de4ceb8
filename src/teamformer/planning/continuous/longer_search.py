"""A longer search for a plan in continuous time from the present on, as `central` searches."""

from __future__ import annotations

from collections.abc import Callable

from teamformer.mission.coordination import Known, Plan
from teamformer.planning.continuous.continuous_mission import pose_present
from teamformer.planning.continuous.repair import repaired
from teamformer.planning.continuous.solve import solve

CENTRAL = "central"
"""What such a plan is made from."""

THREADS = 2


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
    if not known.possible_tasks:
        return Plan(made_from="nothing")
    posed = pose_present(known)
    start = repaired(posed, old) if old.order else None
    found = solve(posed.problem, seconds, seed, THREADS, start, is_over)
    return old if found is None else posed.as_plan(found.plan, CENTRAL)
