"""The peers by name, and their plans by the mission's own times."""

from __future__ import annotations

from teamformer.bench.peers.auction import auction
from teamformer.bench.peers.by_pyvrp import plan_by_pyvrp
from teamformer.bench.peers.by_vroom import plan_by_vroom
from teamformer.bench.peers.cp_sat import solve_by_cp_sat
from teamformer.bench.peers.peer_plan import Peer, makespan_of, plain
from teamformer.bench.peers.routing import route_copies
from teamformer.planning.continuous.continuous_mission import ContinuousMission
from teamformer.planning.continuous.solve import Solution
from teamformer.planning.problem.routes import MissionPlan

PEERS: dict[str, Peer] = {
    "cp-sat": solve_by_cp_sat,
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
