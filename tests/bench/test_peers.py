"""Peers on tiny missions beside all plans there are, and what they cannot be asked."""

from __future__ import annotations

import itertools
import json
from pathlib import Path

import numpy as np
import pytest

from teamformer.bench.peers.auction import auction
from teamformer.bench.peers.lone_robots import able_robots, lower_limits
from teamformer.bench.peers.names import LIBRARIES, PEERS
from teamformer.bench.peers.peer_plan import OutOfReachError, makespan_of, plain, plan_of
from teamformer.planning.problem.coalition_problem import CoalitionProblem, pose_problem
from test_plan_command import TREE
from typed import teamformer


def small(seed: int, alone: bool = False) -> CoalitionProblem:
    """Return three robots with a skill each and four tasks in a square; `alone`: of one skill."""
    rng = np.random.default_rng(seed)
    places = rng.integers(0, 100, (5, 2))  # four tasks and the depot
    ways = np.abs(places[:, None] - places[None, :]).sum(axis=2)
    needs = np.zeros((4, 2), int)
    for task in range(4):
        needs[task, rng.permutation(2)[: 1 if alone else 1 + task % 2]] = 1
    return pose_problem(
        ways=[ways[:, :4]],
        home=np.tile(ways[4], (3, 1)),
        pace=[0, 0, 0],
        origin=[4, 4, 4],
        counts=[[1, 0], [0, 1], [0, 1]],
        needs=needs,
        duration=rng.integers(1, 30, 4),
    )


def best_of_all(problem: CoalitionProblem) -> int:
    """Return the least makespan of all orders and coalitions of robots that are needed."""
    choices = []
    for needs in problem.needs:
        coalitions = [
            who
            for size in (1, 2, 3)
            for who in itertools.combinations(range(3), size)
            if (problem.counts[list(who)].sum(axis=0) >= needs).all()
        ]
        choices.append([who for who in coalitions if len(who) == len(coalitions[0])])
    return min(
        makespan_of(problem, plan_of(problem, who, order))
        for who in itertools.product(*choices)
        for order in itertools.permutations(range(4))
    )


@pytest.mark.parametrize("seed", range(3))
def test_cp_sat_proves_the_best_plan_of_tiny_missions(seed: int) -> None:
    """It ends as soon as it has proven one."""
    problem = small(seed)
    found = PEERS["cp-sat"](problem, 60.0)
    assert found is not None
    assert makespan_of(problem, found.plan) == found.bound == best_of_all(problem)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("name", ["or-routing", "auction"])
def test_others_find_plans_that_our_times_bear_out(name: str, seed: int) -> None:
    problem = small(seed)
    found = PEERS[name](problem, 0.2)
    assert found is not None
    best = best_of_all(problem)
    assert best <= makespan_of(problem, found.plan) <= 1.25 * best
    for task, needs in enumerate(problem.needs):
        who = found.plan.coalition[task, : found.plan.size[task]]
        assert (problem.counts[who].sum(axis=0) >= needs).all()


@pytest.mark.parametrize("name", LIBRARIES)
def test_solvers_of_vehicle_routing_find_the_best_routes(name: str) -> None:
    pytest.importorskip(LIBRARIES[name], reason="the extra `peers` is not installed")
    problem = small(1, alone=True)
    found = PEERS[name](problem, 1.0)
    assert found is not None
    assert makespan_of(problem, found.plan) == best_of_all(problem)
    with pytest.raises(OutOfReachError, match="whose tasks need one robot each"):
        PEERS[name](small(1), 1.0)


def test_routing_is_never_worse_than_the_auctions_that_it_begins_with() -> None:
    """Twelve tasks, half of which need both kinds of robots, of which there are three each."""
    rng = np.random.default_rng(3)
    places = rng.integers(0, 100, (13, 2))
    ways = np.abs(places[:, None] - places[None, :]).sum(axis=2)
    problem = pose_problem(
        ways=[ways[:, :12]],
        home=np.tile(ways[12], (6, 1)),
        pace=[0] * 6,
        origin=[12] * 6,
        counts=[[1, 0]] * 3 + [[0, 1]] * 3,
        needs=[[1, 1]] * 6 + [[1, 0]] * 3 + [[0, 1]] * 3,
        duration=rng.integers(1, 30, 12),
    )
    fair = auction(problem, 0.0)
    found = PEERS["or-routing"](problem, 1.0)
    assert fair is not None
    assert found is not None
    assert makespan_of(problem, found.plan) < makespan_of(problem, fair.plan)


@pytest.mark.parametrize("name", ["or-routing", "cp-sat"])
def test_nobody_fills_two_seats_with_one_skill(name: str) -> None:
    """One task needs two of a skill that each of three robots has once: two go, though one is near.

    The robots stand at 1, 5 and 9 on a line, the task at 0. The second arrives at 5, so that it is
    home at 5 + 2 + 5 = 12.
    """
    at = np.array([0, 1, 5, 9])
    ways = np.abs(at[:, None] - at[None, :])
    problem = pose_problem(
        ways=[ways[:, :1]],
        home=ways[1:],
        pace=[0, 0, 0],
        origin=[1, 2, 3],
        counts=[[1], [1], [1]],
        needs=[[2]],
        duration=[2],
    )
    found = PEERS[name](problem, 1.0)
    assert found is not None
    assert sorted(found.plan.coalition[0, : found.plan.size[0]]) == [0, 1]
    assert makespan_of(problem, found.plan) == 12


def test_cp_sat_without_time_keeps_the_plan_it_was_handed() -> None:
    problem = small(1)
    fair, found = auction(problem, 0.0), PEERS["cp-sat"](problem, 0.0)
    assert fair is not None
    assert found is not None
    assert makespan_of(problem, found.plan) <= makespan_of(problem, fair.plan)
    assert 0 <= found.bound <= best_of_all(problem)


def test_a_fair_auction_is_worked_out_by_hand() -> None:
    """On a line, depot at 0: `a` at 4 needs both kinds, `b` at 2 the first, `c` at 6 the second.

    Robots 1 and 2 are of the second kind. `b` is offered for 2, `a` for 4, `c` for 6: robot 0 does
    `b` from 2 to 3 and is at `a` in 5, where robot 1 has been since 4; robot 2 does `c` at 6.
    """
    at = np.array([4, 2, 6, 0])
    ways = np.abs(at[:, None] - at[None, :])
    problem = pose_problem(
        ways=[ways[:, :3]],
        home=np.tile(ways[3], (3, 1)),
        pace=[0, 0, 0],
        origin=[3, 3, 3],
        counts=[[1, 0], [0, 1], [0, 1]],
        needs=[[1, 1], [1, 0], [0, 1]],
        duration=[2, 1, 1],
    )
    held = auction(problem, 0.0)
    assert held is not None
    who = [sorted(held.plan.coalition[task, : held.plan.size[task]]) for task in range(3)]
    assert who == [[0, 1], [0], [2]]
    assert list(held.plan.order) == [1, 0, 2]
    assert makespan_of(problem, held.plan) == 13  # `c` ends at 7, and is 6 from home


def test_an_auction_says_that_nobody_can() -> None:
    problem = small(0)
    problem.needs[2] = (0, 3)
    assert auction(problem, 0.1) is None


def test_limits_are_lowered_while_routes_are_found() -> None:
    """The solver here finds the best route within any limit that there is one for."""
    problem = small(2, alone=True)
    best, limits = best_of_all(problem), []

    def attempt(limit: int, seconds: float) -> list[list[int]] | None:
        limits.append(limit)
        within = [routes for over, routes in splits if over <= limit]
        return max(within, key=lambda routes: cost[str(routes)]) if within else None

    can_do = able_robots(problem, "mine")
    splits, cost = [], {}
    for who in itertools.product(*[np.flatnonzero(column) for column in can_do.T]):
        for order in itertools.permutations(range(4)):
            routes = [[task for task in order if who[task] == robot] for robot in range(3)]
            over = makespan_of(problem, plan_of(problem, [[int(r)] for r in who], order))
            splits.append((over, routes))
            cost[str(routes)] = over
    found = lower_limits(problem, can_do, 30.0, attempt)
    assert found is not None
    assert makespan_of(problem, found.plan) <= 1.01 * best
    assert limits[0] >= max(cost.values()) > best
    assert limits[1] < limits[0]


def test_windows_precedence_and_forming_are_not_asked() -> None:
    late = small(0)
    late.due[1] = 50
    with pytest.raises(OutOfReachError, match="windows or forming"):
        plain(late, "auction")
    forming = small(0)
    forming.forming[0] = 1
    with pytest.raises(OutOfReachError, match="windows or forming"):
        plain(forming, "auction")
    assert plain(small(0), "auction") is not None


def test_the_command_measures_peers_beside_our_methods(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "ral").mkdir()
    (tmp_path / "ral" / "env_0.json").write_text(json.dumps(TREE))
    words = (str(tmp_path / "ral"), "--methods", "plan,auction", "--time-limit", "0.3", "--json")
    assert teamformer("bench", "others", *words) == 0
    plan, auctioned = map(json.loads, capsys.readouterr().out.splitlines())
    assert (plan["method"], auctioned["method"]) == ("plan", "auction")
    assert 0 < plan["makespan"] <= auctioned["makespan"] < 2 * plan["makespan"]
