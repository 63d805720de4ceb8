"""The paper's heuristic in small worlds."""

from __future__ import annotations

import math

import numpy as np

from small_worlds import (
    done_at,
    make,
    places,
    robot,
    service,
    task,
    teams_of,
    two_robots_one_task,
    two_tasks_two_pairs,
)
from teamformer.methods.scripted.heuristic import Heuristic
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.trials.trial import run_trials
from teamformer.world.env import TeamFormation

HEURISTIC = Heuristic()


def step(env: TeamFormation, steps: int = 1) -> None:
    for _ in range(steps):
        env.step(HEURISTIC.decide(env.view()))


def test_robots_walk_alone_and_join_at_the_task() -> None:
    env = TeamFormation([two_robots_one_task()])
    step(env, 3)
    assert teams_of(env) == {0: [0], 1: [1]}
    assert places(env) == {0: 3, 1: 3}
    step(env)
    assert done_at(env) == [4]
    assert (env.tally().joins, env.tally().splits) == (1, 0)


def test_only_teams_with_the_same_task_join() -> None:
    """Both pairs start in one cell; the second heads for U and passes through T."""
    env = TeamFormation([two_tasks_two_pairs()])
    step(env)
    assert places(env) == {0: 4, 1: 4, 2: 4, 3: 4}
    step(env)
    assert teams_of(env) == {0: [0, 1], 2: [2], 3: [3]}
    assert done_at(env) == [2, None]


def test_teams_pair_off_by_slot() -> None:
    """Four at the task: first with second, third with fourth; all four say so."""
    env = TeamFormation([make([robot(can, 5) for can in "abca"], [task("aabc", 5)])])
    step(env)  # nobody has a task before
    assert HEURISTIC.decide(env.view()).wanted.tolist() == [
        [1, 1, 0],
        [1, 1, 0],
        [1, 0, 1],
        [1, 0, 1],
    ]
    step(env)
    assert teams_of(env) == {0: [0, 1], 2: [2, 3]}
    step(env)
    assert done_at(env) == [3]


def test_a_crowd_beyond_any_view_pairs_off_all_the_same() -> None:
    """Forty in one cell, all different, of whom each sees sixteen.

    Slots 33 and above see more lower than higher slots. Of them 32 and 39 stay over: 19 pairs.
    """
    caps = tuple(f"c{r}" for r in range(40))
    robots = tuple(Robot(cap, (0, 0), {cap: 1}) for cap in caps)
    work = Task("all", (0, 0), dict.fromkeys(caps, 1))
    env = TeamFormation([Mission("crowd", Grid(1, 1), caps, robots, (work,))])
    step(env)
    counts = []
    while env.is_running[0]:
        step(env)
        counts.append(len(teams_of(env)))
    assert counts == [21, 11, 6, 3, 2, 1]


def test_an_odd_one_waits() -> None:
    env = TeamFormation([make([robot(can, 5) for can in "abc"], [task("abc", 5)])])
    step(env, 2)
    assert teams_of(env) == {0: [0, 1], 2: [2]}
    step(env)
    assert done_at(env) == [3]


def test_a_team_halves_until_everybody_is_alone() -> None:
    """Five in one team, none at its task: {0, 1} and {2, 3, 4}, then 0, 1, 2 and {3, 4}."""
    env = TeamFormation(
        [make([robot("a", 0) for _ in range(5)], [task("aaaaa", 9)], teams=((0, 1, 2, 3, 4),))]
    )
    step(env)
    assert teams_of(env) == {0: [0, 1], 2: [2, 3, 4]}
    step(env)
    assert teams_of(env) == {0: [0], 1: [1], 2: [2], 3: [3, 4]}
    step(env)
    assert teams_of(env) == {r: [r] for r in range(5)}
    step(env, 12)
    assert env.tally().splits == 4


def test_halves_that_stand_at_their_next_task_stay_whole() -> None:
    """ab, ab part once; both halves are given the task where they stand and wait there for c."""
    robots = [robot(can, 5) for can in "abab"] + [robot("c", 15)]
    env = TeamFormation([make(robots, [task("aabbc", 5)], teams=((0, 1, 2, 3),))])
    step(env)
    assert teams_of(env) == {0: [0, 1], 2: [2, 3], 4: [4]}
    step(env, 3)
    assert teams_of(env) == {0: [0, 1, 2, 3], 4: [4]}
    step(env, 7)
    assert done_at(env) == [11]  # c walks 10 steps and joins in the next
    assert (env.tally().splits, env.tally().joins) == (1, 2)


def test_a_serving_team_maintains() -> None:
    env = TeamFormation([service(duration=4, forming_steps=0)])
    step(env, 2)
    while env.is_running[0]:
        before = env.view()
        serving = before.is_serving.copy()
        decision = HEURISTIC.decide(before)
        assert (decision.wanted[serving] == before.counts[serving]).all()
        env.step(decision)
    assert env.tally().illegal_decisions == 0


def test_forming_is_bounded_between_completions() -> None:
    """One task: at most n - 1 splits and n - 1 joins, however the robots begin."""
    rng = np.random.default_rng(0)
    for count in (2, 5, 12):
        for _ in range(5):
            labels = rng.integers(0, count, size=count)
            teams = tuple(tuple(np.flatnonzero(labels == x).tolist()) for x in set(labels.tolist()))
            robots = [robot("a", 0) for _ in range(count)]
            mission: Mission = make(robots, [task("a" * count, 3)], teams=teams)
            [tally] = run_trials([mission], HEURISTIC)
            assert tally.status == "completed"
            assert tally.splits == count - len(teams)
            assert tally.joins == count - 1
            halvings = math.ceil(math.log2(max(len(team) for team in teams)))
            assert tally.steps <= 2 * halvings + 3 + math.ceil(math.log2(count)) * 2
