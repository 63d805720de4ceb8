"""The peers by name, and their plans by the mission's own times."""

from __future__ import annotations

import time
from functools import partial

from teamformer.bench.peers.auction import auction
from teamformer.bench.peers.by_pyvrp import plan_by_pyvrp
from teamformer.bench.peers.by_vroom import plan_by_vroom
from teamformer.bench.peers.peer_plan import OutOfReachError, Peer, PeerPlan, makespan_of, plain
from teamformer.bench.peers.routing import route_copies
from teamformer.planning.continuous.continuous_mission import ContinuousMission
from teamformer.planning.continuous.cp_sat import solve_exactly
from teamformer.planning.continuous.solve import Solution
from teamformer.planning.problem.coalition_problem import CoalitionProblem
from teamformer.planning.problem.routes import MissionPlan

MOST_ARCS = 400_000
"""Robots times pairs of tasks from which on CP-SAT's model is not built: it takes gigabytes."""


def _cp_sat(problem: CoalitionProblem, seconds: float) -> PeerPlan | None:
    """Return what one thread of CP-SAT makes of the plan of one fair auction, and its bound.

    The plan is the auction's where CP-SAT finds none that is better.
    """
    arcs = len(problem.counts) * len(problem.needs) ** 2
    if arcs > MOST_ARCS:
        raise OutOfReachError(f"cp-sat is asked no missions with {arcs:,} arcs")
    begun = time.perf_counter()
    first = auction(problem, 0.0)
    if first is None:
        return None
    left = seconds - (time.perf_counter() - begun)
    found = solve_exactly(problem, first.plan, 0, left, is_large=True)
    plans = [plan for plan in (found.plan, first.plan) if plan is not None]
    return PeerPlan(min(plans, key=partial(makespan_of, problem)), found.bound)


PEERS: dict[str, Peer] = {
    "cp-sat": _cp_sat,
    "or-routing": route_copies,
    "auction": auction,
    "pyvrp": plan_by_pyvrp,
    "vroom": plan_by_vroom,
}


LIBRARIES = {"pyvrp": "pyvrp", "vroom": "vroom"}
"""What peers need of the extra `peers`; OR-Tools is there in any case."""


def plan_by_peer(mission: ContinuousMission, name: str, seconds: float) -> MissionPlan | None:
    """Return the plan that a peer makes in so many seconds; None if it finds none.

    Its times are worked out as those of our own plans. Raises `OutOfReachError` for a mission that
    it cannot be asked.
    """
    problem = plain(mission.problem, name)
    found = PEERS[name](problem, seconds)
    if found is None:
        return None
    makespan, bound = makespan_of(problem, found.plan), found.bound
    is_proven = bound > 0 and makespan <= bound
    return mission.tell(Solution(found.plan, (makespan, makespan), bound, is_proven))
