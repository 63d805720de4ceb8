"""Plans with a view to what may come: played by hand in known futures, and what they are worth."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from small_worlds import make, robot, task
from teamformer.export.reasons import story_lines
from teamformer.model import Scenario
from teamformer.planning.foresight.futures import Futures, sample_futures
from teamformer.planning.foresight.ground import empty_stage, ground_of
from teamformer.planning.foresight.look_ahead import Sampling, plan_ahead
from teamformer.planning.foresight.mean_search import improve_on_average
from teamformer.planning.teams.facts import Facts, situation_of
from teamformer.planning.teams.neighbourhood import empty_bench
from teamformer.planning.teams.plan import plan_teams
from teamformer.planning.teams.shared_plan import plan_mission
from teamformer.policies.scripted.follow_plan import FollowPlan
from teamformer.referee import judge
from teamformer.rules.constants import NOBODY
from teamformer.scenarios.named_settings import world_of
from teamformer.sim.replay.reading import replay_from_tree
from teamformer.sim.replay.record import Replay
from teamformer.sim.replay.writing import replay_to_tree
from teamformer.trials.trial import run_trial
from teamformer.truth import draw_truth, expected_mission


def begin(scenario: Scenario) -> Facts:
    """Return what everybody knows of a mission at its start."""
    places = tuple(robot.at for robot in scenario.robots)
    free_at = (0,) * len(places)
    return Facts(0, tuple(range(len(scenario.tasks))), places, scenario.starting_teams, free_at)


def play_by_hand(
    coalitions: list[list[int]], needs: list[list[int]], scouts: tuple[int, ...] = (NOBODY, NOBODY)
) -> int:
    """Return what a plan costs where it turns out that the tasks need `needs`, (tasks, caps).

    T . . a . . . . . . b . . . . U        T needs a and may need b, U needs b; T comes first
    0     3             10        15
    """
    tasks = [replace(task("a", 0), may_need={"b": 0.5}), task("b", 15)]
    scenario = make([robot("a", 3), robot("b", 10)], tasks)
    situation = situation_of(expected_mission(scenario), begin(scenario))
    ground = ground_of(scenario, situation, begin(scenario), {0})
    plan = plan_teams(situation.problem, [0, 1], coalitions)
    futures = Futures(np.array([needs]), np.zeros((1, 2), np.int64))
    looking, costs = np.array(scouts, np.int64), np.zeros((2, 1), np.int64)
    room = (empty_stage(ground), empty_bench(situation.problem, 0), costs)
    problem = situation.problem
    return int(improve_on_average(ground, problem, plan, looking, futures, *room, 0, False))


def test_who_is_not_needed_goes_on() -> None:
    """b is at 7 when a is at T, after 3 steps; from there it is 8 steps to U: done after 3, 11."""
    assert play_by_hand([[0, 1], [1]], [[1, 0, 0], [0, 1, 0]]) == 8 * 2 * 11 + 3 + 11


def test_who_is_needed_comes_and_parts_again() -> None:
    """b is at T after 10 steps, joins in the 11th, parts in the 12th and walks 15."""
    assert play_by_hand([[0, 1], [1]], [[1, 1, 0], [0, 1, 0]]) == 8 * 2 * 27 + 11 + 27


def test_who_is_missing_is_called_when_that_costs_least() -> None:
    """After 3 steps b is at 13. At once: 26 steps more for b, a waits 13. After U: 15, a waits 17.

    So b does U after 5 steps, is at T after 20 and joins in the 21st.
    """
    assert play_by_hand([[0], [1]], [[1, 1, 0], [0, 1, 0]]) == 8 * 2 * 21 + 5 + 21


def test_a_scout_looks_before_it_does_anything_else() -> None:
    """b walks the 10 cells to T, where a has been for 7 steps and done it, then turns round.

    But a shows in step 3 what T needs: so b turns round there, as if it had been left out.
    """
    assert play_by_hand([[0], [1]], [[1, 0, 0], [0, 1, 0]], (NOBODY, 0)) == 8 * 2 * 11 + 3 + 11


def test_all_robots_sample_the_same_futures() -> None:
    """They follow from the number of the task and the step alone, by a generator that is fixed."""
    scenario = make([robot("a", 0), robot("b", 1)], [replace(task("a", 9), may_need={"b": 0.5})])
    situation = situation_of(expected_mission(scenario), begin(scenario))
    most = situation.problem.needs.astype(np.int64)
    futures = sample_futures(scenario, situation, most, {0}, 7, 8)
    draws = np.random.default_rng([0, 7]).random(8)
    assert futures.needs[:, 0, 1].tolist() == (draws < 0.5).astype(int).tolist()
    assert futures.needs[:, 0, 0].tolist() == [1] * 8
    assert sample_futures(scenario, situation, most, set(), 7, 8).needs[:, 0, 1].tolist() == [1] * 8


def far_from_what_may_be_needed(foresight: str) -> Scenario:
    """T needs a and may need b, U needs a for 8 steps, V needs b; c has nothing to do.

    U . c . T . . . . ab . . . . . . . . . V
    0   2   4         9                    19
    """
    tasks = [replace(task("a", 4), may_need={"b": 0.5}), task("a", 0, duration=8), task("b", 19)]
    robots = [robot("a", 9), robot("b", 9), robot("c", 2)]
    return make(robots, tasks, foresight=foresight, allocation="plan")


def play_where(scenario: Scenario, needs: str) -> Replay:
    """Play a mission whose first task turns out to need each letter of `needs`."""
    for seed in range(100):
        if draw_truth(scenario, seed).tasks[0].needs.keys() == set(needs):
            return run_trial(scenario, FollowPlan(), "follow-plan", seed).replay
    raise AssertionError("no seed below 100 draws that")


@pytest.mark.parametrize(
    ("foresight", "needs", "makespan"),
    [
        ("needed", "ab", 22),  # at T after 5, one in the 6th, apart in the 7th, b 15 to V
        ("needed", "a", 20),  # a shows after 5 that b came in vain: 15 to V
        ("sampled", "ab", 22),
        ("sampled", "a", 17),  # c shows it after 2, b is at V after 14, a at U after 9, for 8 steps
    ],
)
def test_a_scout_pays(foresight: str, needs: str, makespan: int) -> None:
    """b goes to T first: from V it would be there after 25 steps only. But c is near and idle."""
    replay = play_where(far_from_what_may_be_needed(foresight), needs)
    assert replay.end.makespan == makespan
    assert judge(replay).findings == ()
    assert [(made, (2, 0) in scouts) for made, scouts in replay.scouts[:1]] == (
        [(0, True)] if foresight == "sampled" else []
    )


def test_it_is_said_why_a_scout_goes() -> None:
    replay = play_where(far_from_what_may_be_needed("sampled"), "a")
    first = next(story_lines(replay, 2))
    assert first == ("1-2", "walks to t0", "the plan has r2 look first what it needs")


def test_the_referee_says_who_scouts_in_vain() -> None:
    replay = play_where(far_from_what_may_be_needed("sampled"), "a")
    later = next(made for made, _ in replay.plans if made > 0)
    for scouts, complaint in (
        ([[0, [[2, 0], [2, 0]]]], "scout twice"),
        ([[0, [[2, 0]]], [later, [[2, 0]]]], "whose needs are known"),
        ([[0, [[2, 0]]], [later + 1, [[2, 0]]]], "when no plan was made"),
    ):
        tree = replay_to_tree(replay) | {"scouts": scouts}
        found = judge(replay_from_tree(tree, "forged")).findings
        assert any(complaint in str(finding) for finding in found)


def test_where_all_is_known_it_is_the_shared_plan() -> None:
    scenario = replace(world_of("4N20T-C4", 0), allocation="plan")
    facts = begin(scenario)
    assert plan_ahead(scenario, scenario, facts, set(), None) == plan_mission(scenario, facts)


@pytest.mark.parametrize("sampling", [Sampling(), Sampling(futures=1), Sampling(scouts=False)])
def test_it_is_the_same_plan_every_time(sampling: Any) -> None:
    scenario = replace(world_of("4N20T-C4-needs", 0), allocation="plan", foresight="sampled")
    hidden = {number for number, task in enumerate(scenario.tasks) if task.may_need}
    believed, facts = expected_mission(scenario), begin(scenario)
    plans = [plan_ahead(scenario, believed, facts, hidden, None, sampling) for _ in range(2)]
    assert plans[0] == plans[1]
    assert sorted(plans[0].order) == list(facts.open_tasks)
    assert sampling.scouts or plans[0].scouts == ()
