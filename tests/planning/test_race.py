"""Races: the best plan counts, whoever finds it, and threads end when nothing is left to find."""

from __future__ import annotations

import math
import time

import numpy as np
import pytest

from teamformer.planning.problem.coalition_plan import plan_of_lists
from teamformer.planning.race import Judgement, Race, search_by_clock
from teamformer.planning.steps.solve import begin_race
from teamformer.planning.steps.timed_plan import TimedPlan


def judge(plan: str) -> Judgement:
    bounded = math.inf if "u" in plan else len(plan)
    return Judgement((10 * len(plan), plan.count("a")), len(plan), bounded)


def begin(first: str, seconds: float = 60.0) -> Race[str]:
    now = time.perf_counter()
    return Race(judge, first, now, now + seconds)


def test_better_plans_are_taken_and_told_where_their_value_changes() -> None:
    race = begin("abc")
    for plan in ("abcd", "aba", "xyz", "xx", "yy"):
        race.offer(plan)
    assert race.plan == "xx"  # "aba" is worse than "abc", and "yy" no better than "xx"
    assert [value for _, value in race.curve] == [2]


def test_a_plan_as_good_as_the_bound_ends_it_if_the_bound_is_of_such_plans() -> None:
    for better, is_over in (("xx", True), ("uu", False)):
        race = begin("abc")
        race.raise_bound(2)
        race.raise_bound(1)
        assert race.bound == 2
        assert not race.is_over
        race.offer(better)
        assert race.is_over == is_over


def test_plans_in_steps_are_over_when_the_makespan_is_the_bound() -> None:
    now, plan = time.perf_counter(), plan_of_lists([0], [[0]])
    for has_prices in (False, True):
        timed = TimedPlan(plan, 26_629, 0, np.array([31]), has_prices)
        race = begin_race(timed, now, now + 60)
        race.raise_bound(31)
        assert race.is_over != has_prices


def test_jobs_run_to_their_end_and_what_they_raise_reaches_who_waits() -> None:
    race = begin("abc")
    assert race.run([lambda: 1, lambda: race.offer("x"), lambda: 3], threads=2) == [1, None, 3]
    assert (race.plan, race.is_over) == ("x", True)


def test_what_a_job_raises_ends_the_others() -> None:
    race = begin("abc", seconds=600.0)

    def fail() -> None:
        raise ValueError("no")

    def wait() -> None:
        while not race.is_over:
            time.sleep(0.01)

    with pytest.raises(ValueError, match="no"):
        race.run([wait, fail], threads=2)


def test_a_search_that_nobody_waits_for_ends() -> None:
    now = time.perf_counter()
    race = Race(judge, "abc", now, now + 600.0, is_abandoned=lambda: True)

    def search() -> None:
        search_by_clock(lambda passed, rounds: None, lambda: 1.0, race.deadline, race, fail, 1e18)

    def fail() -> None:
        raise AssertionError("nothing was found")

    race.run([search, search], threads=2)
    assert race.is_over


def test_rounds_are_counted_and_what_costs_less_is_offered() -> None:
    race, costs, made, offered = begin("abc"), iter((9.0, 9.0, 7.0, 7.0, 7.0)), [0], []
    costs_now = [next(costs)]

    def search(passed: float, rounds: int) -> None:
        assert passed >= made[0] / 500
        made[0] += rounds
        costs_now[0] = next(costs)

    search_by_clock(
        search, lambda: costs_now[0], race.deadline, race, lambda: offered.append(made[0]), 500
    )
    assert made == [500]
    assert offered == [500]  # 200 and then, as that took no time, 300: the second found it
