"""The lower bound with forming: by hand, and against every play of tiny worlds by the rules."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.planning.bounds.makespan import lower_bound
from teamformer.planning.bounds.start_windows import raise_by_windows
from teamformer.planning.problem.relaxed_problem import relax

Team = tuple[int, tuple[int, ...]]  # where it is, and its robots
LENGTH = 5


def corridor(places: list[int], kinds: str, tasks: list[Task], forming_steps: int = 1) -> Mission:
    pairs = enumerate(zip(places, kinds, strict=True))
    robots = tuple(Robot(f"r{n}", (x, 0), {kind: 1}) for n, (x, kind) in pairs)
    world, caps = Grid(40, 1), ("a", "b", "c")
    return Mission("corridor", world, caps, robots, tuple(tasks), forming_steps=forming_steps)


@pytest.mark.parametrize(("robots", "joining"), [(1, 0), (2, 1), (3, 2), (4, 2), (5, 3)])
def test_robots_from_one_place_pair_up(robots: int, joining: int) -> None:
    mission = corridor([0] * robots, "a" * robots, [Task("t", (4, 0), {"a": robots})])
    assert lower_bound(mission) == 4 + joining


def test_who_has_far_to_walk_joins_once() -> None:
    tasks = [Task("t", (10, 0), {"a": 4})]
    assert lower_bound(corridor([0, 8, 8, 8], "aaaa", tasks)) == 11
    assert lower_bound(corridor([0, 8, 8, 8], "aaaa", tasks, forming_steps=0)) == 10


def test_a_task_that_comes_late_waits_for_nobody() -> None:
    task = Task("t", (3, 0), {"a": 2}, appears=20)
    assert lower_bound(corridor([0, 0], "aa", [task])) == 21


@pytest.mark.parametrize("seed", range(3))
def test_no_play_by_the_rules_is_faster(seed: int) -> None:
    rng = np.random.default_rng(seed)
    gaps = []
    for _ in range(4):
        places, kinds = rng.integers(0, LENGTH, 3).tolist(), "aab"[: rng.integers(2, 4)] + "bb"
        tasks = [
            Task(f"t{k}", (int(rng.integers(LENGTH)), 0), {"a": int(rng.integers(1, 3))})
            for k in range(2)
        ]
        tasks.append(Task("both", (int(rng.integers(LENGTH)), 0), {"a": 1, "b": 1}))
        mission = corridor(places, kinds[:3], tasks)
        gaps.append(fastest_play(mission) - lower_bound(mission))
    assert 0 <= min(gaps) <= 1
    assert np.mean(gaps) < 2


def test_who_cannot_be_along_is_joined_and_left() -> None:
    """The a serves T with the b, then U with the c; the b has to be at V too, and the c at W.

        ab      c
    V . T . . . U . W         V is at 0, T at 2, U at 6 and W at 8

    The b joins the a at T in step 1, and they could be at U in step 5, where the c joins them in
    step 6. But the b is at V sooner if they part at T in step 2: so the a is at U in step 6.
    """
    tasks = [Task("T", (2, 0), {"a": 1, "b": 1}), Task("U", (6, 0), {"a": 1, "c": 1})]
    ends = [Task("V", (0, 0), {"b": 1}), Task("W", (8, 0), {"c": 1})]
    assert lower_bound(corridor([2, 2, 6], "abc", tasks)) == 6
    assert lower_bound(corridor([2, 2, 6], "abc", [*tasks, *ends])) == 7
    assert lower_bound(corridor([2, 2, 6], "abc", [*tasks, *ends], forming_steps=0)) == 5


@pytest.mark.parametrize("seed", range(3))
def test_no_play_is_faster_where_each_has_a_capability_of_its_own(seed: int) -> None:
    rng, gaps = np.random.default_rng(seed), []
    for _ in range(6):
        tasks = [
            Task(f"t{k}", (int(rng.integers(LENGTH)), 0), dict.fromkeys(_some(rng, "abc"), 1))
            for k in range(rng.integers(3, 6))
        ]
        mission = corridor(rng.integers(0, LENGTH, 3).tolist(), "abc", tasks)
        bound = lower_bound(mission)
        bound = raise_by_windows(mission, relax(mission), bound, lambda _: None, lambda: False)
        gaps.append(fastest_play(mission) - bound)
    assert min(gaps) == 0
    assert np.mean(gaps) < 1


def _some(rng: np.random.Generator, kinds: str) -> list[str]:
    """Return some of the kinds, at least one."""
    return sorted(rng.permutation(list(kinds))[: rng.integers(1, len(kinds) + 1)].tolist())


def fastest_play(mission: Mission) -> int:
    """Return the least makespan of all plays, breadth first: a team moves a cell, or forms."""
    states = {(finish_start(mission), frozenset())}
    for step in itertools.count(1):
        states = {
            (teams, done | done_by(mission, teams))
            for before, done in states
            for teams in next_teams(before)
        }
        if any(len(done) == len(mission.tasks) for _, done in states):
            return step
    raise AssertionError


def finish_start(mission: Mission) -> frozenset[Team]:
    return frozenset((int(robot.at[0]), (r,)) for r, robot in enumerate(mission.robots))


def next_teams(teams: frozenset[Team]) -> set[frozenset[Team]]:
    """Return all that a step can make of teams."""
    found = {frozenset[Team]()}
    left = sorted(teams)
    return _choose(left, found)


def _choose(left: list[Team], found: set[frozenset[Team]]) -> set[frozenset[Team]]:
    if not left:
        return found
    (place, robots), rest = left[0], left[1:]
    ways: list[tuple[list[Team], list[Team]]] = [
        ([(place + by, robots)], rest) for by in (-1, 0, 1) if 0 <= place + by < LENGTH
    ]
    for size in range(1, len(robots)):
        for stay in itertools.combinations(robots, size):
            leave = tuple(r for r in robots if r not in stay)
            ways.append(([(place, stay), (place, leave)], rest))
    for other in rest:
        if other[0] == place:
            joined = tuple(sorted(robots + other[1]))
            ways.append(([(place, joined)], [team for team in rest if team != other]))
    return set().union(*(_choose(rest, {f | set(made) for f in found}) for made, rest in ways))


def done_by(mission: Mission, teams: frozenset[Team]) -> frozenset[int]:
    """Return the tasks that teams do where they stand."""
    done = set()
    for k, task in enumerate(mission.tasks):
        for place, robots in teams:
            kinds = [next(iter(mission.robots[r].can)) for r in robots]
            able = all(kinds.count(cap) >= count for cap, count in task.needs.items())
            if place == task.at[0] and able:
                done.add(k)
    return frozenset(done)
