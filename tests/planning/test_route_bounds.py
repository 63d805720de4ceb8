"""Bounds by routes: against all routes, all schedules, all plays of tiny worlds, and trials."""

from __future__ import annotations

from itertools import permutations

import numpy as np
import pytest

from plain_plans import fastest_makespan, tiny_world
from random_worlds import random_world
from small_worlds import make, robot, task
from teamformer.methods.scripted.heuristic import Heuristic
from teamformer.methods.scripted.joining import JoinAll
from teamformer.methods.seam.protocol import Policy
from teamformer.mission.model import Mission
from teamformer.planning.bounds.makespan import lower_bound
from teamformer.planning.bounds.prize_routes import (
    Stops,
    collect,
    empty_outlook,
    look_ahead,
    make_stops,
)
from teamformer.planning.bounds.route_cover import raise_by_routes
from teamformer.planning.problem.relaxed_problem import relax
from teamformer.trials.trial import run_trials


def bound_by_routes(mission: Mission, above: int = 0) -> int:
    """Return all that routes prove, from a bound on."""
    return raise_by_routes(mission, relax(mission), above, lambda _: None, lambda: False)


def random_stops(rng: np.random.Generator, memory: int) -> tuple[Stops, np.ndarray]:
    """Return stops on a square, some in one place, and their places by number."""
    count = int(rng.integers(1, 6))
    points = rng.integers(0, 4, (count, 2))
    legs = np.abs(points[:, None] - points).sum(axis=2)
    places = (legs == 0).argmax(axis=1)
    ready, stay, home = (rng.integers(0, most, count) for most in (8, 4, 3))
    return make_stops(np.where(legs == 0, 99, legs), ready, stay, home, places, memory), places


def best_route(
    stops: Stops, places: np.ndarray, first: np.ndarray, prizes: np.ndarray, deadline: int
) -> int:
    """Return what the best of all routes collects that visit no place twice."""
    most = 0
    for size in range(1, len(prizes) + 1):
        for route in permutations(range(len(prizes)), size):
            if len(set(places[list(route)].tolist())) < size:
                continue
            time, last = -1, -1
            for stop in route:
                arrive = first[stop] if last < 0 else time + stops.legs[last, stop]
                time, last = max(arrive, stops.ready[stop]) + stops.stay[stop], stop
            if time + stops.home[last] <= deadline:
                most = max(most, int(prizes[list(route)].sum()))
    return most


@pytest.mark.parametrize("memory", [0, 1, 5])
def test_collects_no_less_than_any_route(memory: int) -> None:
    """Who remembers all places comes back to none, and collects exactly as much."""
    rng, excess = np.random.default_rng(memory), []
    for _ in range(200):
        stops, places = random_stops(rng, memory)
        first, prizes = rng.integers(0, 6, len(places)), rng.integers(0, 20, len(places))
        deadline = int(rng.integers(0, 16))
        outlook = empty_outlook(stops, deadline)
        look_ahead(stops, prizes, deadline, outlook)
        visits = np.zeros(len(prizes), np.int64)
        most = collect(stops, outlook, first, deadline, visits)
        assert visits @ prizes == most
        excess.append(most - best_route(stops, places, first, prizes, deadline))
    assert min(excess) == 0
    assert (max(excess) == 0) == (memory == 5)


@pytest.mark.parametrize("memory", [0, 1, 5])
def test_collects_no_less_where_legs_take_no_time(memory: int) -> None:
    """Some legs take no time in one direction, some in both, and stops take none."""
    rng = np.random.default_rng(memory)
    for _ in range(200):
        count = int(rng.integers(2, 6))
        legs = rng.integers(0, 3, (count, count)) * rng.integers(0, 2, (count, count))
        np.fill_diagonal(legs, 99)
        nothing, places = np.zeros(count, np.int64), np.arange(count)
        stops = make_stops(legs, rng.integers(0, 4, count), nothing, nothing, places, memory)
        first, prizes = rng.integers(0, 3, count), rng.integers(0, 20, count)
        deadline = int(rng.integers(0, 6))
        outlook = empty_outlook(stops, deadline)
        look_ahead(stops, prizes, deadline, outlook)
        most = collect(stops, outlook, first, deadline, np.zeros(count, np.int64))
        assert most >= best_route(stops, places, first, prizes, deadline)
        if memory == 5:
            assert most == best_route(stops, places, first, prizes, deadline)


@pytest.mark.parametrize("losses", [0.0, 0.3])
def test_no_schedule_is_faster(losses: float) -> None:
    rng, gaps = np.random.default_rng(0), []
    for _ in range(100):
        mission = tiny_world(rng, losses=losses)
        fastest = fastest_makespan(mission)
        if fastest is not None:
            gaps.append(fastest - bound_by_routes(mission))
    assert len(gaps) > 50
    assert min(gaps) == 0
    assert np.mean(gaps) < 1


@pytest.mark.parametrize("policy", [JoinAll(), Heuristic()])
@pytest.mark.parametrize("is_plane", [False, True])
@pytest.mark.thorough
def test_no_trial_is_faster(policy: Policy, is_plane: bool) -> None:
    """At uneven speeds, with walls, losses and late tasks."""
    rng = np.random.default_rng(1)
    missions = [random_world(rng, is_plane=is_plane) for _ in range(60)]
    tallies = run_trials(missions, policy)
    gaps = [
        tally.steps - bound_by_routes(mission)
        for mission, tally in zip(missions, tallies, strict=True)
        if tally.status == "completed"
    ]
    assert len(gaps) > 40
    assert min(gaps) == 0


def test_two_capabilities_share_the_time_of_a_robot() -> None:
    """Alone a's take 8 steps and b's too; who can do both has to do both.

    U . . . x . . . T        x is at 4; T at 8 needs a, U at 0 needs b: 4 + 8
    """
    mission = make([robot("ab", 4)], [task("a", 8), task("b", 0)])
    assert lower_bound(mission) == 4
    assert bound_by_routes(mission) == 12


def test_a_slow_robot_takes_its_own_time() -> None:
    """Both ends need an a: the fast one does one in 4 steps, the slow one the other in 8.

    Or the fast one does both in 4 + 8.
    """
    mission = make([robot("a", 4), robot("a", 4, speed=0.5)], [task("a", 8), task("a", 0)])
    assert lower_bound(mission) == 4
    assert bound_by_routes(mission) == 8


def test_tasks_in_one_place_are_served_at_once() -> None:
    robots, tasks = [robot("a", 0)], [task("a", 2, duration=5), task("a", 2, duration=3)]
    assert bound_by_routes(make(robots, tasks)) == 7


def test_who_starts_alone_joins_before_the_first_task() -> None:
    """Each end needs both: 4 + 8 to walk, and one step to join."""
    robots, tasks = [robot("a", 4), robot("b", 4)], [task("ab", 8), task("ab", 0)]
    assert bound_by_routes(make(robots, tasks)) == 13
    assert bound_by_routes(make(robots, tasks, forming_steps=0)) == 12
    assert bound_by_routes(make(robots, tasks, teams=((0, 1),))) == 12


def test_offers_what_it_proves_and_stops_when_told() -> None:
    mission, offers = make([robot("ab", 4)], [task("a", 8), task("b", 0)]), [4]
    assert raise_by_routes(mission, relax(mission), 4, offers.append, lambda: True) < 12
    assert raise_by_routes(mission, relax(mission), 4, offers.append, lambda: False) == 12
    assert offers[-1] == 12
