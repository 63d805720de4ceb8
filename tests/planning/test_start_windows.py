"""Bounds by when tasks can start: against all schedules of tiny worlds, and trials."""

from __future__ import annotations

import numpy as np
import pytest

from plain_plans import fastest_makespan, tiny_world
from random_worlds import random_world
from small_worlds import make, robot, task
from teamformer.methods.scripted.heuristic import Heuristic
from teamformer.mission.model import Mission
from teamformer.planning.bounds.earliest import earliest_in_order
from teamformer.planning.bounds.makespan import bound_makespan, lower_bound
from teamformer.planning.bounds.refutation import MOST_TASKS_A_TOUR
from teamformer.planning.bounds.start_windows import raise_by_windows, refuter_in_steps
from teamformer.planning.problem.relaxed_problem import relax
from teamformer.trials.trial import run_trials


def bound_by_windows(mission: Mission, above: int = 0) -> int:
    """Return all that windows prove, from a bound on."""
    return raise_by_windows(mission, relax(mission), above, lambda _: None, lambda: False)


@pytest.mark.parametrize("losses", [0.0, 0.3])
def test_no_schedule_is_faster(losses: float) -> None:
    rng, gaps = np.random.default_rng(3), []
    for _ in range(150):
        mission = tiny_world(rng, losses=losses)
        fastest = fastest_makespan(mission)
        if fastest is not None:
            alone = bound_makespan(relax(mission))
            gaps.append(fastest - bound_by_windows(mission, alone))
    assert len(gaps) > 50
    assert min(gaps) == 0
    assert np.mean(gaps) < 0.5


@pytest.mark.parametrize("is_plane", [False, True])
@pytest.mark.thorough
def test_no_trial_is_faster(is_plane: bool) -> None:
    """At uneven speeds, with walls, losses and late tasks."""
    rng = np.random.default_rng(2)
    missions = [random_world(rng, is_plane=is_plane) for _ in range(100)]
    tallies = run_trials(missions, Heuristic())
    gaps = [
        tally.steps - bound_by_windows(mission, lower_bound(mission))
        for mission, tally in zip(missions, tallies, strict=True)
        if tally.status == "completed"
    ]
    assert len(gaps) > 60
    assert min(gaps) == 0


def test_both_capabilities_decide_when_a_task_starts() -> None:
    """Alone each takes 18 steps, on opposite ways through the two tasks that need both.

            1         2
    . . . . 0 . . . . 0           x is at 10, where both start
    U . . T . x . T . V           T at 6 and 14 need a and b; U at 0 needs a; V at 20 needs b

    The a's way is 14, 6, 0, and the b's is 6, 14, 20. Both go to 14 first, say: the a is at 0 after
    18 steps, the b at 20 after 10, and both are back at 6 after 24.
    """
    robots, both = [robot("a", 10), robot("b", 10)], [task("ab", 6), task("ab", 14)]
    mission = make(robots, [*both, task("a", 0), task("b", 19)], forming_steps=0)
    problem = relax(mission)
    assert bound_makespan(problem) == 18
    start = earliest_in_order(mission, problem)
    refuter = refuter_in_steps(mission, problem, start, MOST_TASKS_A_TOUR)
    assert fastest_makespan(mission) == refuter.raised(18, 100) == 24


def test_slow_robots_may_do_tasks_in_passing() -> None:
    """So their tours are left out: nothing is proven of them here."""
    mission = make([robot("a", 4, speed=0.5)], [task("a", 8), task("a", 0)])
    assert bound_by_windows(mission) == 0
    assert bound_by_windows(make([robot("a", 4)], [task("a", 8), task("a", 0)])) == 12


def test_stops_when_told() -> None:
    mission = make([robot("a", 4)], [task("a", 8), task("a", 0)])
    assert raise_by_windows(mission, relax(mission), 4, lambda _: None, lambda: True) == 4
    assert raise_by_windows(mission, relax(mission), 4, lambda _: None, lambda: False) == 12
