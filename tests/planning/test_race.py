"""Races: the best plan counts, whoever finds it, and threads end when nothing is left to find."""

from __future__ import annotations

import time

import pytest

from teamformer.planning.race import Race, search_by_clock


def length(plan: str) -> tuple[tuple[float, ...], float]:
    return (len(plan), plan.count("a")), len(plan)


def begin(first: str, seconds: float = 60.0, is_bounded: bool = True) -> Race[str]:
    now = time.perf_counter()
    return Race(length, first, now, now + seconds, is_bounded)


def test_better_plans_are_taken_and_told_where_their_value_changes() -> None:
    race = begin("abc")
    for plan in ("abcd", "aba", "xyz", "xx", "yy"):
        race.offer(plan)
    assert race.plan == "xx"  # "aba" is worse than "abc", and "yy" no better than "xx"
    assert [value for _, value in race.curve] == [2]


def test_a_plan_as_good_as_the_bound_ends_it_if_the_bound_is_of_its_rank() -> None:
    for is_bounded in (True, False):
        race = begin("abc", is_bounded=is_bounded)
        race.raise_bound(2)
        race.raise_bound(1)
        assert race.bound == 2
        assert not race.is_over
        race.offer("xx")
        assert race.is_over == is_bounded


def test_jobs_run_to_their_end_and_what_they_raise_reaches_who_waits() -> None:
    race = begin("abc")
    assert race.run([lambda: 1, lambda: race.offer("x"), lambda: 3], threads=2) == [1, None, 3]
    assert (race.plan, race.is_over) == ("x", True)

    def fail() -> None:
        raise ValueError("no")

    with pytest.raises(ValueError, match="no"):
        begin("abc").run([fail], threads=1)


def test_a_search_that_nobody_waits_for_ends() -> None:
    race = begin("abc", seconds=600.0)

    def search() -> None:
        search_by_clock(lambda passed, rounds: None, lambda: 1.0, race.deadline, race, fail, 1e18)

    def fail() -> None:
        raise AssertionError("nothing was found")

    race.run([search, search], threads=2, is_left=lambda: True)
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
