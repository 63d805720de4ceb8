"""Costs, weights and windows of missions in steps: by hand, and against every order there is."""

from __future__ import annotations

from dataclasses import replace
from itertools import permutations

import numpy as np
import pytest

from teamformer.base.errors import MissionError
from teamformer.files.drawn.named_settings import world_of
from teamformer.methods.by_name import load_method
from teamformer.mission.checks.costs import cost_in_steps
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.record.referee.judge import judge
from teamformer.record.task_times import cost_of_record, done_steps
from teamformer.trials.trial import PlayedTrial, run_trial

PLANNERS = ("plan", "crews", "central")


def corridor(start: int, tasks: list[Task], **rules: object) -> Mission:
    """One robot that does "a" in a corridor."""
    robot = Robot("r", (start, 0), {"a": 1})
    return Mission("corridor", Grid(40, 1), ("a",), (robot,), tuple(tasks), **rules)  # type: ignore[arg-type]


def task(x: int, due: float | None = None, weight: float = 1.0, duration: int = 0) -> Task:
    between = None if due is None else (0.0, due)
    return Task(f"t{x}", (x, 0), {"a": 1}, duration, between=between, weight=weight)


def played(mission: Mission, method: str) -> PlayedTrial:
    trial = run_trial(mission, load_method(method, time_limit=0.3), 0)
    verdict = judge(trial.record)
    assert verdict.findings == ()
    told = cost_of_record(trial.record)
    assert verdict.cost == (told if told is None else pytest.approx(told))
    return trial


@pytest.mark.parametrize("method", PLANNERS)
def test_what_is_due_comes_first(method: str) -> None:
    """From 5: to 8 and to 0 takes 3 + 8 = 11 steps; to 0, due at 5, and to 8 takes 13."""
    near, due = task(8), task(0, due=5)
    assert played(corridor(5, [near, replace(due, between=None)]), method).record.end.makespan == 11
    late = {"cost": {"makespan": 1, "tardiness": 1}}
    trial = played(corridor(5, [near, due], **late), method)
    assert trial.record.end.makespan == 13
    assert cost_of_record(trial.record) == 13 / 2
    without_cost = played(corridor(5, [near, due]), method)
    assert without_cost.record.end.makespan == 13
    assert cost_of_record(without_cost.record) is None


@pytest.mark.parametrize("method", PLANNERS)
def test_a_shorter_plan_is_not_lost_for_one_in_which_most_is_done_soon(method: str) -> None:
    """Ten tasks lie 11 cells to the left, one 10 to the right: that first takes 31 steps, not 32.

    All ten are done at 31 then, which they are at 11 the other way round.
    """
    left = [replace(task(9), name=f"left {n}") for n in range(10)]
    assert played(corridor(20, [*left, task(30)]), method).record.end.makespan == 31


@pytest.mark.parametrize("method", ["plan", "crews"])
def test_the_default_written_out_is_played_alike(method: str) -> None:
    """Tasks have windows and weights of 1, 3 and 5."""
    default = replace(world_of("deadlines", 3), cost=None)
    written = replace(default, cost={"makespan": 1, "tardiness": 2})
    assert len({task.weight for task in default.tasks}) == 3
    one, other = (run_trial(mission, load_method(method), 0) for mission in (default, written))
    assert done_steps(one.record) == done_steps(other.record)


@pytest.mark.parametrize("method", ["plan", "central"])
@pytest.mark.parametrize(("weights", "first"), [((1.0, 1.0), 7), ((5.0, 1.0), 2)])
def test_what_weighs_more_is_less_late(
    weights: tuple[float, float], first: int, method: str
) -> None:
    """From 5 to 2 (3 steps) or 7 (2), and 5 from one to the other; alike, the near one first."""
    tasks = [task(2, 1, weights[0]), task(7, 1, weights[1])]
    done = done_steps(played(corridor(5, tasks, cost={"tardiness": 1}), method).record)
    assert min(done, key=lambda k: done[k]) == [2, 7].index(first)


def test_a_cost_is_what_hand_arithmetic_says() -> None:
    """Done at 3, 5 and 9; due at 4, 4 and 6, so 0, 1 and 3 late."""
    tasks = [task(8, 4, 2.0), task(10, 4), task(14, 6, 0.5)]
    cost = {"makespan": 1, "tardiness": 2, "max_tardiness": 3, "completion": 4}
    mission = corridor(5, tasks, cost=cost)
    ends = {0: 3, 1: 5, 2: 9}
    parts = 9 + 2 * (1 + 0.5 * 3) + 3 * 3 + 4 * (2 * 3 + 5 + 0.5 * 9)
    assert cost_in_steps(mission, ends, 9) == parts / 10
    assert cost_in_steps(mission, {0: 3, 1: 5}, None) is None
    trial = played(mission, "plan")
    assert done_steps(trial.record) == ends
    assert judge(trial.record).cost == pytest.approx(parts / 10)


def test_no_order_of_one_robot_costs_less() -> None:
    """One robot in a corridor: every order of five tasks, timed by hand."""
    rng = np.random.default_rng(5)
    for _ in range(8):
        spots = rng.choice(40, 5, replace=False).tolist()
        tasks = [
            task(x, int(rng.integers(2, 70)), float(rng.integers(1, 6)), int(rng.integers(0, 4)))
            for x in spots
        ]
        cost = {"makespan": 1, "tardiness": 2, "completion": 0.2}
        mission = corridor(int(rng.integers(40)), tasks, cost=cost)
        best = min(time_by_hand(mission, order) for order in permutations(range(5)))
        for method in ("plan", "central"):
            assert cost_of_record(played(mission, method).record) == pytest.approx(best)


def time_by_hand(mission: Mission, order: tuple[int, ...]) -> float:
    """Return what an order costs; a task on the way that takes no time is done in passing."""
    at, now, ends = mission.robots[0].at[0], 0, dict[int, float]()
    for number in order:
        wanted = mission.tasks[number]
        goal = wanted.at[0]
        for other, passed in enumerate(mission.tasks):
            is_on_the_way = min(at, goal) < passed.at[0] < max(at, goal)
            if is_on_the_way and other not in ends:
                return float("inf")  # another order has it
        now = max(1, now + int(abs(goal - at))) + int(wanted.duration)  # the first step is step 1
        at, ends[number] = goal, now
    found = cost_in_steps(mission, ends, max(ends.values()))
    assert found is not None
    return found


def test_the_family_is_cheaper_when_its_cost_is_planned_for() -> None:
    mission = world_of("deadlines", 1)
    blind = replace(
        mission, cost=None, tasks=tuple(replace(task, between=None) for task in mission.tasks)
    )
    ends = done_steps(run_trial(blind, load_method("plan"), 0).record)
    planned = cost_of_record(played(mission, "plan").record)
    unplanned = cost_in_steps(mission, ends, max(ends.values()))
    assert planned is not None
    assert unplanned is not None
    assert planned < 0.8 * unplanned


def test_weights_that_are_none() -> None:
    with pytest.raises(MissionError, match=r"the weight of task 't3' is 0; use 0\.001 to 1e"):
        corridor(5, [task(3, weight=0.0)])
