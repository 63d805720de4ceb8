"""Futures by the rule `soonest`: against a plain twin, and what the reactive rule makes of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from random_coalitions import is_able, plain_times, random_problem
from teamformer.files.drawn.named_settings import world_of
from teamformer.mission.coordination import Plan
from teamformer.planning.dispatch.futures import begin_dispatch, empty_calls, play_out
from teamformer.planning.problem.coalition_problem import NEVER, NOBODY, CoalitionProblem
from teamformer.planning.problem.schedule import empty_schedule
from teamformer.planning.steps.reactive import reactive_plan, soonest_plan
from teamformer.planning.steps.shared_plan import kept_plan
from teamformer.planning.steps.situation import situation_of
from teamformer.planning.steps.timed_plan import time_team_plan
from teamformer.world.env import TeamFormation


def plain_future(
    problem: CoalitionProblem, handicap: list[int]
) -> tuple[list[int], list[set[int]], dict[int, int]]:
    """Return order, coalitions and starts of the rule, worked out anew for every task."""
    tasks, robots = len(problem.needs), range(len(problem.counts))
    place, free = problem.origin.tolist(), [0] * len(problem.counts)
    order: list[int] = []
    crews: dict[int, list[int]] = {}
    start: dict[int, int] = {}

    def comes(robot: int, task: int) -> int:
        return int(free[robot] + problem.ways[problem.pace[robot], place[robot], task])

    def crew_of(task: int) -> list[int]:
        crew: list[int] = []
        short = problem.needs[task].copy()
        for robot in sorted(robots, key=lambda r: (comes(r, task), r)):
            if ((short > 0) & (problem.counts[robot] > 0)).any():
                crew.append(robot)
                short = short - problem.counts[robot]
        for robot in reversed(list(crew)):
            rest = [other for other in crew if other != robot]
            if (problem.counts[rest].sum(axis=0) >= problem.needs[task]).all():
                crew = rest
        return crew

    def opens(task: int) -> int:
        ends = [start[o] + int(problem.duration[o]) for o in problem.before[task] if o != NOBODY]
        return max([int(problem.release[task]), *ends])

    while len(order) < tasks:
        able = [
            t
            for t in range(tasks)
            if t not in crews and all(o in crews for o in problem.before[t] if o != NOBODY)
        ]
        begins = {t: max(opens(t), *(comes(r, t) for r in crew_of(t))) for t in able}
        task = min(able, key=lambda t: (begins[t] + handicap[t], t))
        crews[task] = crew_of(task)
        apart = len({int(problem.site[place[r]]) for r in crews[task]}) > 1
        there = max(comes(r, task) for r in crews[task]) + int(problem.forming[0]) * apart
        start[task] = max(opens(task), there)
        for robot in crews[task]:
            place[robot], free[robot] = task, start[task] + int(problem.duration[task])
        order.append(task)
    return order, [set(crews[task]) for task in range(tasks)], start


@pytest.mark.parametrize("seed", range(20))
def test_a_future_is_that_of_its_twin(seed: int) -> None:
    problem = random_problem(seed, tasks=9, robots=6)
    handicap = np.random.default_rng(seed).integers(-40, 40, len(problem.needs)) * (seed % 2)
    schedule, calls = empty_schedule(problem), empty_calls(problem, 0)
    calls.handicap[:] = handicap
    begin_dispatch(problem, schedule)
    assert play_out(problem, schedule, calls, 0)
    order, crews, start = plain_future(problem, handicap.tolist())
    plan = schedule.plan
    assert plan.order.tolist() == order
    assert [
        set(row[:n].tolist()) for row, n in zip(plan.coalition, plan.size, strict=True)
    ] == crews
    assert schedule.start.tolist() == [start[task] for task in range(len(order))]
    assert is_able(problem, plan)
    assert plain_times(problem, plan)[3] == start


def test_a_future_goes_on_from_any_state_as_from_its_own() -> None:
    problem = random_problem(3, tasks=9)
    schedule, calls = empty_schedule(problem), empty_calls(problem, 0)
    begin_dispatch(problem, schedule)
    play_out(problem, schedule, calls, 0)
    order = schedule.plan.order.tolist()
    assert play_out(problem, schedule, calls, len(order))  # nothing is left
    schedule.rank[schedule.rank >= 4] = len(order)
    assert play_out(problem, schedule, calls, 4)
    assert schedule.plan.order.tolist() == order


def test_what_nobody_can_do_is_never_begun() -> None:
    parts = random_problem(1)._asdict()
    problem = CoalitionProblem(**parts | {"needs": parts["needs"] + 100})
    schedule, calls = empty_schedule(problem), empty_calls(problem, 0)
    begin_dispatch(problem, schedule)
    assert not play_out(problem, schedule, calls, 0)
    is_ready = (problem.before == NOBODY).all(axis=1)
    assert (calls.begin[is_ready] == NEVER).all()


@pytest.mark.parametrize("setting", ["real", "sparse", "real-ordered", "carry", "deadlines"])
def test_the_best_future_is_no_worse_than_the_rule_nor_than_what_was_decided(setting: str) -> None:
    """By when everything is really done; after news what is left of the plan is a future, too."""
    env = TeamFormation([world_of(setting, 4000)])
    known = replace(env.known(), news=("start",))
    situation = situation_of(known)

    def rank(plan: Plan) -> tuple[int, int]:
        return time_team_plan(situation, kept_plan(situation, plan)).rank

    first, rule = reactive_plan(known, None), soonest_plan(known)
    assert rank(first) <= rank(rule)
    again = reactive_plan(known, first)
    assert rank(again) <= rank(first)
    assert reactive_plan(known, first) == again
